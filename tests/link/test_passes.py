"""Examples of passes: the sections of two units that each of them changes, and its faults."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco
from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.link.agreement import agreement, passthrough
from mjcompose.link.angles import angles, check_flexes, flex_turns, note_flexes
from mjcompose.link.bodies import bodies
from mjcompose.link.defaults import choose_classes, defaults, top_level_defaults
from mjcompose.link.files import files
from mjcompose.link.inertia import body_reduction, fitted_sizes, inertia, lengthranges, muscle_forces
from mjcompose.link.keyframes import keyframes
from mjcompose.link.link import AT_THE_START, FINISHING, PASSES, Fact, row_of
from mjcompose.link.linking import AttachmentPlace, Joint, Linking, Part
from mjcompose.link.measure import measure_with
from mjcompose.link.names import names
from mjcompose.link.replicates import check_replicates, replicates
from mjcompose.link.settings import alignment, compiler, memory_requests, memory_size
from mjcompose.link.submodels import submodel_options, submodels
from mjcompose.link.unit_keys import layouts
from mjcompose.link.world import check_roots, roots, sections, worlds
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_text
from mjcompose.tree.unit import Unit


def print_after(
    run: object, part: str = "", base: str = "", *, files: Mapping[str, str] | None = None, **hung: Any
) -> None:
    """Link a part with the prefix `p/` to a base, up to a pass, and print the sections that this pass has changed.

    Both are the text inside `<mujoco>`; `files` are models that the part names, as whole texts. `hung` says how the
    part hangs, as in `_part`. Errors are printed, too.
    """
    linking, before, facts = _linked(run, part, base, files=files or {}, **hung)
    units = [("model" if Fact.JOINED in facts else "base", linking.base)]
    if Fact.OWN_SECTIONS in facts:  # also once the bodies of the part are in the base
        units += [("part", each.unit) for each in linking.parts]
    for (label, unit), old in zip(units, before, strict=False):
        for text in _sections(unit):
            if text not in old:
                print(f"{label}: {text}")  # noqa: T201
    for fault in linking.sink.diagnostics:
        print(f"{fault.severity.value}: {fault.message}")  # noqa: T201


def linking_after(run: object, part: str = "", base: str = "", **hung: Any) -> Linking:
    """Return the linking after a pass that only records facts. The arguments are those of `print_after`."""
    linking, _, _ = _linked(run, part, base, files={}, **hung)
    return linking


def _linked(
    run: object, part: str, base: str, files: Mapping[str, str], **hung: Any
) -> tuple[Linking, list[list[str]], set[Fact]]:
    """Return the linking after a pass, the sections of its units before it, and the facts that hold after it."""
    row = row_of(run)
    assert row is not None
    sink = Sink()
    measure = measure_with(Context(sink=sink, environment={}))
    linking = Linking(_unit("base", base), [_part(part, files, **hung)], sink, measure=measure)
    linking.notes.memory = memory_requests(linking)
    facts = set(AT_THE_START)
    before: list[list[str]] = []
    for each in (*PASSES, *FINISHING):
        before = [_sections(unit) for unit in linking.units]
        each.run(linking)
        facts = (facts | each.leaves) - each.ends
        if each is row:
            break
    return linking, before, facts


def _part(text: str, files: Mapping[str, str], *, on: str = "", joint: str = "", weld: bool = False) -> Part:
    """Return a part that is attached to the world, or to the site `on`, with a `joint` if one is given."""
    unit = _unit("part", text)
    unit.contents = {name: each.encode() for name, each in files.items()}
    place = AttachmentPlace("site", on) if on else AttachmentPlace()
    return Part(unit, "p/", place, joints=(Joint("joint", {"name": joint}),) if joint else (), weld=weld)


def _unit(label: str, text: str) -> Unit:
    sink = Sink()
    source = f"<mujoco>{text}</mujoco>".encode()
    unit = parse_text(source, sink, file=f"{label}.xml", directory=Path(), label=label)
    assert unit is not None, sink.diagnostics
    return unit


def _sections(unit: Unit) -> list[str]:
    sections = unit.root.iterchildren("*")
    return [" ".join(etree.tostring(each, with_tail=False).decode().split()) for each in sections]


# MuJoCo 3 gives the position the gains of the last section, with or without a class around it.
_ONLY_IN_4 = "" if mujoco.__version__.startswith("3.") else "runs"
# Doctest runs each of these.
__test__ = {
    agreement.__name__: """
