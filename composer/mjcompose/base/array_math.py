"""The arithmetic of distributions for arrays of samples: bit for bit as for single numbers, but much faster."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from decimal import Context, Decimal
from fractions import Fraction
from hashlib import sha256
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mjcompose.base import draw_stream

Bits = NDArray[np.uint64]
Floats = NDArray[np.float64]


def bits(seed: int, samples: Iterable[int], field: str, element: str, component: int) -> Bits:
    before, after = draw_stream.identity(seed, field, element, component=component)
    size = draw_stream.BITS // 8
    found = b"".join([sha256(b"%b%d%b" % (before, each, after)).digest()[:size] for each in samples])
    return np.frombuffer(found, ">u8").astype(np.uint64)


def overflowing() -> np.errstate:
    """Return a context in which infinite numbers cause no warnings, as with single numbers."""
    return np.errstate(all="ignore")


def fraction(bits: Bits) -> Floats:
    return ((bits >> np.uint64(12)).astype(np.float64) + 0.5) * 2.0**-52


def below(bits: Bits, count: int) -> NDArray[np.int64]:
    # The product has up to 118 bits, which no numpy type can hold.
    return np.array([draw_stream.below(each, count) for each in bits.tolist()], np.int64)


def exp(x: Floats) -> Floats:
    return _rounded(x, (x > -_FARTHEST) & (x < _FARTHEST), _exp, one=draw_stream.exp)


def log(x: Floats) -> Floats:
    return _rounded(x, (x > _LEAST) & (x < 0.5), _log, one=draw_stream.log)


def quantile(p: Floats) -> Floats:
    q = p - 0.5
    found = np.asarray(draw_stream.middle(q))  # type: ignore[arg-type]  # the same operations, in the same order
    tails = np.abs(q) > draw_stream.MIDDLE
    inside = tails & (p > 0.0) & (p < 1.0)
    found[tails & ~inside] = np.copysign(np.inf, q[tails & ~inside])
    p = p[inside]
    q = q[inside]
    r = np.sqrt(-log(np.where(q < 0, p, 1.0 - p)))
    tail = np.where(r <= 5.0, draw_stream.near(r), draw_stream.far(r))  # type: ignore[arg-type]
    found[inside] = np.where(q < 0, -tail, tail)
    return found


def within(value: Floats, low: float, high: float) -> Floats:
    value = np.where(low > value, low, value)
    return np.where(high < value, high, value)


# Pairs of doubles whose sum is a number with twice as many digits: T. J. Dekker, A floating-point technique for
# extending the available precision, Numerische Mathematik 18 (1971). Each operation is rounded as IEEE 754 says, so
# the bits are the same on every machine.
Pair = tuple[Floats, Floats]
_CHUNK = 8192
_DOUBT = 2.0**-88
"""The errors of `_exp` and `_log` are less than a hundredth of this part."""
_FARTHEST = 600.0
_LEAST = 1e-300
_HALVINGS = 6
_TERMS = 13


def _split(number: Fraction, bits: int) -> tuple[float, Fraction]:
    first = Fraction(int(number * 2**bits), 2**bits)
    return float(first), number - first


# A multiple of the first two parts of the logarithm of 2 has no more digits than a double.
_LN2_A, _rest = _split(Fraction(Context(prec=80).ln(Decimal(2))), 40)
_LN2_B, _rest = _split(_rest, 80)
_LN2_C = float(_rest)
_INVERSE = [Fraction(1, factorial(n)) for n in range(_TERMS + 1)]
_FACTORS = [(float(each), float(each - Fraction(float(each)))) for each in _INVERSE]


def _rounded(
    x: Floats, usual: NDArray[np.bool_], compute: Callable[[Floats], Pair], one: Callable[[float], float]
) -> Floats:
    """Return a function of each number, correctly rounded; `one` computes the doubtful cases."""
    found = np.empty_like(x)
    for first in range(0, len(x), _CHUNK):
        part = slice(first, first + _CHUNK)
        known = usual[part]
        high, low = compute(np.where(known, x[part], 0.25))
        doubt = np.abs(high) * _DOUBT
        known = known & (high + (low + doubt) == high) & (high + (low - doubt) == high)
        found[part] = high
        found[part][~known] = [one(each) for each in x[part][~known].tolist()]
    return found


def _exp(x: Floats) -> Pair:
    (high, low), powers = _scaled_exp(x)
    return np.ldexp(high, powers), np.ldexp(low, powers)


def _log(x: Floats) -> Pair:
    """One step of Newton's method from the result of the C library."""
    near = np.log(x)
    (high, low), powers = _scaled_exp(-near)
    mantissa, exponent = np.frexp(x)
    high, low = _times((high, low), (mantissa, np.zeros_like(x)))
    high = np.ldexp(high, powers + exponent)
    low = np.ldexp(low, powers + exponent)
    more = _sum(high - 1.0, low)  # so close to 1 that the difference is exact
    return _plus(_plus(more, (more[0] * more[0] * -0.5, np.zeros_like(x))), (near, np.zeros_like(x)))


def _scaled_exp(x: Floats) -> tuple[Pair, NDArray[np.int64]]:
    """Return e to the power of x, divided by a power of 2, and that power."""
    powers = np.rint(x / _LN2_A)
    zeros = np.zeros_like(x)
    rest = _plus(_plus(_sum(x, -powers * _LN2_A), (-powers * _LN2_B, zeros)), (-powers * _LN2_C, zeros))
    rest = rest[0] * 0.5**_HALVINGS, rest[1] * 0.5**_HALVINGS
    total: Pair = (zeros + _FACTORS[-1][0], zeros + _FACTORS[-1][1])
    for high, low in _FACTORS[-2:0:-1]:
        total = _plus(_times(total, rest), (zeros + high, zeros + low))
    total = _times(total, rest)  # without the 1, of which it is a small part
    for _ in range(_HALVINGS):
        total = _plus((total[0] * 2.0, total[1] * 2.0), _times(total, total))
    return _plus(total, (zeros + 1.0, zeros)), powers.astype(np.int64)


def _sum(a: Floats, b: Floats) -> Pair:
    high = a + b
    other = high - a
    return high, (a - (high - other)) + (b - other)


def _plus(a: Pair, b: Pair) -> Pair:
    high, low = _sum(a[0], b[0])
    more, least = _sum(a[1], b[1])
    high, low = _sum(high, low + more)
    return _sum(high, low + least)


def _times(a: Pair, b: Pair) -> Pair:
    high = a[0] * b[0]
    a_first, a_last = _halves(a[0])
    b_first, b_last = _halves(b[0])
    low = ((a_first * b_first - high) + a_first * b_last + a_last * b_first) + a_last * b_last
    return _sum(high, low + (a[0] * b[1] + a[1] * b[0]))


def _halves(a: Floats) -> Pair:
    scaled = a * (2.0**27 + 1.0)
    first = scaled - (scaled - a)
    return first, a - first
