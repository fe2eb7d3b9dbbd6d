"""The linker: parts with a meaning of their own become one flat model in which each still means what it meant."""

from __future__ import annotations

from collections.abc import Callable

from composer.link.agreement import agreement
from composer.link.alignment import alignment
from composer.link.angles import angles
from composer.link.bodies import bodies
from composer.link.compiler import compiler
from composer.link.defaults import choose_classes, defaults
from composer.link.files import files
from composer.link.fitting import fitting
from composer.link.flex_joints import check_flexes, note_flexes
from composer.link.flex_turns import flex_turns
from composer.link.inertia import inertia
from composer.link.key_layouts import layouts
from composer.link.keyframes import keyframes
from composer.link.lengthranges import lengthranges
from composer.link.linking import Linking
from composer.link.names import names
from composer.link.passthrough import passthrough
from composer.link.reductions import reductions
from composer.link.replicate_capture import spurious
from composer.link.replicates import replicates
from composer.link.room import room
from composer.link.root_rules import check_roots, roots
from composer.link.sections import sections
from composer.link.submodel_options import submodel_options
from composer.link.submodels import submodels
from composer.link.top_level_defaults import several_defaults

Pass = Callable[[Linking], None]

# In order: while the units are apart each is rewritten to read the same under one set of settings; then they join.
PASSES: tuple[Pass, ...] = (
    note_flexes,
    flex_turns,
    replicates,
    layouts,
    reductions,
    choose_classes,
    several_defaults,
    alignment,
    inertia,
    fitting,
    lengthranges,
    angles,
    submodel_options,
    agreement,
    roots,
    passthrough,
    files,
    submodels,
    names,
    defaults,
    bodies,
    spurious,
    check_roots,
    check_flexes,
    sections,
    compiler,
)


# What these find hinders no later pass: those have faults of their own to tell.
_HINDERS_NOTHING = (
    flex_turns,
    several_defaults,
    alignment,
    agreement,
    roots,
    passthrough,
    names,
    bodies,
    spurious,
    check_roots,
    check_flexes,
)


def link(linking: Linking) -> bool:
    """Make `linking.base` the flat model; the units of the parts are used up.

    False where a pass found errors that later passes cannot live with; then the names of the model are not known.
    """
    before = linking.sink.error_count
    for link_pass in PASSES:
        link_pass(linking)
        linking.watch(linking.units, link_pass)
        after = linking.sink.error_count
        if after > before and link_pass not in _HINDERS_NOTHING:
            return False
        before = after
    return True


def link_alone(linking: Linking) -> None:
    """The same for a base without parts: nothing of it has to change but the paths of its files.

    Its names are not looked at, nor its keys: whoever calls knows that its names are right.
    """
    for link_pass in (files, submodels, compiler):
        link_pass(linking)


def finish(linking: Linking) -> None:
    """What must wait until nothing more is added to the model: the keyframes, and the memory that it needs."""
    keyframes(linking)
    linking.watch(linking.units, keyframes)
    room(linking)
    linking.watch(linking.units, room)
    for part in linking.parts:
        linking.base.origins.adopt(part.unit.origins)
