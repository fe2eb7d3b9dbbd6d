"""The contract of a linker pass: the facts it needs and establishes, and its words for `mjcompose explain`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import Enum

from composer.dataclass import dataclass
from composer.link.linking import Linking


class Fact(Enum):
    """A fact about the units at some point of the linking. The first three hold at the start."""

    ALONE = "MuJoCo can compile each unit alone, with its own settings, files and angles"
    OWN_NAMES = "each unit has its own names, classes and body tree"
    OWN_SECTIONS = "each unit has its own sections outside the body tree"
    FLEXES_NOTED = "the flexes in the world of each unit are known"
    UNROLLED = "replicates that cannot stay are written out"
    LAID_OUT = "it is known how each unit lays out its keys"
    REDUCED = "what MuJoCo leaves out of a unit is gone"
    CLASSES_CHOSEN = "every top class has its final name"
    OPTIONS_ADOPTED = "each unit has the options of the models that it attaches"
    ALIGNED = "it is known whether the model says `alignfree`"
    ANGLES_SHARED = "all units have one unit of angle and one Euler sequence"
    ROOTS_NOTED = "what may only stand in the world is known"
    FILES_PLACED = "every file has its path in the bundle"
    MODELS_NAMED = "every model that MuJoCo attaches has a name and a path in the bundle"
    NAMES_FINAL = "every name is the one that it has in the model"
    CLASSES_WRAPPED = "every unit has its default classes below a top class of its own"
    JOINED = "all bodies stand in one tree"


AT_THE_START = frozenset({Fact.ALONE, Fact.OWN_NAMES, Fact.OWN_SECTIONS})


@dataclass(frozen=True, slots=True)
class Pass:
    """A row in the linker's table of passes.

    `words` explain in `mjcompose explain` why an element or a value is as this pass leaves it. The facts in `needs`
    must hold before the pass runs; afterwards those in `leaves` hold, and those in `ends` no longer do. If `stops`
    is set, an error in this pass ends the linking, because later passes could not cope with it. If `rewrites` is
    set, the pass changes only spelling or names, so a value keeps its origin.
    """

    run: Callable[[Linking], None]
    words: str
    needs: frozenset[Fact] = frozenset()
    leaves: frozenset[Fact] = frozenset()
    ends: frozenset[Fact] = frozenset()
    stops: bool = True
    rewrites: bool = False

    def __post_init__(self) -> None:
        if not self.words.strip():
            raise ValueError(f"the pass `{self.name}` has no words for `mjcompose explain`")

    @property
    def name(self) -> str:
        return self.run.__name__


class PassOrderError(Exception):
    """A pass comes at a point where a fact that it needs does not hold."""


def check_order(passes: Iterable[Pass]) -> None:
    """Raise `PassOrderError` for the first pass whose needs are not met.

    >>> def turn(linking): ...
    >>> def measure(linking): ...
    >>> turns = Pass(turn, "turned", ends=frozenset({Fact.ALONE}))
    >>> measures = Pass(measure, "measured", needs=frozenset({Fact.ALONE}))
    >>> check_order([measures, turns])
    >>> check_order([turns, measures])
    Traceback (most recent call last):
    composer.link.contract.PassOrderError: the pass `measure` must stand before `turn`: it needs that MuJoCo can \
compile each unit alone, with its own settings, files and angles
    """
    rows = list(passes)
    facts = set(AT_THE_START)
    ended: dict[Fact, Pass] = {}
    for at, row in enumerate(rows):
        for fact in sorted(row.needs - facts, key=list(Fact).index):
            if fact in ended:
                where = f"must stand before `{ended[fact].name}`"
            else:
                later = next((each for each in rows[at:] if fact in each.leaves), None)
                where = "cannot run" if later is None else f"must stand after `{later.name}`"
            raise PassOrderError(f"the pass `{row.name}` {where}: it needs that {fact.value}")
        facts |= row.leaves
        facts -= row.ends
        ended |= dict.fromkeys(row.ends, row)
