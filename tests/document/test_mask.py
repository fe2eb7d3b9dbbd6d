from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from composer.document.mask import Mask


@settings(deadline=None)
@given(st.text(st.sampled_from("ab${}[]*, \n\x85\u2028\ue000\ue001")), st.integers(0, 20), st.integers(0, 20))
def test_positions_stay_and_restoring_undoes(text: str, start: int, length: int) -> None:
    mask = Mask(text)
    mask.hide(start, start + length)
    assert len(mask.text) == len(text)
    assert mask.restore(mask.text) == text
    assert not set("${}[]*,") & set(mask.text[start : start + length]) - {"$"}
    assert not set("\x85\u2028") & set(mask.text)


def test_hiding_what_is_harmless_changes_nothing() -> None:
    mask = Mask("abc")
    assert not mask.hide(0, 3)
    assert not mask.active
    assert Mask("a*c").hide(0, 3)


def test_stand_ins_are_not_written_as_escapes_either() -> None:
    mask = Mask("a*\n" + r'"\ue000 \uE001"')
    assert mask.hide(0, 2)
    assert mask.text[1] == "\ue002"


def test_without_anything_left_to_stand_in() -> None:
    text = "*\u2028" + "".join(map(chr, range(0xE000, 0xF900)))
    mask = Mask(text)
    assert not mask.hide(0, 1)
    assert mask.text == text
