"""64 random bits from the identity of a draw, and functions with the same bits on every machine."""

from __future__ import annotations

import hashlib
import json
import math
from decimal import Context, Decimal

BITS = 64
_VERSION = "mjcompose draws 1"
_compact = json.JSONEncoder(separators=(",", ":")).encode


def bits(seed: int, sample: int, field: str, element: str, component: int) -> int:
    """Return 64 random bits: the first eight bytes, big-endian, of the SHA-256 of a JSON list. There is no state."""
    before, after = identity(seed, field, element, component=component)
    return int.from_bytes(hashlib.sha256(b"%b%d%b" % (before, sample, after)).digest()[: BITS // 8], "big")


def identity(seed: int, field: str, element: str, component: int) -> tuple[bytes, bytes]:
    """Return the bytes before and after the number of the sample in that JSON list."""
    before, after = (_compact(each).encode("ascii") for each in ([_VERSION, seed], [field, element, component]))
    return before[:-1] + b",", b"," + after[1:]


def fraction(bits: int) -> float:
    """Return the bits as a number strictly between 0 and 1: 52 bits and a half, which is exact."""
    return ((bits >> 12) + 0.5) * 2.0**-52


def below(bits: int, count: int) -> int:
    """Return the bits as a whole number from 0 to `count` - 1."""
    return bits * count >> BITS


def within(value: float, low: float, high: float) -> float:
    """Limit a value to the bounds, which rounding might exceed."""
    return min(max(value, low), high)


# Results are rounded correctly to 40 digits, and then to a double.
_EXACT_DIGITS = Context(prec=40, Emin=-999_999, Emax=999_999)


def exp(x: float) -> float:
    """Return e to the power of x; infinity if that is too large."""
    if x > 1000:  # far too large for a double or this context
        return math.inf
    return float(Decimal(x).exp(_EXACT_DIGITS))


def log(x: float) -> float:
    """Return the natural logarithm of a positive number.

    >>> log(10.0)
    2.302585092994046
    """
    return float(Decimal(x).ln(_EXACT_DIGITS))


FARTHEST = 20.0
"""No draw can be more standard deviations from the mean than this."""
MIDDLE = 0.425
"""One quotient of polynomials is enough up to this distance from a half."""
_NORMAL_DIGITS = Context(prec=140, Emin=-999_999, Emax=999_999)
_PI = Decimal(
    "3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211706798"
    "214808651328230664709384460955058223172535940812848111745"
)

# M. J. Wichura, Algorithm AS 241: The Percentage Points of the Normal Distribution, Applied Statistics 37 (1988):
# quotients of polynomials, the highest power first, good to 16 digits.
_MIDDLE = (
    (
        2509.0809287301226727,
        33430.575583588128105,
        67265.770927008700853,
        45921.953931549871457,
        13731.693765509461125,
        1971.5909503065514427,
        133.14166789178437745,
        3.387132872796366608,
    ),
    (
        5226.495278852545925,
        28729.085735721942674,
        39307.89580009271061,
        21213.794301586595867,
        5394.1960214247511077,
        687.1870074920579083,
        42.313330701600911252,
        1.0,
    ),
)
_NEAR = (
    (
        7.7454501427834140764e-4,
        0.0227238449892691845833,
        0.24178072517745061177,
        1.27045825245236838258,
        3.64784832476320460504,
        5.7694972214606914055,
        4.6303378461565452959,
        1.42343711074968357734,
    ),
    (
        1.05075007164441684324e-9,
        5.475938084995344946e-4,
        0.0151986665636164571966,
        0.14810397642748007459,
        0.68976733498510000455,
        1.6763848301838038494,
        2.05319162663775882187,
        1.0,
    ),
)
_FAR = (
    (
        2.01033439929228813265e-7,
        2.71155556874348757815e-5,
        0.0012426609473880784386,
        0.026532189526576123093,
        0.29656057182850489123,
        1.7848265399172913358,
        5.4637849111641143699,
        6.6579046435011037772,
    ),
    (
        2.04426310338993978564e-15,
        1.4215117583164458887e-7,
        1.8463183175100546818e-5,
        7.868691311456132591e-4,
        0.0148753612908506148525,
        0.13692988092273580531,
        0.59983220655588793769,
        1.0,
    ),
)


def quantile(p: float) -> float:
    """Return the number below which a normal draw is with probability p; infinite if p is not between 0 and 1."""
    q = p - 0.5
    if abs(q) <= MIDDLE:
        return middle(q)
    if not 0.0 < p < 1.0:
        return math.copysign(math.inf, q)
    r = math.sqrt(-log(p if q < 0 else 1.0 - p))
    found = near(r) if r <= 5.0 else far(r)
    return -found if q < 0 else found


def middle(q: float) -> float:
    """Return `quantile` of a half plus `q`, for q up to `MIDDLE`; also for a numpy array."""
    return q * _quotient(_MIDDLE, 0.180625 - q * q)


def near(r: float) -> float:
    """Return the distance of a quantile from the middle, for `r` up to 5; also for a numpy array."""
    return _quotient(_NEAR, r - 1.6)


def far(r: float) -> float:
    return _quotient(_FAR, r - 5.0)


def _quotient(table: tuple[tuple[float, ...], tuple[float, ...]], x: float) -> float:
    above, below = (_polynomial(each, x) for each in table)
    return above / below


def _polynomial(coefficients: tuple[float, ...], x: float) -> float:
    result = 0.0
    for each in coefficients:
        result = result * x + each
    return result


def probability(x: float) -> float:
    """Return the normal probability below x; for large x only `probability(-x)` is exact to the last digit."""
    if abs(x) > FARTHEST:
        return 0.0 if x < 0 else 1.0
    c = _NORMAL_DIGITS
    # The series has no terms of opposite sign; 140 digits are enough to subtract its sum from a half.
    exact = Decimal(x)
    term = total = exact
    n = 1
    while term and abs(term) > abs(total) * Decimal("1e-130"):
        n += 2
        term = c.divide(c.multiply(c.multiply(term, exact), exact), Decimal(n))
        total = c.add(total, term)
    density = c.divide(c.exp(c.divide(c.multiply(exact, exact), Decimal(-2))), c.sqrt(c.multiply(Decimal(2), _PI)))
    return float(c.add(Decimal("0.5"), c.multiply(density, total)))
