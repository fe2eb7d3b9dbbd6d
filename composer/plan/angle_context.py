"""The meaning of bare angles and of `euler`, for each file of a recipe and of the recipes that it extends."""

from __future__ import annotations

from collections.abc import Mapping as Map
from dataclasses import dataclass, field

from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Node, locate, to_python
from composer.expand.expand import Concrete
from composer.expand.substitute import Substitution
from composer.recipe.fault import Path
from composer.recipe.validate import judge

SETTINGS = ("angle", "eulerseq")


@dataclass(frozen=True, slots=True)
class Reading:
    """The reading of angles in a file.

    `angle` is the unit of bare angles (None: they are not allowed), `eulerseq` the sequence of `euler`.
    """

    angle: str | None = None
    eulerseq: str = "xyz"


@dataclass(frozen=True, slots=True)
class Readings:
    """The reading of a recipe, and of those of its files that differ from the merged one."""

    document: Mapping
    whole: Reading = Reading()
    others: Map[str, Reading] = field(default_factory=dict)

    def at(self, path: Path) -> Reading:
        """Return the reading of the value at a path."""
        return self.others.get(locate(self.document, path).file, self.whole) if self.others else self.whole


def readings_of(
    concrete: Concrete, document: Mapping, whole: Reading, files: Map[str, Node], sink: Sink
) -> Readings:
    """Return the readings of a concrete recipe's `document`; `files` has the settings of each file."""
    others: dict[str, Reading] = {}
    for file, said in files.items():
        node = Substitution(concrete.scope, concrete.parameters, frozenset(), sink).of(said)
        assert isinstance(node, Mapping)
        faults = [fault for fault in judge(node)[1] if fault.at[:1] in [(name,) for name in SETTINGS]]
        for fault in faults:
            sink.error(fault.code, fault.message, locate(node, fault.at, key=fault.key), help=fault.help)
        read = whole if faults else Reading(**to_python(node))
        if read != whole:
            others[file] = read
    return Readings(document, whole, others)


def check_bare_angles(readings: Readings, sink: Sink) -> None:
    """Report bare angles in files that do not set `angle` if another file does."""
    if readings.whole.angle is None or all(each.angle is not None for each in readings.others.values()):
        return
    document = readings.document
    silent = Mapping(
        {name: each for name, each in document.entries.items() if name != "angle"}, document.span
    )
    for fault in judge(silent)[1]:
        if fault.code == "bare-angle" and readings.at(fault.at).angle is None:
            message = f"{fault.message}, and its file does not say which"
            sink.error(fault.code, message, locate(document, fault.at), help=fault.help)
