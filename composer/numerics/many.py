"""The arithmetic of distributions for arrays, one number for each sample.

The result has the same bits as one by one, but is much faster.
"""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from composer.numerics import exact, normal, stream

Bits = NDArray[np.uint64]
Floats = NDArray[np.float64]


def bits(seed: int, samples: Iterable[int], field: str, element: str, component: int) -> Bits:
    """Return `stream.bits` for each sample."""
    before, after = stream.identity(seed, field, element, component)
    size = stream.BITS // 8
    found = b"".join([sha256(b"%b%d%b" % (before, each, after)).digest()[:size] for each in samples])
    return np.frombuffer(found, ">u8").astype(np.uint64)


def overflowing() -> np.errstate:
    """Return a context in which infinite numbers cause no warnings, as with single numbers."""
    return np.errstate(all="ignore")


def fraction(bits: Bits) -> Floats:
    return ((bits >> np.uint64(12)).astype(np.float64) + 0.5) * 2.0**-52


def below(bits: Bits, count: int) -> NDArray[np.int64]:
    # The product has up to 118 bits, which no numpy type can hold.
    return np.array([stream.below(each, count) for each in bits.tolist()], np.int64)


def exp(x: Floats) -> Floats:
    return np.array([exact.exp(each) for each in x.tolist()], np.float64)


def quantile(p: Floats) -> Floats:
    q = p - 0.5
    found = np.asarray(normal.middle(q))  # type: ignore[arg-type]  # the same operations, in the same order
    tails = np.abs(q) > normal.MIDDLE
    found[tails] = [normal.quantile(each) for each in p[tails].tolist()]
    return found


def within(value: Floats, low: float, high: float) -> Floats:
    value = np.where(low > value, low, value)
    return np.where(high < value, high, value)
