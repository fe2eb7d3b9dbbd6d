"""Everything that changed in MJCF from MuJoCo 3.0 to 4.0, with the edits that keep the meaning of a model.

`docs/how-to/upgrade_mujoco.md` describes each change in a row. The facts come from MuJoCo's changelog and its wheels.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TypeAlias

from lxml.etree import _Element as Node

from mjcompose.tools.migrate import rules
from mjcompose.tools.migrate.editing import Act, Change, Migration, called, later
from mjcompose.tree.grammar import version_key
from mjcompose.tree.values import parse_real

Acts: TypeAlias = tuple[Act, Act]
Matches: TypeAlias = "Callable[[Migration, Node], bool]"


def rename(places: str, names: dict[str, str], words: dict[str, str] | None = None) -> Acts:
    """Rename attributes, and translate their values by `words`."""

    def act(editing: Migration, names: dict[str, str], words: dict[str, str] | None) -> None:
        pairs = ((*pair, node) for pair in names.items() for node in editing.at(*places.split()))
        for old, new, node in pairs:
            value = node.get(old)
            if value is None:
                continue
            if words is not None and value not in words:
                message = f'MuJoCo {editing.after} has no equivalent of `{old}="{value}"` of {called(node)}'
                editing.refuse(node, message, attribute=old)
            elif node.get(new) is not None:
                editing.unset(node, old)  # MuJoCo prefers the new name
            else:
                editing.rename(node, old, new, value=value if words is None else words[value])

    back = None if words is None else {value: key for key, value in words.items()}
    new_names = {new: old for old, new in names.items()}
    return partial(act, names=names, words=words), partial(act, names=new_names, words=back)


def keep_default(setting: str, was: str, now: str) -> Acts:
    """Write the old default of a setting of the whole model, if the model does not write the setting."""
    path, _, attribute = setting.rpartition("/")

    def act(editing: Migration, value: str) -> None:
        if any(node.get(attribute) is not None for node in editing.at(path)):
            return
        if editing.stage_reads(path, attribute):
            editing.set(editing.within(path), attribute, value)
        elif value != was:
            editing.warn(None, editing.lacking(path, attribute, value))

    return partial(act, value=was), partial(act, value=now)


def drop(places: str, attribute: str, harmless: str | None = None, lost: str = "") -> tuple[Act, None]:
    """Remove an attribute that MuJoCo no longer reads; warn with `lost` if its value is not `harmless`."""

    def carry_out(editing: Migration) -> None:
        for node in editing.at(*places.split()):
            value = node.get(attribute)
            if value is not None and lost and value != harmless:
                editing.warn(node, lost, attribute=attribute)
            editing.unset(node, attribute)

    return carry_out, None


def _report(
    report: Callable[..., None],
    places: str,
    message: str,
    help: str | None,
    matches: Matches = lambda editing, node: True,
) -> Acts:
    def carry_out(editing: Migration) -> None:
        for node in editing.at(*places.split()):
            if matches(editing, node):
                report(editing, node, message.format(called=called(node)), help=help)

    return carry_out, carry_out


advise = partial(_report, Migration.warn)
"""Report each matching element, which no rule can migrate, as a warning."""
refuse = partial(_report, Migration.refuse)
"""Report each matching element, which no rule can migrate, as an error."""


def _plugin(name: str, version: str, plugins: tuple[str, ...], places: str, help: str) -> Change:
    def uses_plugin(_: object, node: Node) -> bool:
        return node.get("plugin") in plugins

    message = "MuJoCo no longer has the plugin of {called}"
    act = refuse("extension/plugin " + places, message, help, matches=uses_plugin)[0]
    return Change(name, version, (act, None))


def _keep_colors(editing: Migration, value: str) -> None:
    for node in editing.at("asset/texture"):
        has_file = any(str(name).startswith("file") for name in node.attrib)
        is_default = has_file and editing.value(node, "colorspace") is None
        if is_default and editing.stage_reads("asset/texture", "colorspace"):
            editing.set(node, "colorspace", value)


def _internal(editing: Migration, word: str) -> None:
    for flex in editing.at("body/flexcomp", "deformable/flex"):
        contacts = list(flex.iterchildren("contact"))
        if any(each.get("internal") is not None for each in contacts):
            continue
        if not editing.stage_reads("body/flexcomp/contact", "internal"):
            if word == "true" and rules.dimension(flex) > 1:
                editing.warn(flex, f"{called(flex)} loses its contacts with itself")
        elif contacts:
            editing.set(contacts[-1], "internal", word)
        else:
            editing.insert(flex, "contact", {"internal": word})


def _headlight_back(editing: Migration) -> None:
    """Write `1` for `auto`, a word that only 4.0 has."""
    words = {"true": "1", "false": "0", "auto": "1", "2": "1"}
    for node in editing.at("visual/headlight"):
        value = node.get("active")
        if value in words:
            editing.set(node, "active", words[value])


def _dampratio(editing: Migration) -> None:
    """Write the damping that the earlier version computed; only that version of MuJoCo can compute it."""
    measured = editing.values.get("kv")
    for node in editing.root.iterfind("actuator/*"):
        ratio = editing.value(node, "dampratio")
        if ratio is None or not parse_real(ratio.strip()):
            continue
        known = measured.get(str(node.get("name") or "")) if isinstance(measured, dict) else None
        if known is None:
            message = f"MuJoCo {editing.after} and {editing.before} compute another damping from the `dampratio` of"
            help = "write the damping as `kv`; `--with-python` or `--prove` does it, with the other MuJoCo"
            editing.warn(node, f"{message} {called(node)}", help)
        elif node.get("dampratio") is not None:
            editing.rename(node, "dampratio", "kv", known)
        else:
            editing.set(node, "kv", known)


def _is_weighed_mesh(editing: Migration, node: Node) -> bool:
    if editing.value(node, "type") != "mesh" or editing.value(node, "mass") is not None:
        return False
    body = next(each for each in node.iterancestors() if each.tag not in ("frame", "replicate"))
    return body.tag == "body" and body.find("inertial") is None


def _is_fitted_to_box(editing: Migration, node: Node) -> bool:
    fits_boxes = any(each.get("fitaabb") == "true" for each in editing.at("compiler"))
    is_mesh = (editing.value(node, "type") or "sphere") in ("mesh", "sdf")
    return fits_boxes and not is_mesh and editing.value(node, "mesh") is not None


def _has_motor_inputs(editing: Migration, node: Node) -> bool:
    return node.get("controller") is not None or not set((node.get("input") or "voltage").split()) <= {"voltage"}


def _is_mocap_with_geoms(editing: Migration, node: Node) -> bool:
    return node.get("mocap") == "true" and next(node.iter("geom"), None) is not None


def _turns_by_rk4(editing: Migration, node: Node) -> bool:
    return node.get("integrator") == "RK4" and any(
        next(each.root.iter("freejoint"), None) is not None
        or any(each.value(joint, "type") in ("ball", "free") for joint in each.at("body/joint"))
        for each in editing.whole
    )


_CONTACTS = "body/flexcomp/contact deformable/flex/contact"
_FLEXES = "body/flexcomp/plugin body/composite/plugin deformable/flex/plugin"

TABLE: tuple[Change, ...] = (
    Change("mesh-volume", "3.0.1", advise(
        "body/geom", "MuJoCo computes the mass of {called} from its volume since 3.0.1, and from its box before",
        "write the mass as `mass`, or the inertia of the body as `<inertial>`", matches=_is_weighed_mesh),
        arrays=("body_mass", "body_inertia", "body_ipos")),
    Change("flexcomp-class", "3.0.1", drop("body/flexcomp", "class")),
    Change("sensor-noise", "3.1.4", drop(
        "option/flag", "sensornoise", "disable",
        "MuJoCo no longer adds noise to sensors: it only stores the number `noise`"), arrays=("flags.sensornoise",)),
    Change("camera-color", "3.2.0", keep_default("visual/rgba/camera", "0.6 0.9 0.6 0.3", "0.6 0.9 0.6 1"),
           arrays=("vis.rgba.camera",)),
    Change("ccd-names", "3.2.3", rename(
        "option", {"mpr_iterations": "ccd_iterations", "mpr_tolerance": "ccd_tolerance"}),
        arrays=("opt.ccd_iterations", "opt.ccd_tolerance")),
    Change("mesh-inertia", "3.2.5", (rules.inertia_of_meshes, rules.inertia_of_all),
           arrays=("body_mass", "body_inertia")),
    Change("convex-hull", "3.2.5", drop(
        "compiler", "convexhull", "true", "MuJoCo always makes the convex hull of a mesh that collides")),
    Change("layers", "3.2.5", (rules.layers_by_role, rules.roles_by_layer), arrays=("mat_texid",), since="3.2.1"),
    Change("native-ccd", "3.3.0", keep_default("option/flag/nativeccd", "disable", "enable"),
           arrays=("flags.nativeccd",)),
    Change("shell-meshes", "3.3.0", (rules.shells_of_meshes, rules.shells_of_geoms),
           arrays=("body_inertia", "body_ipos", "geom_pos", "geom_quat")),
    Change("flex-internal", "3.3.1", (partial(_internal, word="true"), partial(_internal, word="false")),
           arrays=("flex_internal",)),
    Change("light-type", "3.3.3", (None, rename(  # later versions still read `directional`
        "body/light default/light", {"directional": "type"}, {"true": "directional", "false": "spot"})[1]),
        arrays=("light_type",)),
    Change("texture-colors", "3.3.3", (partial(_keep_colors, value="linear"), partial(_keep_colors, value="auto")),
           arrays=("tex_colorspace",)),
    _plugin("shell-plugin", "3.3.3", plugins=("mujoco.elasticity.shell",), places=_FLEXES,
            help='write `<elasticity young="…" poisson="…" thickness="…" elastic2d="bend"/>` into the flex'),
    _plugin("solid-plugins", "3.2.4", plugins=("mujoco.elasticity.solid", "mujoco.elasticity.membrane"), places=_FLEXES,
            help='write `<elasticity young="…" poisson="…" damping="…"/>` into the flex'),
    _plugin("sdf-plugin", "3.3.5", plugins=("mujoco.sdf.sdflib",), places="body/geom/plugin asset/mesh/plugin",
            help='write `<geom type="sdf" mesh="…"/>` without a plugin'),
    Change("passive", "3.3.6", (rules.split_passive, rules.join_passive), arrays=("flags.spring", "flags.damper")),
    Change("islands", "3.3.6", keep_default("option/flag/island", "disable", "enable"), arrays=("flags.island",)),
    Change("apirate", "3.3.7", drop("option", "apirate")),
    Change("ccd-iterations", "3.3.7", keep_default("option/ccd_iterations", "50", "35"),
           arrays=("opt.ccd_iterations",)),
    Change("fit-to-box", "3.3.7", advise(
        "body/geom", "MuJoCo fits {called} to the box of its mesh differently since 3.3.7",
        "write its size and place", matches=_is_fitted_to_box),
        arrays=("geom_size", "geom_pos", "geom_quat", "body_mass", "body_inertia")),
    Change("margins", "3.5.0", (rules.larger_of_two, rules.sum_of_two), arrays=("contact_margin", "contact_gap")),
    Change("projection", "3.5.0", rename(
        "body/camera default/camera", {"orthographic": "projection"},
        {"true": "orthographic", "false": "perspective"}), arrays=("cam_projection",), since="3.2.0"),
    Change("flex-vertices", "3.7.0", drop(
        _CONTACTS, "vertcollide", "false", "vertices of a flex no longer collide by themselves"),
        arrays=("geom names",), since="3.3.3"),
    Change("multiple-contacts", "3.8.0", keep_default("option/flag/multiccd", "disable", "enable"),
           arrays=("flags.multiccd",)),
    Change("gap", "3.9.0", (rules.gap_inside, rules.gap_outside), arrays=("geom_margin", "pair_margin")),
    Change("tactile", "3.9.0", advise(
        "sensor/tactile", "{called} measures a depth since MuJoCo 3.9, and measured a pressure before", None),
        since="3.3.5"),
    Change("sleep-tolerance", "3.11.0", keep_default("option/sleep_tolerance", "0.0001", "0.001"),
           arrays=("opt.sleep_tolerance",), since="3.4.0"),
    Change("integrated-limits", "3.11.0", (rules.limited_by_hand, None), arrays=("actuator_actlimited",)),
    Change("bounding-volumes", "3.12.0", keep_default("visual/global/bvactive", "true", "false"),
           arrays=("vis.global.bvactive",), since="3.1.2"),
    Change("motor-inputs", "3.12.0", refuse(
        "actuator/dcmotor default/dcmotor", "the controller of {called} has other gains in the other version",
        "forward: `pos` for `position`, `vel` for `velocity`, gains times K/R, and K²/R more of kd",
        matches=_has_motor_inputs), since="3.7.0"),
    Change("mocap-bodies", "3.12.0", advise(
        "body", "{called} collides differently with static geoms and its children since MuJoCo 3.12",
        "exclude the pairs that must not collide", matches=_is_mocap_with_geoms), arrays=("body_weldid",)),
    Change("flex-integration", "3.13.0", (rules.implicit_flexes, None)),
    Change("tendon-forces", "3.14.0", (rules.limits_that_were_ignored, rules.limits_in_effect),
           arrays=("tendon_actfrclimited",), since="3.3.1"),
    Change("damping-ratio", "3.15.0", (_dampratio, _dampratio), arrays=("actuator_biasprm",), since="3.1.6"),
    Change("flex-inside", "3.15.0", drop(
        _CONTACTS, "internal", "false", "`internal` no longer gives a flex contacts with itself"),
        arrays=("flex_internal",)),
    Change("class-orientation", "3.16.0", (rules.quats_that_were_ignored, rules.quats_that_are_read),
           arrays=("geom_quat", "site_quat", "cam_quat")),
    Change("keys-of-copies", "3.16.0", (rules.keys_of_replicates,) * 2, arrays=("key_qpos",), since="3.1.5"),
    Change("actuator-classes", "3.16.0", (rules.shortcut_of_another,) * 2,
           arrays=("actuator_gainprm", "actuator_biasprm", "actuator_biastype")),
    Change("rods", "3.17.0", (rules.lines_did_not_bend, rules.lines_that_bend),
           arrays=("flex_bending", "flex_stiffness"), since="3.2.3"),
    Change("cables", "4.0.0", (refuse(
        "body/composite", "MuJoCo 4.0 has no {called}",
        'write a `<flexcomp dim="1">` with `<elasticity young="…" shear="…"/>`, and `integrator="discrete"`')[0],
        None)),
    Change("flex-stiffness", "4.0.0", (rules.elastic_constants, rules.constants_as_they_were),
           arrays=("flex_stiffness", "flex_bending"), since="3.3.3"),
    Change("flexes-in-frames", "4.0.0", advise(
        "body/flexcomp", "the frame around {called} moves it since MuJoCo 4.0, and did not before",
        "write it outside the `<frame>`", matches=rules.is_in_a_moving_frame),
        arrays=("flex_vert", "body_pos", "flex_vert0"), since="3.1.0"),
    Change("headlight", "4.0.0", (keep_default("visual/headlight/active", "1", "auto")[0], _headlight_back),
           arrays=("vis.headlight.active",)),
    Change("side-sites", "4.0.0", advise(
        "tendon/spatial/geom", "the tendon of {called} determines its side of the geom differently since MuJoCo 4.0",
        "put the side site near the middle of the arc", matches=lambda editing, node: node.get("sidesite") is not None),
        arrays=("tendon_length0",)),
    Change("runge-kutta", "4.0.0", advise(
        "option", "`RK4` integrates ball and free joints more exactly since MuJoCo 4.0", None, matches=_turns_by_rk4)),
)  # fmt: skip
ORDERED = tuple(sorted(TABLE, key=lambda change: version_key(change.version)))


def between(before: str, after: str) -> Iterator[tuple[Change, Act | None]]:
    """Yield the changes between two versions with their edits, in the order in which they are made."""
    is_back = later(before, after)
    low, high = sorted(map(version_key, (before, after)))
    in_order = reversed(ORDERED) if is_back else ORDERED
    for change in in_order:
        if low < version_key(change.version) <= high and version_key(change.since) <= low:
            yield change, change.acts[is_back]
