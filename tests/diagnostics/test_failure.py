from __future__ import annotations

import pickle

import pytest

from composer.diagnostics import Diagnostic, MjcomposeError, Span

FOUND = [Diagnostic("bad-name", "a", Span("f.yaml", 1, 2), help="h"), Diagnostic("bare-angle", "b")]


def test_carries_and_shows_every_diagnostic() -> None:
    with pytest.raises(MjcomposeError) as caught:
        raise MjcomposeError(iter(FOUND))
    assert caught.value.diagnostics == tuple(FOUND)
    assert str(caught.value) == "f.yaml:1:2: error[bad-name]: a\n  = help: h\nerror[bare-angle]: b"


def test_survives_pickling() -> None:
    again = pickle.loads(pickle.dumps(MjcomposeError(FOUND)))
    assert isinstance(again, MjcomposeError)
    assert again.diagnostics == tuple(FOUND)
