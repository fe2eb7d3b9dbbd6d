"""What Python's `zipfile` raises for an archive that is damaged, or was made to break readers."""

from __future__ import annotations

import lzma
import struct
import zipfile
import zlib

ZIP_FAULTS: tuple[type[Exception], ...] = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    struct.error,
    NotImplementedError,  # a way of packing that Python does not have
    RuntimeError,  # an encrypted file
    EOFError,
    OverflowError,
    ValueError,  # names that are not text, offsets below zero, damaged bzip2
)
