"""The edits for changes that need more than a row of the table."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import takewhile

from lxml.etree import _Element as Node

from mjcompose.base.words import number_text
from mjcompose.tools.migrate.editing import Migration, called, later
from mjcompose.tree.classes import DefaultClass, childclass_of, default_tag
from mjcompose.tree.files import stem
from mjcompose.tree.history import place
from mjcompose.tree.values import parse_int, parse_real

_GEOMS = ("body/geom", "default/geom")
_HAVE_BOTH = (*_GEOMS, "contact/pair", "default/pair", "body/flexcomp/contact", "deformable/flex/contact")


def _number(editing: Migration, node: Node, name: str) -> float:
    words = (editing.value(node, name) or "").split()
    return (parse_real(words[0]) if words else None) or 0.0


def _shift(editing: Migration, sign: float) -> None:
    had = {node: (_number(editing, node, "margin"), _number(editing, node, "gap")) for node in editing.at(*_HAVE_BOTH)}
    of_classes = {default_tag(node) for node, (_, gap) in had.items() if gap and place(node).startswith("default/")}
    for node, (margin, gap) in had.items():
        writes = node.get("margin") is not None or node.get("gap") is not None
        if not writes or not (gap or (default_tag(node) in of_classes and node.get("gap") is not None)):
            continue
        new = margin + sign * gap
        if sign > 0 and new < 0:
            editing.refuse(node, f"{called(node)} would have a negative margin, which MuJoCo {editing.after} refuses")
        else:
            editing.set(node, "margin", number_text(round(new, 15)))


# Since 3.9 the force begins at the margin; before, at the margin less the gap.
gap_inside = partial(_shift, sign=-1.0)
gap_outside = partial(_shift, sign=1.0)


def _combine(editing: Migration, factor: float, was: str, now: str) -> None:
    if editing is not editing.whole[0]:
        return  # a geom touches the geoms of all attached models
    for name in ("margin", "gap"):
        geoms = [(each, node) for each in editing.whole for node in each.at("body/geom") if _collides(each, node)]
        values = [_number(each, node, name) for each, node in geoms]
        having = [pair for pair, value in zip(geoms, values, strict=True) if value]
        if not having or (len(having) == 1 and not _is_copied(*having[0])):
            continue
        if len(set(values)) == 1:
            for each in editing.whole:
                for node in each.at(*_GEOMS):
                    if node.get(name) is not None:
                        each.set(node, name, number_text(_number(each, node, name) * factor))
            continue
        first, node = having[0]
        several = "copies of one geom" if len(having) == 1 else f"{len(having)} geoms"
        has = f"a contact of two of them has {was} in MuJoCo {editing.before} and {now} in {editing.after}"
        help = f"write the `{name}` of such contacts as `<pair>`, or set it for only one of the two geoms"
        first.warn(node, f"{several} have a `{name}`: {has}", help)


# Since 3.5 a contact has the sum of the margins of its two geoms; before, the larger margin.
larger_of_two = partial(_combine, factor=0.5, was="the larger", now="the sum")
sum_of_two = partial(_combine, factor=2.0, was="the sum", now="the larger")


def _collides(editing: Migration, node: Node) -> bool:
    return any(editing.value(node, name) != "0" for name in ("contype", "conaffinity"))


def _is_copied(editing: Migration, node: Node) -> bool:
    """Return whether the model may have several copies of a geom: by `<replicate>`, or by attaching its model twice."""
    return editing is not editing.whole[0] or next(node.iterancestors("replicate"), None) is not None


ROLES = ("rgb", "occlusion", "roughness", "metallic", "normal", "opacity", "emissive", "rgba", "orm")
_TURNED = ("euler", "axisangle", "xyaxes", "zaxis")


def split_passive(editing: Migration) -> None:
    """Write the two flags that `passive` became in 3.3.6."""
    for node in editing.at("option/flag"):
        value = node.get("passive")
        if value is not None:
            editing.rename(node, "passive", "spring")
            if node.get("damper") is None:
                editing.set(node, "damper", value)


def join_passive(editing: Migration) -> None:
    for node in editing.at("option/flag"):
        spring = node.get("spring")
        damper = node.get("damper")
        if (spring or "enable") != (damper or "enable"):
            message = f"MuJoCo {editing.after} can only disable springs and dampers together"
            editing.refuse(node, message, attribute="spring" if spring else "damper")
        elif spring is not None or damper is not None:
            editing.rename(node, "damper" if spring is None else "spring", "passive")
            editing.unset(node, "damper")


def layers_by_role(editing: Migration) -> None:
    """Before 3.2.5 the element of a texture in a material was named after its role."""
    for role in ROLES:
        for node in editing.at(f"asset/material/{role}"):
            editing.retag(node, "layer")
            editing.set(node, "role", role)


def roles_by_layer(editing: Migration) -> None:
    for node in editing.at("asset/material/layer"):
        role = node.get("role")
        if role in ROLES:
            editing.unset(node, "role")
            editing.retag(node, role)
        else:
            editing.refuse(node, f"MuJoCo {editing.after} has no layer of the role `{role}`", attribute="role")


def inertia_of_meshes(editing: Migration) -> None:
    """`exactmeshinertia` became an attribute of meshes in 3.2.5."""
    exact = any(node.get("exactmeshinertia") == "true" for node in editing.at("compiler"))
    for node in editing.at("compiler"):
        editing.unset(node, "exactmeshinertia")
    if exact:
        for node in editing.at("asset/mesh"):
            if editing.value(node, "inertia") is None:
                editing.set(node, "inertia", "exact")


def inertia_of_all(editing: Migration) -> None:
    inertias = {node: editing.value(node, "inertia") or "legacy" for node in editing.at("asset/mesh")}
    kinds = set(inertias.values())
    if kinds - {"legacy", "exact"} or len(kinds) > 1:
        for node, kind in inertias.items():
            if kind != "legacy":
                message = f'MuJoCo {editing.after} has no `inertia="{kind}"` for one mesh alone'
                help = "write the inertia of the bodies with this mesh as `<inertial>`"
                editing.refuse(node, message, help, attribute="inertia")
        return
    if kinds == {"exact"}:
        editing.set(editing.within("compiler"), "exactmeshinertia", "true")
    for node in editing.at("asset/mesh", "default/mesh"):
        editing.unset(node, "inertia")


def shells_of_meshes(editing: Migration) -> None:
    """Since 3.3, a mesh specifies whether its mass is on its surface; before, each geom specified it."""
    wanted: dict[str, list[tuple[Node, bool]]] = {}
    for node in editing.at("body/geom"):
        mesh = _mesh_of(editing, node)
        if mesh is not None:
            wanted.setdefault(mesh, []).append((node, editing.value(node, "shellinertia") == "true"))
    meshes = {_name(node): node for node in editing.at("asset/mesh")}
    for name, uses in wanted.items():
        shells = [node for node, shell in uses if shell]
        if not shells:
            continue
        if len(shells) < len(uses) or name not in meshes:
            some = f"only some geoms with the mesh `{name}` have their mass on the surface"
            message = f"{some}, but MuJoCo {editing.after} has this setting on the mesh"
            help = 'make a second `<mesh>` of that file with `inertia="shell"`, and use it here'
            editing.refuse(shells[0], message, help, attribute="shellinertia")
            continue
        editing.set(meshes[name], "inertia", "shell")
        for node in (*shells, *editing.at("default/geom")):
            editing.unset(node, "shellinertia")
        editing.warn(meshes[name], *_surface(name))


def shells_of_geoms(editing: Migration) -> None:
    for mesh in editing.at("asset/mesh"):
        if editing.value(mesh, "inertia") == "shell":
            for node in editing.at("body/geom"):
                if _mesh_of(editing, node) == _name(mesh):
                    editing.set(node, "shellinertia", "true")
            editing.unset(mesh, "inertia")
            editing.warn(mesh, *_surface(_name(mesh)))


def _mesh_of(editing: Migration, geom: Node) -> str | None:
    return editing.value(geom, "mesh") if editing.value(geom, "type") == "mesh" else None


def _name(mesh: Node) -> str:
    return mesh.get("name") or stem(mesh.get("file") or "")


def _surface(name: str) -> tuple[str, str]:
    message = f"MuJoCo computes the inertia of the surface of the mesh `{name}` more exactly since 3.3"
    return message, "write the inertia of its body as `<inertial>`"


def _quats_beside(editing: Migration) -> Iterator[tuple[Node, str]]:
    """Yield the elements with a `quat` whose class gives an orientation in another form, and that form."""
    for node in editing.at("body/geom", "body/site", "body/camera"):
        if node.get("quat") is None or any(node.get(name) is not None for name in _TURNED):
            continue
        force = editing.unit.classes.get(str(node.get("class") or childclass_of(node) or "main"))
        given = force.orientation(str(node.tag))
        if given is not None and given[0] in _TURNED:
            yield node, given[0]


def quats_that_were_ignored(editing: Migration) -> None:
    """Before 3.16, an orientation of a class in another form had priority over the `quat` of an element."""
    for node, _ in _quats_beside(editing):
        editing.unset(node, "quat")


def quats_that_are_read(editing: Migration) -> None:
    for node, form in _quats_beside(editing):
        message = f"MuJoCo {editing.after} does not read the `quat` of {called(node)}, whose class gives `{form}`"
        editing.refuse(node, message, f"write it as `{form}`, or remove `{form}` from the class", attribute="quat")


def _limit_tendons(editing: Migration, value: str) -> None:
    """Before 3.14, a tendon's `actuatorfrcrange` had no effect without `actuatorfrclimited`."""
    for node in editing.at("tendon/spatial", "tendon/fixed"):
        has_range = editing.value(node, "actuatorfrcrange") if value == "true" else node.get("actuatorfrcrange")
        if has_range is not None and node.get("actuatorfrclimited") is None:
            editing.set(node, "actuatorfrclimited", value)


