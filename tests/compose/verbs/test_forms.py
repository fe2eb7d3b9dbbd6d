"""Every verb has a form in the language and an effect in `compose/verbs`, which takes this form."""

from __future__ import annotations

from typing import get_type_hints

import pytest
from mjcompose.compose.edits import EFFECTS
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.edit import VERBS


@pytest.mark.parametrize("word", VERBS.own)
def test_an_effect_takes_the_form_of_its_verb(word: str) -> None:
    form = VERBS[word]
    effect = EFFECTS[word]
    assert form.__module__ == f"mjcompose.language.verbs.{word}"
    assert effect.__module__ == f"mjcompose.compose.verbs.{word}"
    hints = get_type_hints(effect)
    assert (hints["verb"], hints["entry"]) == (form, Entry)
