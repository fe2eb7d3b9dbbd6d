"""Model references to files of an installed Python package, which is located without importing it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from mjcompose.base.suggest import closest
from mjcompose.sources import fetching as nearby
from mjcompose.sources import license
from mjcompose.sources.fetching import Lookup
from mjcompose.sources.license import of_package
from mjcompose.sources.reference import (
    Form,
    Origin,
    Reference,
    Source,
    SourceError,
    SourceKind,
    always,
    bare,
    has_format,
    malformed,
    no_host,
)

if TYPE_CHECKING:
    # It takes as long to import as the rest of the package, so it is imported on first use.
    from importlib.metadata import Distribution

_FORM = Form("package:NAME/path/in/package.xml", "a file inside an installed Python package")


def _parse(text: str) -> Reference:
    name, _, path = bare(text, _FORM).partition("/")
    if not name or not path.strip("/"):
        lacks = "the file inside the package" if name else "the package"
        raise malformed(text, _FORM, f"does not say {lacks}")
    # Hyphens pass: a later error names the package for a distribution name as in `pip install`.
    if not all(part.replace("-", "_").isidentifier() for part in name.split(".")):
        raise malformed(text, _FORM, f"names `{name}`, which cannot be a Python package")
    return Reference(text, KIND, name, path=path)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    inside = PurePosixPath(reference.path)
    if inside.is_absolute() or ".." in inside.parts:
        raise SourceError("source-kind", f"the model reference `{reference.text}` leaves the package")
    roots = folders(reference.name)
    if not roots:
        raise _not_installed(reference)
    if not has_format(inside):
        raise nearby.without_suffix(reference.text, _existing(reference, roots))
    for root in roots:
        wanted = root / inside
        if os.path.isfile(wanted):
            return _found(reference, wanted, root)
    raise nearby.not_found(reference.text, roots[0] / inside, _existing(reference, roots))


def folders(name: str) -> list[Path]:
    """Return the folders of an installed package, several for a namespace package, without importing it."""
    top, *rest = name.split(".")
    spec = _spec(top)
    if spec is None or spec.submodule_search_locations is None:
        return []
    candidates = (Path(location, *rest) for location in spec.submodule_search_locations)
    return [folder for folder in candidates if os.path.isdir(folder)]


def _spec(top: str) -> ModuleSpec | None:
    try:
        return find_spec(top)
    except (ImportError, ValueError):
        return None


def distribution(name: str) -> Distribution | None:
    """Return the distribution that installed the package `name`, judged by its list of files."""
    from importlib import metadata

    top = name.partition(".")[0]
    with suppress(metadata.PackageNotFoundError):
        same_name = metadata.distribution(top)
        if any(file.parts[0] == top for file in same_name.files or ()):
            return same_name
    owners = metadata.packages_distributions().get(top, [])
    return metadata.distribution(owners[0]) if owners else None


def _found(reference: Reference, path: Path, root: Path) -> Source:
    owner = distribution(reference.name)
    licenses = license.find(path, root)
    if not licenses and owner is not None:
        licenses = tuple(sorted(_licenses_of(owner)))
    return Source(
        path, reference.kind, reference.text,
        package=owner.metadata["Name"] if owner is not None else reference.name,
        version=owner.version if owner is not None else None, licenses=licenses,
        origin=Origin(reference.id, reference.kind, root),
        license=None if owner is None else _license_of(owner),
    )  # fmt: skip


def _license_of(owner: Distribution) -> str | None:
    metadata = owner.metadata
    expression, written = ((metadata.get_all(name) or [None])[0] for name in ("License-Expression", "License"))
    return of_package(expression, written, metadata.get_all("Classifier") or ())


def _licenses_of(owner: Distribution) -> Iterator[Path]:
    for file in owner.files or ():
        is_license = license.is_license(file.name) or "licenses" in file.parts[1:-1]
        if is_license and file.parts[0].endswith((".dist-info", ".egg-info")):
            path = Path(str(owner.locate_file(file)))
            if os.path.isfile(path):
                yield path


def _existing(reference: Reference, roots: list[Path]) -> list[str]:
    return [f"package:{reference.name}/{each}" for root in roots for each in nearby.model_files(root, depth=6)]


def _not_installed(reference: Reference) -> SourceError:
    from importlib import metadata

    name, text = reference.name, reference.text
    spec = _spec(name.partition(".")[0])
    if spec is not None and spec.submodule_search_locations is None:
        return SourceError("source-not-found", f"`{name}` is a Python module without a folder, in `{text}`")
    known = {top: owners for top, owners in metadata.packages_distributions().items() if top.isidentifier()}
    # The user may have written the distribution name, as in `pip install`, instead of the import name.
    named = [top for top, owners in known.items() if _normalised(name) in map(_normalised, owners)]
    near = named or closest(name, (top for top in known if not top.startswith("_")))
    fix = f"write `package:{near[0]}/{reference.path}`" if near else "install the package with the model"
    return SourceError("source-not-found", f"no Python package `{name}` is installed, in `{text}`", help=fix)


def _normalised(distribution_name: str) -> str:
    return re.sub(r"[-_.]+", "_", distribution_name).lower()


KIND = SourceKind(
    name="package", forms=(_FORM,), local_schemes=(), separator="/", is_local=False, is_fetched=False,
    runs_code=False, pins=frozenset({"package", "version"}), variables=("PYTHONPATH",), libraries=(),
    parse=_parse, resolve=_resolve, host=no_host, is_of_this_machine=always,
)  # fmt: skip
