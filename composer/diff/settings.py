"""Compare settings of the whole model: `option`, `visual` and the `statistic` that MuJoCo computes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.compiled.difference import Difference
from composer.compiled.kinds import Model
from composer.compiled.options import option_differences, statistic_differences
from composer.diff.change import Change, Value
from composer.diff.values import close

_WORDS = {
    "integrator": ("mjtIntegrator", "mjINT_"), "cone": ("mjtCone", "mjCONE_"),
    "jacobian": ("mjtJacobian", "mjJAC_"), "solver": ("mjtSolver", "mjSOL_"),
}  # fmt: skip
_SPELLED = {"euler": "Euler", "rk4": "RK4", "pgs": "PGS", "cg": "CG", "newton": "Newton"}
_FLAGS = {
    "disableflags": ("mjtDisableBit", "mjDSBL_", True),
    "enableflags": ("mjtEnableBit", "mjENBL_", False),
}


def setting_changes(mujoco: Any, a: Model, b: Model, tolerance: float) -> Iterator[Change]:
    """Yield changes of settings, flags one by one, with words in place of numbers."""
    for difference in option_differences(a, b):
        if difference.name in _FLAGS:
            yield from _flags(mujoco, difference)
        elif not _close(difference.expected, difference.actual, tolerance):
            before, after = (
                _word(mujoco, difference.name, each) for each in (difference.expected, difference.actual)
            )
            yield Change("changed", difference.kind, "", field=difference.name, before=before, after=after)
    for difference in statistic_differences(a, b):
        if not _close(difference.expected, difference.actual, tolerance):
            yield Change(
                "changed",
                "statistic",
                "",
                field=difference.name,
                before=difference.expected,
                after=difference.actual,
                follows=True,
            )


def _flags(mujoco: Any, difference: Difference) -> Iterator[Change]:
    enum, prefix, disables = _FLAGS[difference.name]
    assert isinstance(difference.expected, int) and isinstance(difference.actual, int)
    for word, bit in getattr(mujoco, enum).__members__.items():
        if word.startswith(prefix) and (difference.expected ^ difference.actual) & int(bit):
            states = [
                bool(each & int(bit)) is not disables for each in (difference.expected, difference.actual)
            ]
            before, after = ("enable" if state else "disable" for state in states)
            yield Change(
                "changed",
                "option",
                "",
                field=f"flag {word.removeprefix(prefix).lower()}",
                before=before,
                after=after,
            )


def _word(mujoco: Any, name: str, value: Value) -> Value:
    if name not in _WORDS:
        return value
    enum, prefix = _WORDS[name]
    for word, number in getattr(mujoco, enum).__members__.items():
        if int(number) == value:
            plain: str = word.removeprefix(prefix).lower()
            return _SPELLED.get(plain, plain)
    return value


def _close(a: Value, b: Value, tolerance: float) -> bool:
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_close(x, y, tolerance) for x, y in zip(a, b, strict=True))
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return close(a, b, tolerance)
    return a == b