limits_that_were_ignored = partial(_limit_tendons, value="false")
limits_in_effect = partial(_limit_tendons, value="true")


def limited_by_hand(editing: Migration) -> None:
    """Before 3.11, an `<intvelocity>` was always limited, even with `autolimits` off."""
    if all(node.get("autolimits") != "false" for node in editing.at("compiler")):
        return
    for node in editing.at("actuator/intvelocity"):
        if editing.value(node, "actrange") is None or editing.value(node, "actlimited") is not None:
            continue
        if later("3.16.0", editing.after):
            editing.set(node, "actlimited", "true")
        else:  # since 3.16 MuJoCo ignores the attribute, and refuses the actuator
            message = f"MuJoCo {editing.after} refuses {called(node)} if `autolimits` is off"
            help = 'remove `autolimits="false"`, and write which elements are not limited'
            editing.refuse(node, message, help, attribute="actrange")


def dimension(flex: Node) -> int:
    return parse_int(str(flex.get("dim") or "2").strip()) or 2


def _elastic(editing: Migration) -> Iterator[tuple[Node, Node, float]]:
    """Yield the flexes with a `young`, their `<elasticity>`, and that number."""
    for node in editing.at("body/flexcomp/elasticity", "deformable/flex/elasticity"):
        flex = node.getparent()
        if flex is not None and (young := _constant(node, "young")):
            yield flex, node, young


