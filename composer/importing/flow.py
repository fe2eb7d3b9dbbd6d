"""Write values of a recipe on one line."""

from __future__ import annotations

import math

from composer.document.quote import word


def flow(values: dict[str, str]) -> str:
    return "{" + ", ".join(f"{word(key)}: {value}" for key, value in values.items()) + "}"


def nested(values: dict[str, object]) -> str:
    return flow({k: nested(v) if isinstance(v, dict) else str(v) for k, v in values.items()})


def flow_list(values: list[str]) -> str:
    return "[" + ", ".join(word(value) for value in values) + "]"


def numbers(values: tuple[float, ...]) -> str:
    return "[" + ", ".join(map(_short, values)) + "]"


def _short(value: float) -> str:
    """Return a number with twelve digits if that is all but its rounding, and with all digits otherwise.

    >>> _short(0.1 + 0.2), _short(1e-17), _short(0.943714364147489)
    ('0.3', '0', '0.943714364147489')
    """
    short = f"{round(value, 12) + 0.0:.12g}"
    return short if math.isclose(float(short), value, rel_tol=1e-15, abs_tol=1e-15) else repr(value)
