"""The linker: its passes, their contract and their order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import Enum
from types import FunctionType

from mjcompose.base.dataclass import Struct
from mjcompose.link.agreement import agreement, autolimits, passthrough
from mjcompose.link.angles import angles, check_flexes, flex_turns, note_flexes
from mjcompose.link.bodies import bodies
from mjcompose.link.boundaries import boundaries, crossings
from mjcompose.link.defaults import choose_classes, defaults, top_level_defaults
from mjcompose.link.files import files
from mjcompose.link.inertia import body_reduction, fitted_sizes, inertia, lengthranges, muscle_forces
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
    REDUCED = "elements that MuJoCo omits from a unit are gone"
    CLASSES_CHOSEN = "every top class has its final name"
    OPTIONS_ADOPTED = "each unit has the options of the models that it attaches"
    ALIGNED = "it is known whether the model says `alignfree`"
    ANGLES_SHARED = "all units have one unit of angle and one Euler sequence"
    ROOTS_NOTED = "elements that only the world may have are known"
    FILES_PLACED = "every file has its path in the bundle"
    MODELS_NAMED = "every model that MuJoCo attaches has a name and a path in the bundle"
    NAMES_FINAL = "every name is the one that it has in the model"
    CLASSES_WRAPPED = "every unit has its default classes below a top class of its own"
    JOINED = "all bodies are in one tree"


AT_THE_START = frozenset({Fact.ALONE, Fact.OWN_NAMES, Fact.OWN_SECTIONS})


class Pass(Struct):
    """A row in the linker's table of passes.

    `words` explain the effect of this pass on an element or a value in `mjcompose explain`. The facts in `needs` must
    hold before the pass runs. Afterwards the facts in `leaves` hold, and the facts in `ends` no longer hold. If `stops`
    is set, an error in this pass ends the linking, because later passes could not handle it. If `rewrites` is set, the
    pass changes only spelling or names, so a value keeps its origin.
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
    mjcompose.link.link.PassOrderError: the pass `measure` must come before `turn`: it needs that MuJoCo can \
