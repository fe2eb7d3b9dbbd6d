from __future__ import annotations

import pickle

import pytest

from composer import mjcf
from composer.diagnostics import MjcomposeError, Sink
from composer.mjcf.errors import failure, raise_errors


def test_a_fault_is_a_value_error_with_diagnostics() -> None:
    error = failure("name-clash", "there are two", help="rename one")
    assert (
        isinstance(error, mjcf.MjcfError)
        and isinstance(error, ValueError)
        and isinstance(error, MjcomposeError)
    )
    assert str(error) == "error[name-clash]: there are two\n  = help: rename one"
    assert pickle.loads(pickle.dumps(error)).diagnostics == error.diagnostics


def test_an_unknown_attribute_is_an_attribute_error_too() -> None:
    with pytest.raises(AttributeError) as caught:
        _ = mjcf.RootElement().colour
    assert isinstance(caught.value, mjcf.MjcfError)


def test_only_errors_are_raised_and_all_of_them() -> None:
    sink = Sink()
    sink.warning("name-clash", "look")
    raise_errors(sink)
    sink.error("name-clash", "one")
    sink.error("unknown-name", "two")
    with pytest.raises(mjcf.MjcfError) as caught:
        raise_errors(sink)
    assert [fault.message for fault in caught.value.diagnostics] == ["one", "two"]
