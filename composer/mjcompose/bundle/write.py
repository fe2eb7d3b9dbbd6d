"""A bundle in the form that the output's name selects.

A zip is a valid MJZ, which MuJoCo opens directly. The same bundle gives the same bytes, whatever the clock, the time
zone, the umask or the folder. (Compressed bytes still depend on the zlib of Python; `Bundle.sha256` does not.) Each
file is compressed once, at a level that depends on its name alone: the usual level for MJCF and other text, a low level
for meshes (several times faster and nearly as good), none for images and archives.
"""

from __future__ import annotations

import json
import os
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from pathlib import Path, PurePosixPath
from threading import Thread
from typing import Any, NamedTuple

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import open_regular, read_regular
from mjcompose.bundle.bundle import (
    LARGEST_MANIFEST,
    LICENSES,
    MANIFEST,
    MODEL,
    Bundle,
    OutputError,
    OutputForm,
    form_of,
    moment_of,
    with_moment,
)
from mjcompose.bundle.staging import in_scratch, manifest_beside, staged_file, write_folder, write_mjb
from mjcompose.mujoco import engine

_TEXT_LEVEL = 6
_MESH_LEVEL = 1
_TEXT = {".xml", ".json", ".txt", ".md", ".yaml", ".yml", ".csv", ".mtl", ""}
_PACKED = {".png", ".jpg", ".jpeg", ".webp", ".ktx", ".zip", ".mjz", ".gz"}
_HEAD = struct.Struct("<IQ")


class Packed(NamedTuple):
    """The CRC-32 and the size of a file's bytes, and the compressed data."""

    crc: int
    size: int
    data: bytes


class BackgroundPacker:
    """The files of a bundle, compressed by a thread; `find` returns a known one by hash and level, or None."""

    def __init__(self, bundle: Bundle, find: Callable[[str, int], Packed | None]) -> None:
        self._known: dict[str, tuple[Packed, bool]] = {}
        self._is_wanted = True
        self._thread = Thread(target=self._pack, args=(bundle, find), daemon=True)
        self._thread.start()

    def _pack(self, bundle: Bundle, find: Callable[[str, int], Packed | None]) -> None:
        for path in bundle.files:
            level = level_of(path)
            if level and self._is_wanted:
                known = find(bundle.digest(path), level)
                self._known[bundle.digest(path)] = known or pack(bundle.files[path], level), known is None

    def take(self, digest: str) -> tuple[Packed, bool] | None:
        """Return a compressed file, and whether it was compressed now; None for a file that the bundle did not have."""
        self._thread.join()
        return self._known.get(digest)

    def end(self) -> None:
        self._is_wanted = False
        self._thread.join()
        self._known.clear()


Packing = Callable[[Bundle, str], Packed]
"""Returns a file of a bundle in compressed form, by its path."""


def level_of(path: str) -> int:
    """Return the compression level for a file, 0 for none. No I/O.

    >>> level_of("model.xml"), level_of("assets/arm/link.stl"), level_of("assets/wood.PNG")
    (6, 1, 0)
    """
    suffix = PurePosixPath(path).suffix.lower()
    if suffix in _PACKED:
        return 0
    return _TEXT_LEVEL if suffix in _TEXT else _MESH_LEVEL


def pack(content: bytes, level: int) -> Packed:
    """Compress bytes for a zip. No I/O."""
    data = content
    if level:
        packer = zlib.compressobj(level, zlib.DEFLATED, -zlib.MAX_WBITS)
        data = packer.compress(content) + packer.flush()
    return Packed(zlib.crc32(content), len(content), data)


def pack_file(bundle: Bundle, path: str) -> Packed:
    return pack(bundle.files[path], level_of(path))


def packed_to_bytes(packed: Packed) -> bytes:
    return _HEAD.pack(packed.crc, packed.size) + packed.data


def packed_from_bytes(content: bytes) -> Packed:
    crc, size = _HEAD.unpack_from(content)
    return Packed(crc, size, content[_HEAD.size :])


