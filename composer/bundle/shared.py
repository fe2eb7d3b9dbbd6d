"""Bundles as neighbouring folders that share one folder of assets: `NAME/model.xml` refers to `../assets/…`.

A shared asset is named after its content too, so that it is the same file for all models, independent of which
models are written, in which order and by how many processes. Other files (manifest, licences, submodels) are not
shared.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from lxml import etree

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.folder import write_folder
from composer.bundle.manifest import from_json
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.reading.regular import read_regular
from composer.tree.files import CUBE, NAMED_AFTER_FILE, file_attributes, stem
from composer.tree.write import write

ASSETS = "assets"
_SHARED = re.compile(rf"((?:\.\./){{1,2}}){ASSETS}/([^/]+)")


def write_shared(bundle: Bundle, out: Path, above: int = 1) -> tuple[Path, ...]:
    """Write the folder `out`, and its assets to the folder `assets` next to it; return their paths.

    With `above` 2, that folder is one level higher.

    Raises OutputError, and then leaves `out` as it was, with at most additional complete assets next to it.
    """
    if out.name == ASSETS:
        raise OutputError(
            "output-kind", f"the folder `{out}` is that of the assets", "give the model another name"
        )
    own, assets = share(bundle, above)
    folder = out.parents[above - 1] / ASSETS
    for name, content in assets.items():
        path = folder / name
        if not _is_there(path, content):
            with staged_file(path) as stage:
                stage.write_bytes(content)
    write_folder(own, out)
    return tuple(folder / name for name in assets)


def _is_there(path: Path, content: bytes) -> bool:
    try:
        return os.stat(path).st_size == len(content) and read_regular(path, is_source=False) == content
    except OSError:
        return False


def share(bundle: Bundle, above: int = 1) -> tuple[Bundle, dict[str, bytes]]:
    """Return the bundle without its assets, and the assets by their names in the folder so many levels up. No I/O."""
    beside = f"{'../' * above}{ASSETS}/"
    root = etree.fromstring(bundle.files[bundle.model])
    moved: dict[str, str] = {}
    for element, attribute, path in list(file_attributes(root)):
        if path not in bundle.files:
            continue
        moved[path] = _name(path, bundle.digest(path))
        if element.tag in NAMED_AFTER_FILE and not element.get("name") and attribute not in CUBE:
            element.set("name", stem(path))
        element.set(attribute, beside + moved[path])
    files = {path: content for path, content in bundle.files.items() if path not in moved}
    files[bundle.model] = write(root)
    names = {path: beside + name for path, name in moved.items()}
    files[MANIFEST] = _with_shared(bundle.files[MANIFEST], names, bundle.model, text=files[bundle.model])
    return Bundle(files, bundle.model), {name: bundle.files[path] for path, name in moved.items()}


def gathered(files: Mapping[str, bytes], folder: Path) -> dict[str, bytes]:
    """Return the files of such a folder, with the shared assets in its manifest, as a self-contained bundle.

    If the manifest lists no shared assets, the files are unchanged. Raises OSError.
    """
    try:
        manifest = from_json(files.get(MANIFEST, b""))
    except ValueError:  # the reader of the bundle reports it
        return dict(files)
    model = manifest.model
    listed = (each.path for each in manifest.files)
    beside = {path: parts for path in listed if (parts := _SHARED.fullmatch(path))}
    if not beside or model not in files:
        return dict(files)
    try:
        root = etree.fromstring(files[model])
    except etree.XMLSyntaxError:  # likewise
        return dict(files)
    found = dict(files)
    names = {path: f"{ASSETS}/{parts[2]}" for path, parts in beside.items()}
    for path, inside in names.items():
        file = folder / path
        if os.path.isfile(file) and not file.is_symlink():
            found[inside] = read_regular(file)
    for element, attribute, path in list(file_attributes(root)):
        if path in names:
            element.set(attribute, names[path])
    text = write(root)
    if _listed_digest(files[MANIFEST], model) == hashlib.sha256(files[model]).hexdigest():
        found[MANIFEST] = _with_shared(files[MANIFEST], names, model, text=text)
    else:  # which the reader reports
        found[MANIFEST] = _with_shared(files[MANIFEST], names, model, text=None)
    found[model] = text
    return found


def _name(path: str, digest: str) -> str:
    file = PurePosixPath(path)
    return f"{file.stem}-{digest[:16]}{file.suffix}"


def _listed_digest(manifest: bytes, path: str) -> str | None:
    return next((str(each["sha256"]) for each in json.loads(manifest)["files"] if each["path"] == path), None)


def _with_shared(manifest: bytes, names: Mapping[str, str], model: str, text: bytes | None) -> bytes:
    """Return the manifest with other paths for its files, and another text of the model."""
    data: dict[str, Any] = json.loads(manifest)
    for each in data["files"]:
        each["path"] = names.get(each["path"], each["path"])
        if each["path"] == model and text is not None:
            each["sha256"], each["size"] = hashlib.sha256(text).hexdigest(), len(text)
    once = {each["path"]: each for each in data["files"]}
    data["files"] = [once[path] for path in sorted(once)]
    return (json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
