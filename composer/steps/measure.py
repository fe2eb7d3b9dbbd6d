"""The linker's questions to MuJoCo, answered by the engine on a unit as it stands."""

from __future__ import annotations

from collections.abc import Mapping

from lxml import etree

from composer import engine
from composer.context import Context
from composer.link.linking import Measure
from composer.tree.unit import Unit

_SIZES = ("nq", "nv")


def measure_with(context: Context, limits: engine.Limits | None = None) -> Measure:
    """A function that compiles a unit alone; a fault of the unit goes to the sink and gives nothing."""

    def measure(unit: Unit, arrays: tuple[str, ...]) -> Mapping[str, list[float]]:
        wanted = tuple(name for name in arrays if name not in _SIZES)
        text = etree.tostring(unit.root, encoding="unicode")
        measured = engine.measure(unit.directory, arrays=wanted, text=text, limits=limits or engine.Limits())
        compiled = measured.compiled
        if not compiled.ok:
            context.sink.error(
                "mujoco-rejects", f"MuJoCo rejects `{unit.file}` by itself: {compiled.error or compiled.crash}"
            )
            return {}
        found = {name: [float(value) for value in array.ravel()] for name, array in measured.arrays.items()}
        return {**found, **{name: [float(compiled.sizes[name])] for name in _SIZES}}

    return measure