_UNIX = 3
_UTF8 = 0x800
_MODE = 0o100644


def write_archive(bundle: Bundle, out: Path, environment: Mapping[str, str], packing: Packing = pack_file) -> None:
    """Write the bundle as a zip to `out`: the model first, then the other files sorted by path.

    Other XML files come before the model, because `MjSpec.from_zip` takes the last one. All files are dated 1980-01-01,
    or SOURCE_DATE_EPOCH of the environment (seconds, UTC). Raises OutputError.
    """
    write_packed(bundle.files, bundle.model, out, environment=environment, packed=lambda path: packing(bundle, path))


def write_packed(
    paths: Iterable[str], model: str, out: Path, environment: Mapping[str, str], packed: Callable[[str], Packed]
) -> None:
    """Write files into an archive, in a fixed order. Raises OutputError if MuJoCo could not find the model in it."""
    if model.endswith(".xml") and model not in (MODEL, f"{out.stem}.xml"):  # MuJoCo opens only MJCF
        message = f"MuJoCo opens `{MODEL}` or `{out.stem}.xml` in `{out.name}`, and the model is `{model}`"
        raise OutputError("output-kind", message, f"name the archive `{PurePosixPath(model).stem}{out.suffix}`")
    moment = moment_of(environment)
    with staged_file(out) as stage, zipfile.ZipFile(stage, "w") as archive:
        for path in sorted(paths, key=lambda path: (1 if path == model else 0 if path.endswith(".xml") else 2, path)):
            info = zipfile.ZipInfo(path, moment)
            # Otherwise Python 3.14 writes names in code page 437 if it can.
            info.flag_bits = 0 if path.isascii() else _UTF8
            info.create_system = _UNIX
            info.external_attr = _MODE << 16
            info.compress_type = zipfile.ZIP_DEFLATED if level_of(path) else zipfile.ZIP_STORED
            _copy(archive, info, packed(path))


def _copy(archive: zipfile.ZipFile, info: zipfile.ZipInfo, packed: Packed) -> None:
    """Add an already compressed file to the archive, which `ZipFile` itself cannot do."""
    assert archive.fp is not None
    info.CRC = packed.crc
    info.file_size = packed.size
    info.compress_size = len(packed.data)
    info.header_offset = archive.fp.tell()
    archive.fp.write(info.FileHeader() + packed.data)
    archive.filelist.append(info)
    archive.NameToInfo[info.filename] = info
    archive.start_dir = archive.fp.tell()


def write_text(bundle: Bundle, out: Path) -> None:
    """Write only the model's MJCF to `out`. Raises OutputError if it needs other files, which would be lost."""
    needed = [
        path for path in bundle.files if path not in (bundle.model, MANIFEST) and not path.startswith(f"{LICENSES}/")
    ]
    if needed:
        message = f"one XML file cannot hold the {len(needed)} files that the model needs, such as `{needed[0]}`"
        help = f"write a folder (`{out.with_suffix('')}/`) or an archive (`{out.with_suffix('.mjz')}`)"
        raise OutputError("output-kind", message, help)
    with staged_file(out) as stage:
        stage.write_bytes(bundle.files[bundle.model])


