"""The timestamp of all files in an archive."""

from __future__ import annotations

import struct
import time
import zipfile
from collections.abc import Mapping
from io import BytesIO

from composer.bundle.output_error import OutputError

Moment = tuple[int, int, int, int, int, int]
"""Year, month, day, hour, minute, second."""

_FIRST_SECOND = 315532800  # 1980-01-01, the first day a zip can hold
_LAST_SECOND = 4354819198  # 2107-12-31 23:59:58, the last


def moment_of(environment: Mapping[str, str]) -> Moment:
    """Return 1980-01-01, or SOURCE_DATE_EPOCH (seconds, UTC) limited to what a zip can hold. Raises OutputError.

    >>> moment_of({"SOURCE_DATE_EPOCH": "1700000000"})
    (2023, 11, 14, 22, 13, 20)
    """
    epoch, seconds = environment.get("SOURCE_DATE_EPOCH"), _FIRST_SECOND
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


def with_moment(archive: bytes, moment: Moment) -> bytes:
    """Return a zip from another program with this timestamp on all its files, otherwise unchanged. No I/O."""
    year, month, day, hour, minute, second = moment
    stamp = struct.pack("<HH", hour << 11 | minute << 5 | second // 2, (year - 1980) << 9 | month << 5 | day)
    changed = bytearray(archive)
    with zipfile.ZipFile(BytesIO(archive)) as opened:
        at = opened.start_dir
        for info in opened.infolist():
            changed[info.header_offset + 10 : info.header_offset + 14] = stamp
            changed[at + 12 : at + 16] = stamp
            name, extra, comment = struct.unpack_from("<HHH", archive, at + 28)
            at += 46 + name + extra + comment
    return bytes(changed)