compile each unit alone, with its own settings, files and angles
    """
    rows = list(passes)
    facts = set(AT_THE_START)
    ended: dict[Fact, Pass] = {}
    for at, row in enumerate(rows):
        for fact in sorted(row.needs - facts, key=list(Fact).index):
            if fact in ended:
                where = f"must come before `{ended[fact].name}`"
            else:
                later = next((each for each in rows[at:] if fact in each.leaves), None)
                where = "cannot run" if later is None else f"must come after `{later.name}`"
            raise PassOrderError(f"the pass `{row.name}` {where}: it needs that {fact.value}")
        facts |= row.leaves
        facts -= row.ends
        ended |= dict.fromkeys(row.ends, row)


def _pass(
    run: Callable[[Linking], None], words: str, needs: str, leaves: str = "", ends: str = "", **flags: bool
) -> Pass:
    needed, left, ended = (frozenset(Fact[name] for name in names.split()) for names in (needs, leaves, ends))
    return Pass(run, words, needs=needed, leaves=left, ends=ended, **flags)


# The order. 10 of the 26 neighboring pairs of these passes give another model or other faults when they are swapped
# (measured on 1,043 models of the tests):
#
#     note_flexes, flex_turns        replicates, layouts           body_reduction, choose_classes
#     lengthranges, angles           submodel_options, agreement   files, submodels
#     submodels, names               names, defaults               defaults, bodies
#     bodies, check_replicates
#
# The other neighbors commute, but not with passes further away: `files` and `layouts`, `note_flexes` and `defaults`,
# `submodels` and `inertia` do not. A few named stages would therefore allow orders that are wrong. The needs say what
# is true; they come from the experiment and from the code. 17 random orders that they allow gave the same bytes and
# the same faults for each of 311 models:
#
# - A pass that measures a unit compiles it alone, so it runs before `angles` turns its numbers, `roots` removes joints
#   and `files` gives its files other paths.
# - `layouts` counts a `<replicate>` as one block, so `replicates` must have written out those that cannot stay. It
#   finds them by the names, the angles and the sequence of their own file.
# - `body_reduction` settles the mass of fused bodies, by the rules that `inertia` would apply once more; it also takes
#   settings out of the classes, so the base's top class may set nothing any more (`choose_classes`).
# - `submodels` gives a name to the models that have none, `names` puts the prefix before it.
# - `defaults` writes names of classes that are final: `names` would prefix them again.
# - A part hangs on a place by its final name, with the angles of the model (`bodies`), and takes the pose of a site
#   from its class (`defaults`). Whether its body is aligned is known by then (`alignment`).
PASSES: tuple[Pass, ...] = (
    _pass(boundaries, "checked by the linker", "OWN_NAMES", stops=False),
    _pass(note_flexes, "noted by the linker", "OWN_NAMES ALONE", leaves="FLEXES_NOTED"),
    _pass(flex_turns, "checked by the linker", "FLEXES_NOTED OWN_NAMES", stops=False),
    _pass(replicates, "a copy by a `<replicate>`, written out", "ALONE OWN_NAMES", leaves="UNROLLED"),
    _pass(layouts, "the keys that `nkey` of `<size>` asks for, written out", "UNROLLED ALONE OWN_NAMES",
          leaves="LAID_OUT"),
    _pass(body_reduction, "as MuJoCo has it in its file alone, by `fusestatic` or `discardvisual`",
          "ALONE OWN_NAMES OWN_SECTIONS", leaves="REDUCED"),
    _pass(choose_classes, "the name of a top class, chosen by the linker", "REDUCED FLEXES_NOTED OWN_NAMES",
          leaves="CLASSES_CHOSEN"),
    _pass(top_level_defaults,
          "given by its class in its file alone, where the top class is written in several `<default>`",
          "CLASSES_CHOSEN ALONE OWN_NAMES", stops=False),
    _pass(alignment, "`alignfree`, made explicit", "REDUCED OWN_NAMES", leaves="ALIGNED", stops=False),
    _pass(inertia, "the inertia rules of its file, made explicit", "REDUCED ALONE OWN_NAMES"),
    _pass(fitted_sizes, "fitted by MuJoCo to the mesh's bounding box, by `fitaabb`", "REDUCED ALONE OWN_NAMES"),
    _pass(autolimits, "checked by the linker", "ALONE OWN_NAMES OWN_SECTIONS", stops=False),
    _pass(muscle_forces, "measured by MuJoCo on its file alone", "ALONE OWN_SECTIONS", stops=False),
    _pass(lengthranges, "measured by MuJoCo on its file alone", "ALONE OWN_SECTIONS"),
    _pass(angles, "in the model's unit of angle and Euler sequence", "UNROLLED OWN_NAMES", leaves="ANGLES_SHARED",
          ends="ALONE", rewrites=True),
    _pass(submodel_options, "an option of a model that it attaches, which MuJoCo merges", "OWN_SECTIONS",
          leaves="OPTIONS_ADOPTED"),
    _pass(agreement, "what the parts ask for", "OPTIONS_ADOPTED OWN_NAMES", stops=False),
    _pass(roots, "left out, as the part is welded to its place", "LAID_OUT OWN_NAMES", leaves="ROOTS_NOTED",
          ends="ALONE", stops=False),
    _pass(passthrough, "`passthrough`, which holds for all textures or for none", "OWN_SECTIONS", stops=False),
    _pass(files, "where the bundle has the file", "OPTIONS_ADOPTED OWN_NAMES OWN_SECTIONS", leaves="FILES_PLACED",
          ends="ALONE", rewrites=True),
    _pass(submodels, "where the bundle has the model", "OPTIONS_ADOPTED FILES_PLACED OWN_SECTIONS",
          leaves="MODELS_NAMED", ends="ALONE", rewrites=True),
    _pass(names, "the prefix of the part", "CLASSES_CHOSEN MODELS_NAMED OWN_NAMES OWN_SECTIONS", leaves="NAMES_FINAL",
          ends="ALONE OWN_NAMES", stops=False, rewrites=True),
    _pass(defaults, "the top class of its file", "NAMES_FINAL CLASSES_CHOSEN FLEXES_NOTED OWN_SECTIONS",
          leaves="CLASSES_WRAPPED", rewrites=True),
    _pass(bodies, "holds what the parts bring",
          "NAMES_FINAL CLASSES_WRAPPED ANGLES_SHARED ALIGNED ROOTS_NOTED FLEXES_NOTED LAID_OUT", leaves="JOINED",
          stops=False),
    # The passes from here on look at the joined tree; `check_replicates` also needs to know whose section it reads.
    _pass(check_replicates, "checked by the linker", "JOINED UNROLLED OWN_SECTIONS", stops=False),
    _pass(check_roots, "checked by the linker", "JOINED ROOTS_NOTED", stops=False),
    _pass(check_flexes, "checked by the linker", "JOINED FLEXES_NOTED CLASSES_WRAPPED", stops=False),
    _pass(worlds, "carried along with its part: it is measured in the world of its file",
          "JOINED NAMES_FINAL ANGLES_SHARED OWN_SECTIONS", stops=False),
    _pass(sections, "holds what the parts bring", "NAMES_FINAL CLASSES_WRAPPED FILES_PLACED MODELS_NAMED",
          ends="OWN_SECTIONS"),
    _pass(crossings, "written out for each copy of a `<replicate>`", "JOINED NAMES_FINAL", stops=False, rewrites=True),
    _pass(compiler, "the settings that hold for every part", "ANGLES_SHARED ALIGNED FILES_PLACED MODELS_NAMED",
          ends="ALONE", rewrites=True),
)  # fmt: skip

# These wait until nothing more is added to the model.
FINISHING: tuple[Pass, ...] = (
    _pass(keyframes, "laid out anew for the whole model", "LAID_OUT JOINED NAMES_FINAL", rewrites=True),
    _pass(memory_size, "the memory that the whole model needs", "JOINED"),
)

check_order((*PASSES, *FINISHING))
_ROWS = {row.run: row for row in (*PASSES, *FINISHING)}


def row_of(done: object) -> Pass | None:
    return _ROWS.get(done) if isinstance(done, FunctionType) else None


def link(linking: Linking) -> bool:
    """Make `linking.base` the flat model and use up the parts; False after an error that stops the passes."""
    for row in PASSES:
        before = linking.sink.error_count
        row.run(linking)
        linking.watch(linking.units, row.run)
        if row.stops and linking.sink.error_count > before:
            return False
    return True


def link_alone(linking: Linking) -> None:
    """Link a base without parts: only the paths of its files change. The caller has checked its names and keys."""
    for link_pass in (boundaries, crossings, files, submodels, compiler):
        link_pass(linking)


def finish(linking: Linking) -> None:
    for row in FINISHING:
        row.run(linking)
        linking.watch(linking.units, row.run)
    for part in linking.parts:
        linking.base.origins.adopt(part.unit.origins)