def write_usd(
    bundle: Bundle,
    out: Path,
    environment: Mapping[str, str],
    warn: Callable[[str], None],
    *,
    session: engine.Session | None = None,
) -> None:
    """Write the model as USD: one layer (`.usd`, `.usda`, `.usdc`), or a package with its textures (`.usdz`).

    `warn` receives the converter's warnings, such as elements that USD cannot represent. The same model gives the same
    bytes; files of a package are dated as in an archive. Raises OutputError.
    """
    if session is None:
        with engine.Session() as own:
            write_usd(bundle, out, environment, warn=warn, session=own)
            return
    from mjcompose.mujoco.convert import export_usd

    moment = moment_of(environment)
    with staged_file(out) as stage:
        with in_scratch(bundle) as folder:
            target = folder / f"usd-output{out.suffix.lower()}"
            exported = export_usd(folder / bundle.model, target, session)
            if os.path.isfile(target):
                content = target.read_bytes()
                stage.write_bytes(with_moment(content, moment) if target.suffix == ".usdz" else content)
        if exported.missing is not None:
            message = f"writing `{out.name}` needs the Python package `mujoco-usd-converter`: {exported.missing}"
            help = 'run `pip install "mjcompose[usd]"` in an environment with Python 3.12 or older'
            raise OutputError("usd-missing", message, help)
        if exported.error is not None:
            raise OutputError("output-unwritable", f"cannot write `{out}`: {' '.join(exported.error.split())}")
        if exported.textures:
            count = len(exported.textures)
            first = exported.textures[0]
            message = f"one USD layer cannot hold the {count} textures of the model, such as `{first}`"
            help = f"write a package, which holds them: `{out.with_suffix('.usdz')}`"
            raise OutputError("output-kind", message, help)
    for warning in exported.warnings:
        warn(warning)


class OutputOrigin(Struct):
    """The recipe of a model and its options; `values` are parameters, variants, the cell and the sample."""

    recipe: str
    values: Mapping[str, Any]

    def other_than(self, new: OutputOrigin) -> dict[str, Any]:
        """Return what differs from the new model: the recipe, or the old values.

        >>> OutputOrigin("a.yaml", {"x": 1, "y": 2}).other_than(OutputOrigin("a.yaml", {"x": 3, "y": 2}))
        {'x': 1}
        >>> OutputOrigin("a.yaml", {}).other_than(OutputOrigin("b.yaml", {}))
        {'recipe': 'a.yaml'}
        """
        if self.recipe != new.recipe:
            return {"recipe": self.recipe}
        return {name: value for name, value in self.values.items() if name in new.values and new.values[name] != value}


def origin_of_output(out: Path | str) -> OutputOrigin | None:
    """Return the origin in the manifest of an output, or None if there is no readable manifest."""
    try:
        manifest = json.loads(_manifest(out))
        chosen = {name: manifest[name] for name in ("cell", "sample") if manifest[name] is not None}
        return OutputOrigin(str(manifest["recipe"]["path"]), {**manifest["params"], **manifest["variants"], **chosen})
    except (OSError, ValueError, KeyError, TypeError, RecursionError, NotImplementedError, zipfile.BadZipFile):
        return None  # any other file: `staged_file` decides whether it may be replaced


def _manifest(out: Path | str) -> bytes:
    if isinstance(out, str):
        from mjcompose.bundle.remote import manifest_at

        return manifest_at(out)
    if os.path.isdir(out):
        return read_regular(out / MANIFEST, LARGEST_MANIFEST, is_source=False)
    if out.suffix == ".mjb":
        return read_regular(manifest_beside(out), LARGEST_MANIFEST, is_source=False)
    opened = open_regular(out, is_source=False)
    with opened as stream, zipfile.ZipFile(stream) as archive, archive.open(MANIFEST) as file:
        return file.read(LARGEST_MANIFEST)


def write(
    bundle: Bundle,
    out: str | PathLike[str],
    *,
    environment: Mapping[str, str],
    session: engine.Session | None = None,
    packing: Packing = pack_file,
    warn: Callable[[str], None] = lambda _: None,
) -> OutputForm:
    """Write the bundle to `out` in the form for its name, and return the form.

    The output is complete, or OutputError is raised and everything is as before. `environment` may hold
    SOURCE_DATE_EPOCH. `session` is for MJB and USD, `packing` for archives, `warn` receives the losses of USD.
    """
    form = form_of(out)
    path = Path(out)
    if form == OutputForm.FOLDER:
        write_folder(bundle, path)
    elif form == OutputForm.ARCHIVE:
        write_archive(bundle, path, environment, packing=packing)
    elif form == OutputForm.TEXT:
        write_text(bundle, path)
    elif form == OutputForm.MJB:
        write_mjb(bundle, path, session=session)
    else:
        write_usd(bundle, path, environment, warn=warn, session=session)
    return form