def _constant(node: Node, name: str, default: float = 0.0) -> float:
    number = parse_real((node.get(name) or "").strip())
    return default if number is None else number


def lines_did_not_bend(editing: Migration) -> None:
    """Before 3.17 MuJoCo did not read `young` of a flex of dimension 1."""
    for flex, node, _ in _elastic(editing):
        if dimension(flex) == 1:
            editing.set(node, "young", "0")


def lines_that_bend(editing: Migration) -> None:
    for flex, node, _ in _elastic(editing):
        if dimension(flex) == 1:
            editing.warn(node, f"{called(flex)} does not bend in MuJoCo {editing.after}", None, attribute="young")


def _materials(editing: Migration) -> Iterator[tuple[Node, str, float, float, float]]:
    """Yield `<elasticity>`, form, `young`, `poisson` and `thickness` of each flex without interpolation."""
    for flex, node, young in _elastic(editing):
        if flex.get("dof") in ("trilinear", "quadratic") or flex.get("node") is not None:
            continue
        form = "solid" if dimension(flex) == 3 else str(node.get("elastic2d")) if dimension(flex) == 2 else ""
        yield node, form, young, _constant(node, "poisson"), _constant(node, "thickness", -1.0)


def elastic_constants(editing: Migration) -> None:
    """Before 4.0, flexes were softer than `young` and `poisson` specify: write numbers that give the same stiffness."""
    for node, form, young, nu, thickness in _materials(editing):
        if form == "solid":
            new = 2 * nu / (1 + 2 * nu)
            _write(editing, node, young=young * (1 + new) / (1 + nu), poisson=new)
        elif form == "bend":
            _write(editing, node, young=0.75 * (1 - nu) * young)
        elif form in ("stretch", "both") and nu >= 0.25:
            message = f"no `poisson` gives the stiffness in MuJoCo 4.0 that {nu:g} had before"
            editing.warn(node, message, "write `young` and `poisson` of the material")
        elif form == "stretch":
            _write(editing, node, young=young * (1 + 2 * nu) / (4 * (1 + nu)), poisson=2 * nu)
        elif form == "both":
            new = thickness * (3 * (1 - 2 * nu)) ** 0.5
            young = young * thickness * (1 + 2 * nu) / (4 * (1 + nu) * new)
            _write(editing, node, young=young, poisson=2 * nu, thickness=new)


