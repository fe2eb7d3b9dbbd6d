"""The source of draws: 64 bits that depend only on the identity of the draw."""

from __future__ import annotations

import hashlib
import json

BITS = 64
_VERSION = "mjcompose draws 1"
_compact = json.JSONEncoder(separators=(",", ":")).encode


def bits(seed: int, sample: int, field: str, element: str, component: int) -> int:
    """Return 64 random bits for one number: the first eight bytes, big-endian, of the SHA-256 of a JSON list.

    There is no state, so that other draws, their order and their process do not matter.

    >>> hex(bits(7, 1, "friction", "cube/box", 0))
    '0x488ac89d436f6e7e'
    """
    before, after = identity(seed, field, element, component=component)
    return int.from_bytes(hashlib.sha256(b"%b%d%b" % (before, sample, after)).digest()[: BITS // 8], "big")


def identity(seed: int, field: str, element: str, component: int) -> tuple[bytes, bytes]:
    """Return the bytes before and after the number of the sample in that JSON list.

    >>> identity(7, "friction", "cube/box", 0)
    (b'["mjcompose draws 1",7,', b',"friction","cube/box",0]')
    """
    before, after = (
        _compact(each).encode("ascii") for each in ([_VERSION, seed], [field, element, component])
    )
    return before[:-1] + b",", b"," + after[1:]


def fraction(bits: int) -> float:
    """Return the bits as a number strictly between 0 and 1: 52 bits and a half, which is exact.

    >>> fraction(0), fraction(2**64 - 1) < 1
    (1.1102230246251565e-16, True)
    """
    return ((bits >> 12) + 0.5) * 2.0**-52


def below(bits: int, count: int) -> int:
    """Return the bits as a whole number from 0 to `count` - 1.

    >>> below(0, 6), below(2**64 - 1, 6)
    (0, 5)
    """
    return bits * count >> BITS
