"""What angles without a unit and `euler` mean, in each file of a recipe and of the recipes that it extends."""

from __future__ import annotations

from collections.abc import Mapping as Map
from dataclasses import field

from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Node, locate, to_python
from composer.expand.expand import Concrete
from composer.expand.substitute import Substitution
from composer.recipe.fault import Path
from composer.recipe.validate import judge

SETTINGS = ("angle", "eulerseq")


@dataclass(frozen=True, slots=True)
class AngleSettings:
    """The settings of one file.

    `angle` is the unit of angles without a unit (None: they are not allowed), `eulerseq` the sequence of `euler`.
    """

    angle: str | None = None
    eulerseq: str = "xyz"


@dataclass(frozen=True, slots=True)
class AngleContext:
    """The settings of a merged recipe as a `whole`, and those of its files that differ from it."""

    document: Mapping
    whole: AngleSettings = AngleSettings()
    others: Map[str, AngleSettings] = field(default_factory=dict)

    def at(self, path: Path) -> AngleSettings:
        """Return the settings for the value at a path."""
        return self.others.get(locate(self.document, path).file, self.whole) if self.others else self.whole


def angle_context_of(
    concrete: Concrete, document: Mapping, whole: AngleSettings, files: Map[str, Node], sink: Sink
) -> AngleContext:
    """Return the angle context of a concrete recipe's `document`. `files` has the settings of each file."""
    others: dict[str, AngleSettings] = {}
    for file, said in files.items():
        node = Substitution(concrete.scope, concrete.parameters, frozenset(), sink=sink).of(said)
        assert isinstance(node, Mapping)
        faults = [fault for fault in judge(node)[1] if fault.at[:1] in [(name,) for name in SETTINGS]]
        for fault in faults:
            sink.error(fault.code, fault.message, locate(node, fault.at, key=fault.key), help=fault.help)
        read = whole if faults else AngleSettings(**to_python(node))
        if read != whole:
            others[file] = read
    return AngleContext(document, whole, others)


def check_bare_angles(angle_context: AngleContext, sink: Sink) -> None:
    """Report bare angles in files that do not set `angle` if another file does."""
    if angle_context.whole.angle is None or all(
        each.angle is not None for each in angle_context.others.values()
    ):
        return
    document = angle_context.document
    silent = Mapping(
        {name: each for name, each in document.entries.items() if name != "angle"}, document.span
    )
    for fault in judge(silent)[1]:
        if fault.code == "bare-angle" and angle_context.at(fault.at).angle is None:
            message = f"{fault.message}, and its file does not say which"
            sink.error(fault.code, message, locate(document, fault.at), help=fault.help)
