"""A bundle as a zip, which is a valid MJZ: MuJoCo opens it as it is.

The same bundle gives the same bytes, whatever the clock, the time zone, the umask or the folder. How much a
file is packed depends on its name alone: MJCF and other text as far as is usual; meshes lightly, which for
them is nearly as small and several times faster; images and archives, which are packed already, not at all.
(Packed bytes still depend on the zlib that Python was built with; `Bundle.sha256` does not.)
"""

from __future__ import annotations

import time
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from composer.bundle.bundle import MODEL, Bundle
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file

_TEXT_LEVEL = 6
_MESH_LEVEL = 1
_TEXT = {".xml", ".json", ".txt", ".md", ".yaml", ".yml", ".csv", ".mtl", ""}
_PACKED = {".png", ".jpg", ".jpeg", ".webp", ".ktx", ".zip", ".mjz", ".gz"}

_FIRST_SECOND = 315532800  # 1980-01-01, the first day a zip can tell
_LAST_SECOND = 4354819198  # 2107-12-31 23:59:58, the last
_UNIX = 3
_MODE = 0o100644


def write_archive(bundle: Bundle, out: Path, environment: Mapping[str, str]) -> None:
    """Write the bundle as a zip to `out`: the model first, then the other files sorted by path.

    (Other XML files would come before the model: of several, `MjSpec.from_zip` takes the last.)
    All files are from 1980-01-01, or from SOURCE_DATE_EPOCH of the environment (seconds, UTC). Raises
    OutputError; then an older `out` is untouched.
    """
    if bundle.model not in (MODEL, f"{out.stem}.xml"):
        raise OutputError(
            "output-kind",
            f"MuJoCo opens `{MODEL}` or `{out.stem}.xml` in `{out.name}`, and the model is `{bundle.model}`",
            f"name the archive `{PurePosixPath(bundle.model).stem}{out.suffix}`",
        )
    moment = _moment(environment.get("SOURCE_DATE_EPOCH"))
    with staged_file(out) as stage, zipfile.ZipFile(stage, "w") as archive:
        for path in sorted(bundle.files, key=lambda path: _rank(path, bundle.model)):
            info = zipfile.ZipInfo(path, moment)
            info.create_system = _UNIX
            info.external_attr = _MODE << 16
            level = _level(path)
            info.compress_type = zipfile.ZIP_DEFLATED if level else zipfile.ZIP_STORED
            archive.writestr(info, bundle.files[path], compresslevel=level or None)


def _rank(path: str, model: str) -> tuple[int, str]:
    if path == model:
        return 1, path
    return (0 if path.endswith(".xml") else 2), path


def _level(path: str) -> int:
    """How hard a file is packed, 0 for not at all."""
    suffix = PurePosixPath(path).suffix.lower()
    if suffix in _PACKED:
        return 0
    return _TEXT_LEVEL if suffix in _TEXT else _MESH_LEVEL


def _moment(epoch: str | None) -> tuple[int, int, int, int, int, int]:
    """The one time all files of an archive carry."""
    seconds = _FIRST_SECOND
    if epoch:
        if not (epoch.isascii() and epoch.removeprefix("-").isdigit()):
            raise OutputError(
                "output-unwritable",
                f"the environment variable `SOURCE_DATE_EPOCH` is `{epoch}`, no whole number of seconds",
                "unset it, or give it the seconds since 1970-01-01",
            )
        seconds = min(max(int(epoch[:20]), _FIRST_SECOND), _LAST_SECOND)
    moment = time.gmtime(seconds)
    return moment.tm_year, moment.tm_mon, moment.tm_mday, moment.tm_hour, moment.tm_min, moment.tm_sec