Sizes make room for both; what contradicts the base is reported:

>>> part = '<option gravity="0 0 0" cone="elliptic"/><size nuserdata="3"/>'
>>> base = '<option gravity="0 0 -1"/>'
>>> print_after(agreement, part, base)
base: <option gravity="0 0 -1" cone="elliptic"/>
base: <size nuserdata="3"/>
error: `p/` needs `option.gravity` to be `0 0 0`, the model has `0 0 -1`
""",
    passthrough.__name__: """
>>> part = '<compiler passthrough="textures"/><asset><texture name="t" type="2d" file="t.png"/></asset>'
>>> print_after(passthrough, part)
base: <compiler passthrough="textures"/>
""",
    angles.__name__: """
The part is in degrees, MuJoCo's default, and the base is not:

>>> part = '<worldbody><body euler="180 0 0"><joint range="0 90"/></body></worldbody>'
>>> base = '<compiler angle="radian"/>'
>>> print_after(angles, part, base)
part: <worldbody><body euler="3.141592653589793 0 0"><joint range="0 1.5707963267948966"/></body></worldbody>
""",
    note_flexes.__name__: """
MuJoCo gives their vertices the joint settings of the top class:

>>> part = (
...     '<default><joint armature="2"/></default>'
...     '<worldbody><flexcomp name="f" type="grid" count="2 2 1" spacing="1 1 1"/></worldbody>'
... )
>>> linking_after(note_flexes, part).notes.flexes[0].joint
{'armature': '2'}
""",
    check_flexes.__name__: """
A flex takes the joint defaults of the body around it, which are those of the base here:

>>> part = (
...     '<default><joint armature="2"/></default>'
...     '<worldbody><flexcomp name="f" type="grid" count="2 2 1" dim="2"/></worldbody>'
... )
>>> base = '<worldbody><body><site name="tool"/></body></worldbody>'
>>> print_after(check_flexes, part, base, on="tool")
error: the flex of `p/` takes the joint defaults `armature="2"` alone, and here of MuJoCo
""",
    flex_turns.__name__: """
A `quat` that a frame would normalize is reported:

>>> part = (
...     '<worldbody><flexcomp name="f" type="grid" count="2 2 1" dim="2" quat="0 2 0 0"/></worldbody>'
... )
>>> print_after(flex_turns, part)
error: the flex of `p/` is turned by a `quat` of length 2: MuJoCo stretches it alone, and not below a frame
""",
    bodies.__name__: """
>>> part = '<worldbody><body/></worldbody>'
>>> base = '<worldbody><site name="s" pos="0 0 1"/></worldbody>'
>>> print_after(bodies, part, base, on="s")
model: <worldbody><site name="s" pos="0 0 1"/><frame pos="0 0 1" childclass="p/"><body/></frame></worldbody>
""",
    body_reduction.__name__: """
>>> part = (
...     '<compiler discardvisual="true"/>'
...     '<worldbody><geom size=".1"/><geom size=".2" contype="0" conaffinity="0"/></worldbody>'
... )
>>> print_after(body_reduction, part)
part: <compiler/>
part: <worldbody><geom size=".1"/></worldbody>
""",
    defaults.__name__: """
The actuator stands outside of the body tree and has to name the class:

>>> part = (
...     '<default><motor gear="2"/></default>'
...     '<worldbody><site name="s"/></worldbody>'
...     '<actuator><motor site="s"/></actuator>'
... )
>>> print_after(defaults, part)
base: <default><default class="p/"><motor gear="2"/></default></default>
part: <actuator><motor site="p/s" class="p/"/></actuator>
""",
    choose_classes.__name__: """
The top class of the base keeps its name as long as it sets nothing:

