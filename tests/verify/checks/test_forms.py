"""Every check has a form in the language and an effect, which takes this form."""

from __future__ import annotations

from importlib import import_module
from typing import get_type_hints

import pytest
from mjcompose import homes
from mjcompose.language.check import KINDS
from mjcompose.verify.checks.check import Scope


@pytest.mark.parametrize("word", KINDS.own)
def test_an_effect_takes_the_form_of_its_check(word: str) -> None:
    form = KINDS[word]
    assert (form.word, form.__module__) == (word, f"mjcompose.language.checks.{word}")
    module = import_module(homes.CHECKS[word])
    if form.is_in_mujoco:
        hints = get_type_hints(module.check, vars(module), {})
        scope, given, result = hints
        assert (hints[scope], hints[given], result) == (Scope, form, "return")
    else:
        assert module.run.__annotations__["check"] == form.__name__
        assert getattr(module, form.__name__) is form
