"""The linker: its passes, their contract and their order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import Enum
from types import FunctionType

from mjcompose.base.dataclass import dataclass
from mjcompose.link.agreement import agreement, autolimits, passthrough
from mjcompose.link.angles import angles, check_flexes, flex_turns, note_flexes
from mjcompose.link.bodies import bodies
from mjcompose.link.body_reduction import body_reduction
from mjcompose.link.defaults import choose_classes, defaults, top_level_defaults
from mjcompose.link.files import files
from mjcompose.link.inertia import fitted_sizes, inertia, lengthranges
from mjcompose.link.keyframes import keyframes
from mjcompose.link.linking import Linking
from mjcompose.link.names import names
from mjcompose.link.replicates import check_replicates, replicates
from mjcompose.link.settings import alignment, compiler, memory_size
from mjcompose.link.submodels import submodel_options, submodels
from mjcompose.link.unit_keys import layouts
from mjcompose.link.world import check_roots, roots, sections, worlds


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
    mjcompose.link.link.PassOrderError: the pass `measure` must stand before `turn`: it needs that MuJoCo can \
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


def _all(*facts: Fact) -> frozenset[Fact]:
    return frozenset(facts)


# The order. 10 of the 26 neighbouring pairs of these passes give another model or other faults when they are swapped
# (measured on 1,043 models of the tests):
#
#     note_flexes, flex_turns        replicates, layouts           body_reduction, choose_classes
#     lengthranges, angles           submodel_options, agreement   files, submodels
#     submodels, names               names, defaults               defaults, bodies
#     bodies, check_replicates
#
# The other neighbours commute, but not with passes further away: `files` and `layouts`, `note_flexes` and `defaults`,
# `submodels` and `inertia` do not. A few named stages would therefore allow orders that are wrong. The needs say what
# is true; they come from the experiment and from the code. 17 random orders that they allow gave the same bytes and
# the same faults for each of 311 models:
#
# - What measures a unit compiles it alone, so that it runs before `angles` turns its numbers, `roots` takes joints out
#   and `files` gives its files other paths.
# - `layouts` counts a `<replicate>` as one block, so that those to be written out must be gone (`replicates`). These
#   are found by the names, the angles and the sequence of their own file.
# - `body_reduction` settles the mass of what it fuses, by the rules that `inertia` would apply once more; it also takes
#   settings out of the classes, so that the base's top class may set nothing any more (`choose_classes`).
# - `submodels` gives a name to the models that have none, `names` puts the prefix before it.
# - `defaults` writes names of classes that are final: `names` would prefix them again.
# - A part hangs on a place by its final name, with the angles of the model (`bodies`), and takes the pose of a site
#   from its class (`defaults`). Whether its body is aligned is known by then (`alignment`).
PASSES: tuple[Pass, ...] = (
    Pass(note_flexes, "noted by the linker", needs=_all(Fact.OWN_NAMES, Fact.ALONE), leaves=_all(Fact.FLEXES_NOTED)),
    Pass(flex_turns, "checked by the linker", needs=_all(Fact.FLEXES_NOTED, Fact.OWN_NAMES), stops=False),
    Pass(
        replicates,
        "a copy by a `<replicate>`, written out",
        needs=_all(Fact.ALONE, Fact.OWN_NAMES),
        leaves=_all(Fact.UNROLLED),
    ),
    Pass(
        layouts,
        "the keys that `nkey` of `<size>` asks for, written out",
        needs=_all(Fact.UNROLLED, Fact.ALONE, Fact.OWN_NAMES),
        leaves=_all(Fact.LAID_OUT),
    ),
    Pass(
        body_reduction,
        "as MuJoCo has it in its file alone, by `fusestatic` or `discardvisual`",
        needs=_all(Fact.ALONE, Fact.OWN_NAMES, Fact.OWN_SECTIONS),
        leaves=_all(Fact.REDUCED),
    ),
    Pass(
        choose_classes,
        "the name of a top class, chosen by the linker",
        needs=_all(Fact.REDUCED, Fact.FLEXES_NOTED, Fact.OWN_NAMES),
        leaves=_all(Fact.CLASSES_CHOSEN),
    ),
    Pass(
        top_level_defaults,
        "given by its class in its file alone, where the top class is written in several `<default>`",
        needs=_all(Fact.CLASSES_CHOSEN, Fact.ALONE, Fact.OWN_NAMES),
        stops=False,
    ),
    Pass(
        alignment,
        "`alignfree`, made explicit",
        needs=_all(Fact.REDUCED, Fact.OWN_NAMES),
        leaves=_all(Fact.ALIGNED),
        stops=False,
    ),
    Pass(inertia, "the inertia rules of its file, made explicit", needs=_all(Fact.REDUCED, Fact.ALONE, Fact.OWN_NAMES)),
    Pass(
        fitted_sizes,
        "fitted by MuJoCo to the mesh's bounding box, by `fitaabb`",
        needs=_all(Fact.REDUCED, Fact.ALONE, Fact.OWN_NAMES),
    ),
    Pass(autolimits, "checked by the linker", needs=_all(Fact.ALONE, Fact.OWN_NAMES, Fact.OWN_SECTIONS), stops=False),
    Pass(lengthranges, "measured by MuJoCo on its file alone", needs=_all(Fact.ALONE, Fact.OWN_SECTIONS)),
    Pass(
        angles,
        "in the model's unit of angle and Euler sequence",
        needs=_all(Fact.UNROLLED, Fact.OWN_NAMES),
        leaves=_all(Fact.ANGLES_SHARED),
        ends=_all(Fact.ALONE),
        rewrites=True,
    ),
    Pass(
        submodel_options,
        "an option of a model that it attaches, which MuJoCo merges",
        needs=_all(Fact.OWN_SECTIONS),
        leaves=_all(Fact.OPTIONS_ADOPTED),
    ),
    Pass(agreement, "what the parts ask for", needs=_all(Fact.OPTIONS_ADOPTED, Fact.OWN_NAMES), stops=False),
    Pass(
        roots,
        "left out, as the part is welded to its place",
        needs=_all(Fact.LAID_OUT, Fact.OWN_NAMES),
        leaves=_all(Fact.ROOTS_NOTED),
        ends=_all(Fact.ALONE),
        stops=False,
    ),
    Pass(
        passthrough,
        "`passthrough`, which holds for all textures or for none",
        needs=_all(Fact.OWN_SECTIONS),
        stops=False,
    ),
    Pass(
        files,
        "where the bundle has the file",
        needs=_all(Fact.OPTIONS_ADOPTED, Fact.OWN_NAMES, Fact.OWN_SECTIONS),
        leaves=_all(Fact.FILES_PLACED),
        ends=_all(Fact.ALONE),
        rewrites=True,
    ),
    Pass(
        submodels,
        "where the bundle has the model",
        needs=_all(Fact.OPTIONS_ADOPTED, Fact.FILES_PLACED, Fact.OWN_SECTIONS),
        leaves=_all(Fact.MODELS_NAMED),
        ends=_all(Fact.ALONE),
        rewrites=True,
    ),
    Pass(
        names,
        "the prefix of the part",
        needs=_all(Fact.CLASSES_CHOSEN, Fact.MODELS_NAMED, Fact.OWN_NAMES, Fact.OWN_SECTIONS),
        leaves=_all(Fact.NAMES_FINAL),
        ends=_all(Fact.ALONE, Fact.OWN_NAMES),
        stops=False,
        rewrites=True,
    ),
    Pass(
        defaults,
        "the top class of its file",
        needs=_all(Fact.NAMES_FINAL, Fact.CLASSES_CHOSEN, Fact.FLEXES_NOTED, Fact.OWN_SECTIONS),
        leaves=_all(Fact.CLASSES_WRAPPED),
        rewrites=True,
    ),
    Pass(
        bodies,
        "holds what the parts bring",
        needs=_all(
            Fact.NAMES_FINAL,
            Fact.CLASSES_WRAPPED,
            Fact.ANGLES_SHARED,
            Fact.ALIGNED,
            Fact.ROOTS_NOTED,
            Fact.FLEXES_NOTED,
            Fact.LAID_OUT,
        ),
        leaves=_all(Fact.JOINED),
        stops=False,
    ),
    # The passes from here on look at the joined tree; `check_replicates` also needs to know whose section it reads.
    Pass(
        check_replicates,
        "checked by the linker",
        needs=_all(Fact.JOINED, Fact.UNROLLED, Fact.OWN_SECTIONS),
        stops=False,
    ),
    Pass(check_roots, "checked by the linker", needs=_all(Fact.JOINED, Fact.ROOTS_NOTED), stops=False),
    Pass(
        check_flexes,
        "checked by the linker",
        needs=_all(Fact.JOINED, Fact.FLEXES_NOTED, Fact.CLASSES_WRAPPED),
        stops=False,
    ),
    Pass(
        worlds,
        "carried along with its part: it is measured in the world of its file",
        needs=_all(Fact.JOINED, Fact.NAMES_FINAL, Fact.ANGLES_SHARED, Fact.OWN_SECTIONS),
        stops=False,
    ),
    Pass(
        sections,
        "holds what the parts bring",
        needs=_all(Fact.NAMES_FINAL, Fact.CLASSES_WRAPPED, Fact.FILES_PLACED, Fact.MODELS_NAMED),
        ends=_all(Fact.OWN_SECTIONS),
    ),
    Pass(
        compiler,
        "the settings that hold for every part",
        needs=_all(Fact.ANGLES_SHARED, Fact.ALIGNED, Fact.FILES_PLACED, Fact.MODELS_NAMED),
        ends=_all(Fact.ALONE),
        rewrites=True,
    ),
)

# These wait until nothing more is added to the model.
FINISHING: tuple[Pass, ...] = (
    Pass(
        keyframes,
        "laid out anew for the whole model",
        needs=_all(Fact.LAID_OUT, Fact.JOINED, Fact.NAMES_FINAL),
        rewrites=True,
    ),
    Pass(memory_size, "the memory that the whole model needs", needs=_all(Fact.JOINED)),
)

check_order((*PASSES, *FINISHING))
_ROWS = {row.run: row for row in (*PASSES, *FINISHING)}


def row_of(done: object) -> Pass | None:
    """Return the row of a pass by its function, or None for anything else."""
    return _ROWS.get(done) if isinstance(done, FunctionType) else None


def link(linking: Linking) -> bool:
    """Make `linking.base` the flat model; the units of the parts are used up.

    False if a pass found errors that later passes cannot cope with; then the names of the model are not known.
    """
    before = linking.sink.error_count
    for row in PASSES:
        row.run(linking)
        linking.watch(linking.units, row.run)
        after = linking.sink.error_count
        if after > before and row.stops:
            return False
        before = after
    return True


def link_alone(linking: Linking) -> None:
    """Link a base without parts, of which only the paths of its files change.

    Its names are not looked at, nor its keys: whoever calls knows that its names are right.
    """
    for link_pass in (files, submodels, compiler):
        link_pass(linking)


def finish(linking: Linking) -> None:
    """Run what must wait until nothing more is added to the model."""
    for row in FINISHING:
        row.run(linking)
        linking.watch(linking.units, row.run)
    for part in linking.parts:
        linking.base.origins.adopt(part.unit.origins)
