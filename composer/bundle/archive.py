"""A bundle as a zip that is a valid MJZ, which MuJoCo opens directly.

The same bundle gives the same bytes, whatever the clock, the time zone, the umask or the folder.

(Compressed bytes still depend on the zlib of Python; `Bundle.sha256` does not.)
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path, PurePosixPath

from composer.bundle.bundle import MODEL, Bundle
from composer.bundle.output_error import OutputError
from composer.bundle.packing import Packed, Packing, level_of, packed_now
from composer.bundle.staging import staged_file
from composer.bundle.timestamp import moment_of

_UNIX = 3
_UTF8 = 0x800
_MODE = 0o100644


def write_archive(
    bundle: Bundle, out: Path, environment: Mapping[str, str], packing: Packing = packed_now
) -> None:
    """Write the bundle as a zip to `out`: the model first, then the other files sorted by path.

    (Other XML files come before the model, because `MjSpec.from_zip` takes the last one.)

    All files are dated 1980-01-01, or SOURCE_DATE_EPOCH of the environment (seconds, UTC). Raises OutputError, and
    then leaves an older `out` untouched.
    """
    write_packed(
        bundle.files, bundle.model, out, environment=environment, packed=lambda path: packing(bundle, path)
    )


def write_packed(
    paths: Iterable[str],
    model: str,
    out: Path,
    environment: Mapping[str, str],
    packed: Callable[[str], Packed],
) -> None:
    """Write a bundle, given its paths and its compressed files."""
    if model.endswith(".xml") and model not in (
        MODEL,
        f"{out.stem}.xml",
    ):  # MuJoCo opens only MJCF
        raise OutputError(
            "output-kind",
            f"MuJoCo opens `{MODEL}` or `{out.stem}.xml` in `{out.name}`, and the model is `{model}`",
            f"name the archive `{PurePosixPath(model).stem}{out.suffix}`",
        )
    moment = moment_of(environment)
    with staged_file(out) as stage, zipfile.ZipFile(stage, "w") as archive:
        for path in sorted(paths, key=lambda path: _rank(path, model)):
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
    info.CRC, info.file_size, info.compress_size = packed.crc, packed.size, len(packed.data)
    info.header_offset = archive.fp.tell()
    archive.fp.write(info.FileHeader())
    archive.fp.write(packed.data)
    archive.filelist.append(info)
    archive.NameToInfo[info.filename] = info
    archive.start_dir = archive.fp.tell()


def _rank(path: str, model: str) -> tuple[int, str]:
    if path == model:
        return 1, path
    return (0 if path.endswith(".xml") else 2), path
