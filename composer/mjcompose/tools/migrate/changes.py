"""All that became different in MJCF from MuJoCo 3.0 to 4.0, each with what a model needs to mean the same.

Both directions, the page and the tests are made of this table. The facts are those of MuJoCo's changelog, and of what
the wheel of each version compiles.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.dataclass import dataclass
from mjcompose.model.grammar import version_key
from mjcompose.model.values import parse_real
from mjcompose.tools.migrate import rules
from mjcompose.tools.migrate.editing import Editing, called

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

Act = Callable[[Editing], None]


class Sort(StrEnum):
    """What kind of change it is, and so what becomes of a model."""

    NAME = "another name"
    DEFAULT = "another default"
    MEANING = "another meaning"
    GONE = "taken away"
    ENGINE = "another result of the simulation"


@dataclass(frozen=True, slots=True)
class Change:
    """`version` is the first one that has what is new. `forward` makes a model of an earlier one mean the same in it,
    `backward` one of it mean the same in an earlier one. `of` is what it is about, `was` and `now` say it before and
    after, `becomes` what is written. `arrays` are those of `mjModel` in which it shows; without any it shows only in a
    simulation. `since` is the first version that had what was before.
    """

    name: str
    version: str
    sort: Sort
    of: str
    was: str
    now: str
    becomes: str
    forward: Act | None = None
    backward: Act | None = None
    arrays: tuple[str, ...] = ()
    since: str = "3.0.0"


def rename(places: str, old: str, new: str, words: dict[str, str] | None = None) -> tuple[Act, Act]:
    """An attribute that has another name, and perhaps other words; both directions."""

    def act(old: str, new: str, words: dict[str, str] | None) -> Act:
        def carry_out(editing: Editing) -> None:
            for node in editing.at(*places.split()):
                value = node.get(old)
                if value is None:
                    continue
                if words is not None and value not in words:
                    editing.refuse(node, f'`{old}="{value}"` of {called(node)} has no word in MuJoCo {editing.after}',
                                   attribute=old)  # fmt: skip
                    continue
                if node.get(new) is not None:
                    editing.unset(node, old)  # MuJoCo takes the new one where both are written
                    continue
                editing.rename(node, old, new, value=value if words is None else words[value])

        return carry_out

    back = None if words is None else {value: key for key, value in words.items()}
    return act(old, new, words), act(new, old, back)


def keep_default(path: str, attribute: str, was: str, now: str) -> tuple[Act, Act]:
    """A setting of the whole model with another default: what was meant is written out; both directions."""

    def act(value: str) -> Act:
        def carry_out(editing: Editing) -> None:
            if any(node.get(attribute) is not None for node in editing.at(path)):
                return
            if editing.stage_reads(path, attribute):
                editing.set(editing.within(path), attribute, value)
            elif value != was:
                editing.warn(None, editing.lacking(path, attribute, value))

        return carry_out

    return act(was), act(now)


def _keep_colors() -> tuple[Act, Act]:
    """The color space of textures with a file has another default: it is written on those that say nothing."""

    def act(value: str) -> Act:
        def carry_out(editing: Editing) -> None:
            for node in editing.at("asset/texture"):
                is_meant = editing.value(node, "colorspace") is None and _has_file(node)
                if is_meant and editing.stage_reads("asset/texture", "colorspace"):
                    editing.set(node, "colorspace", value)

        return carry_out

    return act("linear"), act("auto")


def drop(places: str, attribute: str, harmless: tuple[str, ...], lost: str | None = None) -> Act:
    """An attribute that is not read any more: taken away; a warning where it said something else than `harmless`."""

    def carry_out(editing: Editing) -> None:
        for node in editing.at(*places.split()):
            value = node.get(attribute)
            if value is None:
                continue
            if harmless and value not in harmless and lost is not None:
                editing.warn(node, lost.format(value=value, called=called(node)), attribute=attribute)
            editing.unset(node, attribute)

    return carry_out


def advise(places: str, message: str, help: str | None, of: Callable[[Editing, Node], bool] | None = None) -> Act:
    """What cannot be migrated by a rule: a located warning for each element that it is about."""
    return _at_each(places, of, lambda editing, node: editing.warn(node, message.format(called=called(node)), help))


def refuse(places: str, message: str, help: str, of: Callable[[Editing, Node], bool] | None = None) -> Act:
    """What the other version cannot say at all: a located error for each element that it is about."""
    return _at_each(places, of, lambda editing, node: editing.refuse(node, message.format(called=called(node)), help))


def _at_each(places: str, of: Callable[[Editing, Node], bool] | None, report: Callable[[Editing, Node], None]) -> Act:
    def carry_out(editing: Editing) -> None:
        for node in editing.at(*places.split()):
            if of is None or of(editing, node):
                report(editing, node)

    return carry_out


NAME, DEFAULT, MEANING, GONE, ENGINE = Sort.NAME, Sort.DEFAULT, Sort.MEANING, Sort.GONE, Sort.ENGINE


def _flag(
    name: str, version: str, of: str, was: str, now: str, since: str = "3.0.0", arrays: str | None = None
) -> Change:
    path, _, attribute = of.rpartition("/")
    return Change(
        name, version, DEFAULT, f"`{attribute}` of `<{path.rpartition('/')[2]}>`", f"`{was}`", f"`{now}`",
        "what was meant is written where nothing is", *keep_default(path, attribute, was, now),
        arrays=(arrays or f"flags.{attribute}",), since=since,
    )  # fmt: skip


def _plugin(*names: str) -> Callable[[Editing, Node], bool]:
    return lambda editing, node: str(node.get("plugin")) in names


def _each(*pairs: tuple[str, str]) -> tuple[Act, Act]:
    """Several options with another name."""
    acts = [rename("option", old, new) for old, new in pairs]

    def forward(editing: Editing) -> None:
        for act, _ in acts:
            act(editing)

    def backward(editing: Editing) -> None:
        for _, act in acts:
            act(editing)

    return forward, backward


def _twice(act: Act) -> tuple[Act, Act]:
    """The same forward and backward."""
    return act, act


def _internal(was: bool) -> Act:
    """Write the default of `internal` of the earlier or the later version on every flex."""

    def carry_out(editing: Editing) -> None:
        for flex in editing.at("body/flexcomp", "deformable/flex"):
            contacts = list(flex.iterchildren("contact"))
            if any(each.get("internal") is not None for each in contacts):
                continue
            if not editing.stage_reads("body/flexcomp/contact", "internal"):
                if was and rules.dimension(flex) > 1:
                    editing.warn(flex, f"{called(flex)} had contacts with itself, and has none any more")
            elif contacts:
                editing.set(contacts[-1], "internal", "true" if was else "false")
            else:
                editing.insert(flex, "contact", {"internal": "true" if was else "false"})

    return carry_out


def _headlight() -> tuple[Act, Act]:
    """`auto` is a word of 4.0 alone: what it means in a model goes back as `1`."""
    forward, _ = keep_default("visual/headlight", "active", "1", "auto")

    def backward(editing: Editing) -> None:
        words = {"true": "1", "false": "0", "auto": "1", "2": "1"}
        for node in editing.at("visual/headlight"):
            value = node.get("active")
            if value in words:
                editing.set(node, "active", words[value])

    return forward, backward


def _dampratio(editing: Editing) -> None:
    """The damping that the earlier version computed, where that is known; it is not without its MuJoCo."""
    measured = editing.values.get("kv")
    for node in editing.root.iterfind("actuator/*"):
        ratio = editing.value(node, "dampratio")
        if ratio is None or not parse_real(ratio.strip()):
            continue
        name = str(node.get("name") or "")
        known = measured.get(name) if isinstance(measured, dict) else None
        if known is not None and node.get("dampratio") is not None:
            editing.rename(node, "dampratio", "kv", known)
        elif known is not None:
            editing.set(node, "kv", known)
        else:
            editing.warn(
                node,
                f"{called(node)} has another damping by its `dampratio` in MuJoCo {editing.after} than in"
                f" {editing.before}",
                "write the damping as `kv`; with the other MuJoCo (`--with-python`, `--prove`) that is done",
            )


def _weighs(node: Node) -> bool:
    body = node.getparent()
    while body is not None and body.tag in ("frame", "replicate"):
        body = body.getparent()
    return body is not None and body.tag == "body" and next(body.iterchildren("inertial"), None) is None


def _has_file(node: Node) -> bool:
    return any(name.startswith("file") for name in map(str, node.keys()))


def _fits_boxes(editing: Editing) -> bool:
    return any(node.get("fitaabb") == "true" for node in editing.at("compiler"))


def _turns(editing: Editing) -> bool:
    return any(
        next(each.root.iter("freejoint"), None) is not None
        or any(each.value(node, "type") in ("ball", "free") for node in each.at("body/joint"))
        for each in editing.whole
    )


TABLE: tuple[Change, ...] = (
    Change(
        "mesh-volume", "3.0.1", MEANING, "the mass of a mesh", "that of the box with its inertia", "that of its volume",
        "nothing: the proof lists the bodies",
        *_twice(advise("body/geom",
               "the mass of {called} is that of its volume since MuJoCo 3.0.1, and was another one before",
               "write the mass as `mass`, or the inertia of the body as `<inertial>`",
               lambda editing, node: editing.value(node, "type") == "mesh" and editing.value(node, "mass") is None
               and _weighs(node))),
        arrays=("body_mass", "body_inertia", "body_ipos"),
    ),
    Change(
        "flexcomp-class", "3.0.1", GONE, "`class` of `<flexcomp>`", "read, without effect", "refused",
        "it is taken away",
        drop("body/flexcomp", "class", ()),
    ),
    Change(
        "sensor-noise", "3.1.4", GONE, "`sensornoise` of `<flag>`", "adds `noise` to sensors", "refused",
        "it is taken away, with a warning where it was enabled",
        drop("option/flag", "sensornoise", ("disable",),
             "MuJoCo adds no noise to sensors any more: `noise` is only kept as a number"),
        arrays=("flags.sensornoise",),
    ),
    Change(
        "camera-color", "3.2.0", DEFAULT, "`camera` of `<rgba>`", "`0.6 0.9 0.6 0.3`", "`0.6 0.9 0.6 1`",
        "what was meant is written where nothing is",
        *keep_default("visual/rgba", "camera", "0.6 0.9 0.6 0.3", "0.6 0.9 0.6 1"), arrays=("vis.rgba.camera",),
    ),
    Change(
        "ccd-names", "3.2.3", NAME, "`mpr_iterations` and `mpr_tolerance` of `<option>`", "these", "`ccd_…`",
        "they get the other name", *_each(("mpr_iterations", "ccd_iterations"), ("mpr_tolerance", "ccd_tolerance")),
        arrays=("opt.ccd_iterations", "opt.ccd_tolerance"),
    ),
    Change(
        "mesh-inertia", "3.2.5", NAME, "`exactmeshinertia` of `<compiler>`", "for all meshes",
        "`inertia` of each `<mesh>`",
        "each mesh gets `inertia=\"exact\"`", rules.inertia_of_meshes, rules.inertia_of_all,
        arrays=("body_mass", "body_inertia"),
    ),
    Change(
        "convex-hull", "3.2.5", GONE, "`convexhull` of `<compiler>`", "`false` makes no hulls of meshes", "refused",
        "it is taken away, with a warning where it was `false`",
        drop("compiler", "convexhull", ("true",), "MuJoCo always makes the convex hull of a mesh that collides"),
    ),
    Change(
        "layers", "3.2.5", NAME, "textures of a `<material>` by role", "`<rgb texture=…/>`",
        "`<layer role=\"rgb\" texture=…/>`", "they get the other form", rules.layers_by_role, rules.roles_by_layer,
        arrays=("mat_texid",), since="3.2.1",
    ),
    _flag("native-ccd", "3.3.0", "option/flag/nativeccd", "disable", "enable"),
    Change(
        "shell-meshes", "3.3.0", MEANING, "`shellinertia` of a `<geom>` with a mesh", "puts the mass on the surface",
        "ignored: `inertia` of the `<mesh>` says it", "the mesh gets `inertia=\"shell\"`", rules.shells_of_meshes,
        rules.shells_of_geoms, arrays=("body_inertia", "body_ipos", "geom_pos", "geom_quat"),
    ),
    Change(
        "flex-internal", "3.3.1", DEFAULT, "`internal` of the `<contact>` of a flex", "`true`", "`false`",
        "it is written on every flex, up to 3.14", _internal(True), _internal(False), arrays=("flex_internal",),
    ),
    Change(
        "light-type", "3.3.3", NAME, "`directional` of `<light>`", "this", "`type`",
        "forward nothing, for it is still read; backward it gets the other name",
        None, rename("body/light default/light", "directional", "type", {"true": "directional", "false": "spot"})[1],
        arrays=("light_type",),
    ),
    Change(
        "texture-colors", "3.3.3", DEFAULT, "`colorspace` of a `<texture>` with a file", "linear",
        "what the file says",
        "`colorspace=\"linear\"` is written where nothing is", *_keep_colors(),
        arrays=("tex_colorspace",),
    ),
    Change(
        "shell-plugin", "3.3.3", GONE, "the plugin `mujoco.elasticity.shell`", "bends a flex", "does not exist",
        "nothing: an error with what to write",
        refuse("extension/plugin body/flexcomp/plugin body/composite/plugin deformable/flex/plugin",
               "the plugin of {called} does not exist any more",
               'write `<elasticity young="…" poisson="…" thickness="…" elastic2d="bend"/>` into the flex',
               _plugin("mujoco.elasticity.shell")),
    ),
    Change(
        "solid-plugins", "3.2.4", GONE, "the plugins `mujoco.elasticity.solid` and `membrane`", "stretch a flex",
        "do not exist", "nothing: an error with what to write",
        refuse("extension/plugin body/flexcomp/plugin body/composite/plugin deformable/flex/plugin",
               "the plugin of {called} does not exist any more",
               'write `<elasticity young="…" poisson="…" damping="…"/>` into the flex',
               _plugin("mujoco.elasticity.solid", "mujoco.elasticity.membrane")),
    ),
    Change(
        "sdf-plugin", "3.3.5", GONE, "the plugin `mujoco.sdf.sdflib`", "makes a distance field of a mesh",
        "does not exist: `type=\"sdf\"` with a mesh does it", "nothing: an error with what to write",
        refuse("extension/plugin body/geom/plugin asset/mesh/plugin", "the plugin of {called} does not exist any more",
               'write `<geom type="sdf" mesh="…"/>` without a plugin', _plugin("mujoco.sdf.sdflib")),
    ),
    Change(
        "passive", "3.3.6", NAME, "`passive` of `<flag>`", "this", "`spring` and `damper`", "it becomes both",
        rules.split_passive, rules.join_passive, arrays=("flags.spring", "flags.damper"),
    ),
    _flag("islands", "3.3.6", "option/flag/island", "disable", "enable"),
    Change(
        "apirate", "3.3.7", GONE, "`apirate` of `<option>`", "read, without effect", "refused", "it is taken away",
        drop("option", "apirate", ()),
    ),
    _flag("ccd-iterations", "3.3.7", "option/ccd_iterations", "50", "35", arrays="opt.ccd_iterations"),
    Change(
        "fit-to-box", "3.3.7", MEANING, "a geom that `fitaabb` fits to a mesh", "with an offset", "around its box",
        "nothing: a warning at each such geom",
        *_twice(advise("body/geom", "{called} is fitted to the box of its mesh in another way since MuJoCo 3.3.7",
               "write its size and place", lambda editing, node: editing.value(node, "mesh") is not None
               and (editing.value(node, "type") or "sphere") not in ("mesh", "sdf") and _fits_boxes(editing))),
        arrays=("geom_size", "geom_pos", "geom_quat", "body_mass", "body_inertia"),
    ),
    Change(
        "margins", "3.5.0", MEANING, "`margin` and `gap` of a contact", "the larger of its two geoms", "their sum",
        "half of it where all geoms have the same, else a warning", rules.larger_of_two, rules.sum_of_two,
        arrays=("contact_margin", "contact_gap"),
    ),
    Change(
        "projection", "3.5.0", NAME, "`orthographic` of `<camera>`", "`true`, `false`",
        "`projection`: `orthographic`, `perspective`", "it gets the other name", *rename(
            "body/camera default/camera", "orthographic", "projection",
            {"true": "orthographic", "false": "perspective"}), arrays=("cam_projection",), since="3.2.0",
    ),
    Change(
        "flex-vertices", "3.7.0", GONE, "`vertcollide` of the `<contact>` of a flex", "read by MJX alone", "refused",
        "it is taken away, with a warning where it was `true`",
        drop("body/flexcomp/contact deformable/flex/contact", "vertcollide", ("false",),
             "vertices of a flex do not collide by themselves any more"), since="3.3.3",
        arrays=("geom names",),
    ),
    _flag("multiple-contacts", "3.8.0", "option/flag/multiccd", "disable", "enable"),
    Change(
        "gap", "3.9.0", MEANING, "`margin` where there is a `gap`", "contacts begin at it, forces at `margin - gap`",
        "forces begin at it, contacts at `margin + gap`", "`margin` less `gap` is written",
        rules.gap_inside, rules.gap_outside,
        arrays=("geom_margin", "pair_margin"),
    ),
    Change(
        "tactile", "3.9.0", ENGINE, "the sensor `tactile`", "a pressure", "a depth", "nothing: a warning",
        *_twice(advise(
            "sensor/tactile", "{called} measures a depth since MuJoCo 3.9, and measured a pressure before", None)),
        since="3.3.5",
    ),
    _flag("sleep-tolerance", "3.11.0", "option/sleep_tolerance", "0.0001", "0.001", "3.4.0", "opt.sleep_tolerance"),
    Change(
        "integrated-limits", "3.11.0", DEFAULT, "`actlimited` of `<intvelocity>`", "`true`",
        "`auto`: where there is an `actrange`",
        "`actlimited=\"true\"` where `autolimits` is off, up to 3.15; an error since then", rules.limited_by_hand,
        arrays=("actuator_actlimited",),
    ),
    _flag("bounding-volumes", "3.12.0", "visual/global/bvactive", "true", "false", "3.1.2", "vis.global.bvactive"),
    Change(
        "motor-inputs", "3.12.0", MEANING, "`input` and the controller of `<dcmotor>`", "one setpoint, gains in volts",
        "several inputs, gains in torques", "nothing: an error with what to write", *_twice(refuse(
            "actuator/dcmotor default/dcmotor", "the controller of {called} has other gains in the other version",
            "forward: `pos` for `position`, `vel` for `velocity`, gains times K/R, and K²/R more of kd",
            lambda editing, node: node.get("controller") is not None
            or not set(str(node.get("input") or "voltage").split()) <= {"voltage"})), since="3.7.0",
    ),
    Change(
        "mocap-bodies", "3.12.0", MEANING, "a mocap body", "welded to the world", "welded to nothing",
        "nothing: a warning",
        *_twice(advise("body", "{called} collides with static geoms and its children in another way since MuJoCo 3.12",
               "exclude what shall not collide", lambda editing, node: node.get("mocap") == "true"
               and next(node.iter("geom"), None) is not None)),
        arrays=("body_weldid",),
    ),
    Change(
        "flex-integration", "3.13.0", GONE, "an elastic flex with the integrator `implicit` or `implicitfast`",
        "simulated", "an error", "nothing: an error with what to write", rules.implicit_flexes,
    ),
    Change(
        "tendon-forces", "3.14.0", DEFAULT, "`actuatorfrclimited` of a tendon", "`false`", "`auto`",
        "what was meant is written where there is an `actuatorfrcrange`", rules.limits_that_were_ignored,
        rules.limits_that_are_meant, arrays=("tendon_actfrclimited",), since="3.3.1",
    ),
    Change(
        "damping-ratio", "3.15.0", MEANING, "the damping that `dampratio` gives", "from the inertia of single joints",
        "from the inertia of all together", "with a proof, the `kv` that it gave; else a warning", *_twice(_dampratio),
        arrays=("actuator_biasprm",), since="3.1.6",
    ),
    Change(
        "flex-inside", "3.15.0", GONE, "`internal` of the `<contact>` of a flex", "contacts within a flex", "refused",
        "it is taken away, with a warning where it was `true`",
        drop("body/flexcomp/contact deformable/flex/contact", "internal", ("false",),
             "a flex has no contacts with itself by `internal` any more"), arrays=("flex_internal",),
    ),
    Change(
        "class-orientation", "3.16.0", MEANING, "`quat` of an element whose class gives an orientation in another form",
        "ignored", "read", "such a `quat` is taken away", rules.quats_that_were_ignored,
        rules.quats_that_are_read, arrays=("geom_quat", "site_quat", "cam_quat"),
    ),
    Change(
        "keys-of-copies", "3.16.0", MEANING, "a `<key>` in a model with `<replicate>`", "one for each copy",
        "one of the whole model", "nothing: a warning", *_twice(rules.keys_of_replicates),
        arrays=("key_qpos",), since="3.1.5",
    ),
    Change(
        "actuator-classes", "3.16.0", MEANING, "gains that a class writes for another kind of actuator", "inherited",
        "not inherited", "nothing: a warning at each such actuator", *_twice(rules.shortcut_of_another),
        arrays=("actuator_gainprm", "actuator_biasprm", "actuator_biastype"),
    ),
    Change(
        "rods", "3.17.0", MEANING, "`young` of a flex of dimension 1", "not read", "bends it",
        "it becomes 0; back, a warning",
        rules.lines_did_not_bend, rules.lines_that_bend, arrays=("flex_bending", "flex_stiffness"), since="3.2.3",
    ),
    Change(
        "cables", "4.0.0", GONE, "`<composite>`", "makes bodies, joints and geoms", "does not exist",
        "nothing: an error with what to write",
        refuse("body/composite", "MuJoCo 4.0 has no {called}",
               'write a `<flexcomp dim="1">` with `<elasticity young="…" shear="…"/>`, and `integrator="discrete"`'),
    ),
    Change(
        "flex-stiffness", "4.0.0", MEANING, "`young`, `poisson` and `thickness` of a flex", "make it too soft",
        "are those of the material", "the numbers that give the stiffness it had", rules.elastic_constants,
        rules.constants_as_they_were, arrays=("flex_stiffness", "flex_bending"), since="3.3.3",
    ),
    Change(
        "flexes-in-frames", "4.0.0", MEANING, "a `<flexcomp>` in a `<frame>`", "left where it is without it",
        "moved by it", "nothing: a warning",
        *_twice(advise("body/flexcomp", "{called} is moved by the frame around it since MuJoCo 4.0, and was not before",
               "write it outside of the `<frame>`", rules.is_turned_frame)),
        arrays=("flex_vert", "body_pos", "flex_vert0"), since="3.1.0",
    ),
    Change(
        "headlight", "4.0.0", DEFAULT, "`active` of `<headlight>`", "`1`", "`auto`",
        "what was meant is written where nothing is", *_headlight(), arrays=("vis.headlight.active",),
    ),
    Change(
        "side-sites", "4.0.0", ENGINE, "`sidesite` of a tendon", "a half plane", "the way through the site",
        "nothing: a warning",
        *_twice(advise("tendon/spatial/geom",
               "the tendon of {called} finds its side of the geom in another way since MuJoCo 4.0",
               "put the side site near the middle of the arc", lambda editing, node: node.get("sidesite") is not None)),
        arrays=("tendon_length0",),
    ),
    Change(
        "runge-kutta", "4.0.0", ENGINE, "`integrator=\"RK4\"` with ball and free joints", "second order",
        "fourth order",
        "nothing: a warning",
        *_twice(advise("option", "`RK4` integrates ball and free joints more exactly since MuJoCo 4.0", None,
               lambda editing, node: node.get("integrator") == "RK4" and _turns(editing))),
    ),
)  # fmt: skip


def between(before: str, after: str) -> Iterator[tuple[Change, Act | None]]:
    """The changes that lie between two versions, in the order in which they are carried out."""
    first, last = version_key(before), version_key(after)
    low, high = min(first, last), max(first, last)
    found = [each for each in ORDERED if low < version_key(each.version) <= high]
    if first <= last:
        yield from ((each, each.forward) for each in found if version_key(each.since) <= first)
    else:
        yield from ((each, each.backward) for each in reversed(found) if version_key(each.since) <= last)


def named(name: str) -> Change | None:
    return next((each for each in TABLE if each.name == name), None)


ORDERED = tuple(sorted(TABLE, key=lambda each: version_key(each.version)))


PAGE = Path(__file__).resolve().parents[4] / "docs" / "migrate.md"
_TABLE = re.compile(r"(?<=<!-- changes -->\n).*?(?=<!-- end of changes -->)", re.DOTALL)


def table() -> str:
    """A row for each change."""
    lines = ["| since | change | of | before | now | what becomes of a model | back |", "|---|---|---|---|---|---|---|"]
    lines += [
        f"| {each.version.removesuffix('.0')} | `{each.name}` | {each.of} | {each.was} | {each.now} | {each.becomes}"
        f" | {'–' if each.backward is None else 'yes'} |"
        for each in ORDERED
    ]
    return "\n".join(lines) + "\n"


def with_table(page: str) -> str:
    """The text of the page with the table as it is now."""
    return _TABLE.sub(lambda _: table(), page)


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