>>> linking_after(choose_classes, base='<default><default class="c"/></default>').base_class
>>> linking = linking_after(choose_classes, base='<default><geom density="5"/></default>')
>>> linking.base_class, linking.top_class(linking.parts[0].unit)
('base/', 'p/')
""",
    top_level_defaults.__name__: _ONLY_IN_4
    and """
>>> part = (
...     '<default><position kp="4"/></default><default><velocity kv="9"/></default>'
...     '<worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>'
...     '<actuator><position joint="j"/></actuator>'
... )
>>> print_after(top_level_defaults, part)
part: <actuator><position joint="j" kp="1"/></actuator>
""",
    files.__name__: """
>>> part = '<compiler meshdir="meshes"/><asset><mesh file="link.obj"/></asset>'
>>> print_after(files, part)
part: <asset><mesh file="assets/part/link.obj"/></asset>
""",
    inertia.__name__: """
A geom outside of `inertiagrouprange` gives its body no mass:

>>> part = (
...     '<compiler inertiagrouprange="0 1"/>'
...     '<worldbody><body><geom size=".1" group="2"/></body></worldbody>'
... )
>>> print_after(inertia, part)
part: <worldbody><body><geom size=".1" group="2" mass="0"/></body></worldbody>
""",
    fitted_sizes.__name__: """
>>> part = (
...     '<compiler fitaabb="true"/>'
...     '<asset><mesh name="m" vertex="-1 -1 -1 1 1 1 -1 1 1 1 -1 1 1 1 -1 -1 -1 1 -1 1 -1 1 -1 -1"/></asset>'
...     '<worldbody><geom type="sphere" mesh="m"/></worldbody>'
... )
>>> print_after(fitted_sizes, part)  # doctest: +ELLIPSIS
part: <worldbody><geom type="sphere" size="1"...
""",
    lengthranges.__name__: """
>>> part = (
...     '<compiler><lengthrange mode="all"/></compiler>'
...     '<worldbody><body><joint name="j" type="slide" range="0 1"/><geom size=".1"/></body></worldbody>'
...     '<actuator><motor joint="j"/></actuator>'
... )
>>> print_after(lengthranges, part)  # doctest: +ELLIPSIS
part: <compiler/>
part: <actuator><motor joint="j" lengthrange="-0.000...
""",
    muscle_forces.__name__: """
The peak force of a muscle follows from its `scale` and the bodies that it moves, here without the load on them:

>>> base = (
...     '<worldbody><body name="b"><joint name="j" axis="0 1 0"/>'
...     '<geom type="box" size=".1 .1 .1" mass="3" pos="1 0 0"/><site name="s"/></body></worldbody>'
...     '<actuator><muscle joint="j" scale="6" lengthrange="0 1"/></actuator>'
... )
>>> load = '<worldbody><body><geom size=".1"/></body></worldbody>'
>>> print_after(muscle_forces, load, base, on="s")  # doctest: +ELLIPSIS
base: <actuator><muscle joint="j" scale="6" lengthrange="0 1" force="18.1...
""",
    keyframes.__name__: """
The two keys of one name become one, in the order of the joints:

>>> part = (
...     '<worldbody><body><joint/><geom size=".1"/></body></worldbody>'
...     '<keyframe><key name="home" qpos="2"/></keyframe>'
... )
>>> base = (
...     '<worldbody><body><joint/><geom size=".1"/></body></worldbody>'
...     '<keyframe><key name="home" qpos="1"/></keyframe>'
... )
>>> print_after(keyframes, part, base)
model: <keyframe><key name="home" qpos="1 2"/></keyframe>
""",
    names.__name__: """
>>> part = (
...     '<worldbody><body name="b"><joint name="j"/></body></worldbody>'
...     '<actuator><motor joint="j"/></actuator>'
... )
>>> print_after(names, part)
part: <worldbody><body name="p/b"><joint name="p/j"/></body></worldbody>
part: <actuator><motor joint="p/j"/></actuator>
""",
    check_replicates.__name__: """
MuJoCo would copy the clock of the base, too, and the replicate must stay as the `<exclude>` refers to it:

