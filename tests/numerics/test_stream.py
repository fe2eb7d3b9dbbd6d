from __future__ import annotations

import hashlib

from hypothesis import given
from hypothesis import strategies as st

from composer.numerics.stream import BITS, below, bits, fraction

NUMBERS = st.integers(0, 2**BITS - 1)


def test_bits_are_what_the_documentation_says() -> None:
    """Anybody can make them, in any language."""
    text = '["mjcompose draws 1",7,3,"friction","cube0/w\\u00fcrfel",2]'
    wanted = int.from_bytes(hashlib.sha256(text.encode("ascii")).digest()[:8], "big")
    assert bits(7, 3, "friction", "cube0/würfel", 2) == wanted


def test_every_part_of_the_identity_counts() -> None:
    identities = [
        (seed, sample, field, element, component)
        for seed in (0, 1)
        for sample in (1, 11)
        for field in ("a", "ab")
        for element in ("", "b", 'b","c')
        for component in (0, 1)
    ]
    assert len({bits(*each) for each in identities}) == len(identities)


@given(NUMBERS)
def test_a_fraction_is_never_an_end(number: int) -> None:
    assert 0.0 < fraction(number) < 1.0


@given(NUMBERS, st.integers(1, 10**9))
def test_below(number: int, count: int) -> None:
    assert 0 <= below(number, count) < count
