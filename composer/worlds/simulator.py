"""A simulator that is given models: what it does not take of one becomes an error that names the elements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import mujoco

from composer.compiled.kinds import Model, NameTable
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.loading.errors import LoadError
from composer.targets.limit import Refusal
from composer.targets.restrictions.compiled import OPTION
from composer.targets.table import TARGETS
from composer.worlds.worlds import Worlds

_CANNOT = "target-cannot"
_INSTEAD = "use `worlds.mujoco`, which takes all that MuJoCo compiles"


@dataclass(frozen=True, slots=True)
class Simulator:
    """`target` is its name in the table of targets, `put_model` its own function for a `mujoco.MjModel`."""

    target: str
    put_model: Callable[[Model], Any]

    @property
    def name(self) -> str:
        """Return its name in sentences: `MuJoCo Warp`."""
        return TARGETS[self.target].title

    def take(self, worlds: Worlds, model: Model) -> Any:
        """Return the simulator's own model of the nominal model of these worlds, or of another one of them.

        Raises LoadError for a model that it does not take. The simulator judges; `build --target` knows the same
        limits, and so which elements it means.
        """
        try:
            return self.put_model(model)
        except Exception as error:
            said = f"{self._installed()} says: {' '.join(str(error).split()) or type(error).__name__}"
            raise LoadError(list(self._refused(worlds, model, said))) from error

    def _installed(self) -> str:
        package = TARGETS[self.target].package or self.name
        try:
            return f"{package} {version(package)}"
        except PackageNotFoundError:
            return package

    def _refused(self, worlds: Worlds, model: Model, said: str) -> Iterator[Diagnostic]:
        """Yield an error for each reason, or one with the words of the simulator, where no reason is known."""
        found: dict[tuple[str, str], list[Refusal]] = {}
        for limit in TARGETS[self.target].limits:
            for each in limit.refuses(mujoco, model) if limit.refuses is not None else ():
                found.setdefault((each.why, each.help), []).append(each)
        if not found:
            message = f"{self.name} does not take the model of the worlds"
            help = f"leave out of the recipe what it lacks, or {_INSTEAD}"
            yield Diagnostic(_CANNOT, message, notes=(Note(said),), help=help)
        table = NameTable(model)
        for (why, help), (first, *others) in found.items():
            yield Diagnostic(
                _CANNOT,
                f"{_shown(table, first)}: {why}",
                notes=(*_written(worlds, first), Note(said)),
                help=f"in the recipe {help}, and build it again; or {_INSTEAD}",
                others=tuple(Note(_shown(table, each)) for each in others),
            )


def _shown(table: NameTable, refusal: Refusal) -> str:
    if refusal.kind == OPTION:
        return OPTION
    name = table.names[refusal.kind][refusal.number]
    return f"{refusal.kind} " + (f"`{name}`" if name else table.describe(refusal.kind, refusal.number))


def _written(worlds: Worlds, refusal: Refusal) -> Iterator[Note]:
    """Yield where the element is written, if the manifest knows it: that of joints, actuators and sensors."""
    elements = getattr(worlds.manifest.index, f"{refusal.kind}s", ())
    if refusal.number < len(elements) and elements[refusal.number].origin is not None:
        yield Note(f"it is written in {elements[refusal.number].origin}")
