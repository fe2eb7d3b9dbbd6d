"""The exceptions that Python's `zipfile` raises for a damaged or malicious archive."""

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
    NotImplementedError,  # a compression method that Python lacks
    RuntimeError,  # an encrypted file
    EOFError,
    OverflowError,
    ValueError,  # names that are not text, offsets below zero, damaged bzip2
)