def constants_as_they_were(editing: Migration) -> None:
    for node, form, young, nu, thickness in _materials(editing):
        old = nu / 2
        if form == "solid":
            old = nu / (2 * (1 - nu))
            _write(editing, node, young=young * (1 + old) / (1 + nu), poisson=old)
        elif form == "bend":
            _write(editing, node, young=young / (0.75 * (1 - nu)))
        elif form == "stretch":
            _write(editing, node, young=young * 4 * (1 + old) / (1 + 2 * old), poisson=old)
        elif form == "both":
            thin = thickness / (3 * (1 - 2 * old)) ** 0.5
            young = young * 4 * (1 + old) * thickness / (thin * (1 + 2 * old))
            _write(editing, node, young=young, poisson=old, thickness=thin)


def _write(editing: Migration, node: Node, **numbers: float) -> None:
    for name, value in numbers.items():
        if value or node.get(name) is not None:
            editing.set(node, name, number_text(float(f"{value:.12g}")))


def implicit_flexes(editing: Migration) -> None:
    """3.11 and 3.12 integrated flexes implicitly with the solver CG; since 3.13, the integrator `discrete` does."""
    options = {name: node for name in ("integrator", "solver") for node in editing.at("option") if node.get(name)}
    holder = options.get("integrator")
    integrator = None if holder is None else holder.get("integrator")
    is_elastic = any(next(_elastic(each), None) for each in editing.whole)
    if holder is None or integrator not in ("implicit", "implicitfast") or not is_elastic:
        return
    uses_cg = "solver" in options and options["solver"].get("solver") == "CG"
    message = f"MuJoCo {editing.after} has no elastic flex with the integrator `{integrator}`"
    help = f'write `integrator="discrete"`, which is close to it{" with the solver CG" if uses_cg else ""}'
    help += ', or `integrator="Euler"` with a small timestep'
    editing.refuse(holder, message, help, attribute="integrator")


def shortcut_of_another(editing: Migration) -> None:
    """Before 3.16, the gains that a class gives to one kind of actuator also applied to other kinds."""
    for node in editing.root.iterfind("actuator/*"):
        force: DefaultClass | None = editing.unit.classes.get(str(node.get("class") or "main"))
        others = [tag for tag in _SHORTCUTS if tag != node.tag]
        gains = False
        while force is not None:
            found = (each for tag in others for each in force.elements.get(tag, ()))
            gains |= any(each.get(name) is not None for each in found for name in _GAINS)
            force = force.parent
        if gains and node.tag in ("motor", *_SHORTCUTS):
            message = f"{called(node)} no longer has the gains that its class writes for other kinds, since MuJoCo 3.16"
            editing.warn(node, message, "write its gains on the actuator itself")


_SHORTCUTS = ("position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion", "pid", "dcmotor")
_GAINS = ("kp", "kv", "dampratio", "timeconst", "area", "diameter", "bias", "force", "scale", "gain")


def keys_of_replicates(editing: Migration) -> None:
    """Before 3.16 each copy of a replicate had a copy of every key."""
    if any(next(node.iter("joint", "freejoint", "attach"), None) is not None for node in editing.at("replicate")):
        for node in editing.at("keyframe/key"):
            message = f"MuJoCo copies {called(node)} for each copy of a `<replicate>` before 3.16, and not since then"
            editing.warn(node, message, "write its values for the whole model")


def is_in_a_moving_frame(editing: Migration, node: Node) -> bool:
    around = takewhile(lambda above: above.tag in ("frame", "replicate"), node.iterancestors())
    frames = (above for above in around if above.tag == "frame")
    return any(above.get(name) is not None for above in frames for name in ("pos", "quat", *_TURNED))