>>> part = (
...     '<worldbody><replicate count="2"><body name="b"/></replicate></worldbody>'
...     '<contact><exclude body1="b" body2="b"/></contact>'
... )
>>> base = '<sensor><clock/></sensor>'
>>> print_after(check_replicates, part, base)
error: the `<replicate>` of `part.xml` would multiply the `<clock>` without a name of `base.xml`, too
""",
    replicates.__name__: """
Beside this replicate, MuJoCo would multiply the clock of the base:

>>> part = '<worldbody><replicate count="2"><geom name="g" size=".1"/></replicate></worldbody>'
>>> base = '<sensor><clock/></sensor>'
>>> print_after(replicates, part, base)
part: <worldbody><frame><geom name="g0" size=".1"/></frame><frame><geom name="g1" size=".1"/></frame></worldbody>
""",
    alignment.__name__: """
>>> part = (
...     '<compiler alignfree="true"/>'
...     '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
... )
>>> print_after(alignment, part)
part: <worldbody><body><freejoint align="true"/><geom size=".1"/></body></worldbody>
""",
    compiler.__name__: """
>>> base = '<compiler angle="radian" meshdir="m" inertiafromgeom="true"/>'
>>> print_after(compiler, base=base)
model: <compiler angle="radian"/>
""",
    memory_size.__name__: """
>>> base = '<worldbody>' + '<body><freejoint/><geom size=".1"/></body>' * 30 + '</worldbody>'
>>> part = '<size memory="1K"/><worldbody><body><joint/><geom size=".1"/></body></worldbody>'
>>> print_after(memory_size, part, base)  # doctest: +ELLIPSIS
warning: `size.memory` of `p/` is 1K, ...
""",
    submodel_options.__name__: """
>>> part = (
...     '<compiler conflict="merge"/><asset><model name="m" file="m.xml"/></asset>'
...     '<worldbody><attach model="m" body="b" prefix="q/"/></worldbody>'
... )
>>> model = '<mujoco><option timestep="0.004"/><worldbody><body name="b"/></worldbody></mujoco>'
>>> print_after(submodel_options, part, files={"m.xml": model})
part: <option timestep="0.004"/>
""",
    submodels.__name__: """
>>> part = '<asset><model file="m.xml"/></asset>'
>>> print_after(submodels, part, files={"m.xml": '<mujoco model="hand"/>'})
part: <asset><model file="assets/part/models/m.xml" name="hand"/></asset>
""",
    layouts.__name__: """
Keys that `nkey` asks for stay with their part when they are written:

>>> part = '<size nkey="1"/>'
>>> print_after(layouts, part)
part: <size/>
part: <keyframe><key/></keyframe>
""",
    roots.__name__: """
`weld` takes away the free joint of a part:

>>> part = '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
>>> base = '<worldbody><body><site name="tool"/></body></worldbody>'
>>> print_after(roots, part, base, on="tool", weld=True)
part: <worldbody><body><geom size=".1"/></body></worldbody>
""",
    check_roots.__name__: """
>>> part = '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
>>> base = '<worldbody><body><site name="tool"/></body></worldbody>'
>>> print_after(check_roots, part, base, on="tool")  # doctest: +ELLIPSIS
error: `p/` has a free joint at its root...
""",
    worlds.__name__: """
>>> part = (
...     '<worldbody><body name="b"><freejoint/><geom size=".1"/></body></worldbody>'
...     '<equality><connect body1="world" body2="b" anchor="0 0 1"/></equality>'
... )
>>> print_after(worlds, part, '<worldbody><site name="s" pos="3 0 0"/></worldbody>', on="s")
part: <equality><connect body1="world" body2="p/b" anchor="3 0 1"/></equality>
""",
    sections.__name__: """
>>> part = '<worldbody><site name="s"/></worldbody><sensor><gyro site="s"/></sensor>'
>>> base = '<sensor><clock/></sensor>'
>>> print_after(sections, part, base)
model: <sensor><clock/><gyro site="p/s"/></sensor>
""",
}
