"""Long lists of parameters: `make test` takes some of them, `make test-all` every one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import Any

import pytest


def rest_slow(values: Iterable[Any], quick: Collection[str], id: Callable[[Any], str] = str) -> list[Any]:
    """Parameters that are marked slow, but for those whose id is in `quick`; each of these must be a value's."""
    named = [(id(value), value) for value in values]
    unknown = set(quick) - {name for name, _ in named}
    assert not unknown or not named, f"no parameter is called {', '.join(sorted(unknown))}"
    return [
        pytest.param(value, id=name, marks=() if name in quick else pytest.mark.slow) for name, value in named
    ]
