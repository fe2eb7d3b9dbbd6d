"""Write values of a recipe on one line."""

from __future__ import annotations

from composer.document.quote import word


def flow(values: dict[str, str]) -> str:
    return "{" + ", ".join(f"{word(key)}: {value}" for key, value in values.items()) + "}"


def nested(values: dict[str, object]) -> str:
    return flow({k: nested(v) if isinstance(v, dict) else str(v) for k, v in values.items()})


def flow_list(values: list[str]) -> str:
    return "[" + ", ".join(word(value) for value in values) + "]"


def numbers(values: tuple[float, ...]) -> str:
    return "[" + ", ".join(f"{round(value, 12) + 0.0:.12g}" for value in values) + "]"
