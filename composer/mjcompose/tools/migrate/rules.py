"""What single changes do to a model where the table does not say it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from mjcompose.model.classes import childclass_of, default_tag
from mjcompose.model.files import stem
from mjcompose.model.grammar import number_text
from mjcompose.model.values import parse_int, parse_real
from mjcompose.tools.migrate.editing import Editing, called, later

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml.etree import _Element as Node

_GEOMS = ("body/geom", "default/geom")
_HAVE_BOTH = (*_GEOMS, "contact/pair", "default/pair", "body/flexcomp/contact", "deformable/flex/contact")


def _number_margins(editing: Editing, node: Node, name: str) -> float:
    text = editing.value(node, name)
    found = None if text is None else parse_real(text.split()[0]) if text.split() else None
    return 0.0 if found is None else found


def _shift(editing: Editing, sign: float) -> None:
    had = {
        node: (_number_margins(editing, node, "margin"), _number_margins(editing, node, "gap"))
        for node in editing.at(*_HAVE_BOTH)
    }
    of_classes = {default_tag(node) for node, (_, gap) in had.items() if gap and _is_of_class(node)}
    for node, (margin, gap) in had.items():
        writes = node.get("margin") is not None or node.get("gap") is not None
        if not writes or not (gap or (default_tag(node) in of_classes and node.get("gap") is not None)):
            continue
        new = margin + sign * gap
        if sign > 0 and new < 0:
            editing.refuse(node, f"{called(node)} would have a negative margin, which MuJoCo {editing.after} refuses")
            continue
        editing.set(node, "margin", number_text(round(new, 15)))


gap_inside, gap_outside = partial(_shift, sign=-1.0), partial(_shift, sign=1.0)
"""From 3.9 on the force begins at the margin and not at the margin less the gap; and the same back."""


def _is_of_class(node: Node) -> bool:
    parent = node.getparent()
    return parent is not None and parent.tag == "default"


def _combine(editing: Editing, factor: float, was: str, now: str) -> None:
    if editing is not editing.whole[0]:
        return  # a geom touches those of all models that are attached
    for name in ("margin", "gap"):
        geoms = [(each, node) for each in editing.whole for node in each.at("body/geom") if _collides(each, node)]
        values = [_number_margins(each, node, name) for each, node in geoms]
        having = [pair for pair, value in zip(geoms, values, strict=True) if value]
        if not having or (len(having) == 1 and not _is_copied(*having[0])):
            continue
        if len(set(values)) == 1:  # any two have the same: half of it each
            for each in editing.whole:
                for node in each.at(*_GEOMS):
                    if node.get(name) is not None:
                        each.set(node, name, number_text(_number_margins(each, node, name) * factor))
            continue
        first, node = having[0]
        several = "copies of one geom" if len(having) == 1 else f"{len(having)} geoms"
        first.warn(
            node,
            f"{several} have a `{name}`, and a contact of two of them has {was} in MuJoCo {editing.before}"
            f" and {now} in {editing.after}",
            f"write the `{name}` of such contacts as `<pair>`, or give it to one of the two geoms alone",
        )


larger_of_two = partial(_combine, factor=0.5, was="the larger", now="the sum")
sum_of_two = partial(_combine, factor=2.0, was="the sum", now="the larger")
"""Before 3.5 a contact had the larger margin of its two geoms, since then their sum."""


def _collides(editing: Editing, node: Node) -> bool:
    return any(editing.value(node, name) != "0" for name in ("contype", "conaffinity"))


def _is_copied(editing: Editing, node: Node) -> bool:
    """Whether the model may have several of it: a model may be attached more than once."""
    return editing is not editing.whole[0] or any(above.tag == "replicate" for above in node.iterancestors())


ROLES = ("rgb", "occlusion", "roughness", "metallic", "normal", "opacity", "emissive", "rgba", "orm")
_TURNED = ("euler", "axisangle", "xyaxes", "zaxis")


def split_passive(editing: Editing) -> None:
    """The flag `passive` is two flags since 3.3.6."""
    for node in editing.at("option/flag"):
        value = node.get("passive")
        if value is None:
            continue
        editing.rename(node, "passive", "spring")
        if node.get("damper") is None:
            editing.set(node, "damper", value)


def join_passive(editing: Editing) -> None:
    for node in editing.at("option/flag"):
        values = {name: node.get(name) or "enable" for name in ("spring", "damper")}
        if values["spring"] != values["damper"]:
            editing.refuse(
                node,
                f"MuJoCo {editing.after} can only disable springs and dampers together",
                attribute="spring" if node.get("spring") else "damper",
            )
        elif node.get("spring") is not None:
            editing.rename(node, "spring", "passive")
            editing.unset(node, "damper")
        elif node.get("damper") is not None:
            editing.rename(node, "damper", "passive")


def layers_by_role(editing: Editing) -> None:
    """A texture of a material was an element by its role in 3.2.1 to 3.2.4."""
    for role in ROLES:
        for node in editing.at(f"asset/material/{role}"):
            editing.retag(node, "layer")
            editing.set(node, "role", role)


def roles_by_layer(editing: Editing) -> None:
    for node in editing.at("asset/material/layer"):
        role = node.get("role")
        if role not in ROLES:
            editing.refuse(node, f"MuJoCo {editing.after} has no layer of the role `{role}`", attribute="role")
            continue
        editing.unset(node, "role")
        editing.retag(node, role)


def inertia_of_meshes(editing: Editing) -> None:
    """`exactmeshinertia` became an attribute of meshes in 3.2.5."""
    exact = any(node.get("exactmeshinertia") == "true" for node in editing.at("compiler"))
    for node in editing.at("compiler"):
        editing.unset(node, "exactmeshinertia")
    for node in editing.at("asset/mesh") if exact else ():
        if editing.value(node, "inertia") is None:
            editing.set(node, "inertia", "exact")


def inertia_of_all(editing: Editing) -> None:
    meshes = editing.at("asset/mesh")
    said = {node: editing.value(node, "inertia") or "legacy" for node in meshes}
    kinds = set(said.values())
    if kinds - {"legacy", "exact"} or len(kinds) > 1:
        for node, kind in said.items():
            if kind != "legacy":
                editing.refuse(
                    node,
                    f'MuJoCo {editing.after} has no `inertia="{kind}"` for one mesh alone',
                    "write the inertia of the bodies with this mesh as `<inertial>`",
                    attribute="inertia",
                )
        return
    if kinds == {"exact"}:
        editing.set(editing.within("compiler"), "exactmeshinertia", "true")
    for node in editing.at("asset/mesh", "default/mesh"):
        editing.unset(node, "inertia")


def shells_of_meshes(editing: Editing) -> None:
    """Whether the mass of a mesh is on its surface is said by the mesh since 3.3.0, and was by each geom."""
    wanted: dict[str, list[tuple[Node, bool]]] = {}
    for node in editing.at("body/geom"):
        mesh = editing.value(node, "mesh")
        if mesh is not None and (editing.value(node, "type") or "sphere") == "mesh":
            wanted.setdefault(mesh, []).append((node, editing.value(node, "shellinertia") == "true"))
    meshes = {str(node.get("name") or stem(str(node.get("file") or ""))): node for node in editing.at("asset/mesh")}
    for name, uses in wanted.items():
        shells = [node for node, shell in uses if shell]
        if not shells:
            continue
        if len(shells) < len(uses) or name not in meshes:
            editing.refuse(
                shells[0],
                f"only some of the geoms with the mesh `{name}` have their mass on the surface,"
                f" which MuJoCo {editing.after} says of the mesh",
                'make a second `<mesh>` of that file with `inertia="shell"`, and use it here',
                attribute="shellinertia",
            )
            continue
        editing.set(meshes[name], "inertia", "shell")
        for node in (*shells, *(each for each in editing.at("default/geom") if each.get("shellinertia"))):
            editing.unset(node, "shellinertia")
        editing.warn(meshes[name], _SURFACES.format(name), "write the inertia of its body as `<inertial>`")


_SURFACES = "the inertia of the surface of the mesh `{}` is computed more exactly since MuJoCo 3.3"


def shells_of_geoms(editing: Editing) -> None:
    """The same back: each geom with such a mesh says it."""
    for mesh in editing.at("asset/mesh"):
        if editing.value(mesh, "inertia") != "shell":
            continue
        name = str(mesh.get("name") or stem(str(mesh.get("file") or "")))
        for node in editing.at("body/geom"):
            if editing.value(node, "mesh") == name and (editing.value(node, "type") or "sphere") == "mesh":
                editing.set(node, "shellinertia", "true")
        if mesh.get("inertia") is not None:
            editing.unset(mesh, "inertia")
        editing.warn(mesh, _SURFACES.format(name), "write the inertia of its body as `<inertial>`")


def _quats_beside(editing: Editing) -> Iterator[tuple[Node, str]]:
    """Yield the elements with a `quat` whose class gives an orientation in another form, and that form."""
    for node in editing.at("body/geom", "body/site", "body/camera"):
        if node.get("quat") is None or any(node.get(name) is not None for name in _TURNED):
            continue
        force = editing.unit.classes.get(str(node.get("class") or childclass_of(node) or "main"))
        given = force.orientation(str(node.tag))
        if given is not None and given[0] in _TURNED:
            yield node, given[0]


def quats_that_were_ignored(editing: Editing) -> None:
    """Before 3.16 an orientation of a class in another form won over the `quat` of an element."""
    for node, _ in _quats_beside(editing):
        editing.unset(node, "quat")


def quats_that_are_read(editing: Editing) -> None:
    for node, form in _quats_beside(editing):
        editing.refuse(
            node,
            f"MuJoCo {editing.after} does not read the `quat` of {called(node)}, whose class gives `{form}`",
            f"write it as `{form}`, or take that from the class",
            attribute="quat",
        )


def limits_that_were_ignored(editing: Editing) -> None:
    """Before 3.14 a tendon's `actuatorfrcrange` did nothing without `actuatorfrclimited`."""
    for node in editing.at("tendon/spatial", "tendon/fixed"):
        if node.get("actuatorfrcrange") is not None and node.get("actuatorfrclimited") is None:
            editing.set(node, "actuatorfrclimited", "false")


def limits_that_are_meant(editing: Editing) -> None:
    for node in editing.at("tendon/spatial", "tendon/fixed"):
        if editing.value(node, "actuatorfrcrange") is not None and node.get("actuatorfrclimited") is None:
            editing.set(node, "actuatorfrclimited", "true")


def limited_by_hand(editing: Editing) -> None:
    """Before 3.11 an `<intvelocity>` was always limited, also where `autolimits` is off."""
    if all(node.get("autolimits") != "false" for node in editing.at("compiler")):
        return
    for node in editing.at("actuator/intvelocity"):
        if editing.value(node, "actrange") is None or editing.value(node, "actlimited") is not None:
            continue
        if later("3.16.0", editing.after):
            editing.set(node, "actlimited", "true")
        else:  # since 3.16 MuJoCo passes over the attribute, and refuses the actuator
            editing.refuse(
                node,
                f"MuJoCo {editing.after} refuses {called(node)} where `autolimits` is off",
                'take `autolimits="false"` away, and write what is not limited',
                attribute="actrange",
            )


def is_interpolated(node: Node) -> bool:
    return str(node.get("dof") or "full") in ("trilinear", "quadratic") or node.get("node") is not None


def dimension(node: Node) -> int:
    """Of a flex or flexcomp."""
    return parse_int(str(node.get("dim") or "2").strip()) or 2


def _flexes(editing: Editing) -> list[tuple[Node, Node]]:
    found = []
    for node in editing.at("body/flexcomp/elasticity", "deformable/flex/elasticity"):
        flex = node.getparent()
        if flex is not None:
            found.append((flex, node))
    return found


def _number(node: Node, name: str, default: float = 0.0) -> float:
    text = node.get(name)
    found = None if text is None else parse_real(text.strip())
    return default if found is None else found


def lines_did_not_bend(editing: Editing) -> None:
    """Before 3.17 `young` of a flex of dimension 1 was not read."""
    for flex, node in _flexes(editing):
        if dimension(flex) == 1 and _number(node, "young"):
            editing.set(node, "young", "0")


def lines_that_bend(editing: Editing) -> None:
    for flex, node in _flexes(editing):
        if dimension(flex) == 1 and _number(node, "young"):
            editing.warn(node, f"{called(flex)} does not bend in MuJoCo {editing.after}", None, attribute="young")


def _elastic(editing: Editing) -> Iterator[tuple[Node, Node, float, float, float, str]]:
    """Yield the elastic flexes with where their constants stand: `young`, `poisson`, `thickness` and `elastic2d`."""
    for flex, node in _flexes(editing):
        young, nu = _number(node, "young"), _number(node, "poisson")
        if young and not is_interpolated(flex):
            thickness, mode = _number(node, "thickness", -1.0), str(node.get("elastic2d") or "none")
            yield flex, node, young, nu, thickness, mode


def elastic_constants(editing: Editing) -> None:
    """Before 4.0 flexes were softer than `young` and `poisson` say: other numbers give the stiffness they had."""
    for flex, node, young, nu, thickness, mode in _elastic(editing):
        if dimension(flex) == 3:
            new = 2 * nu / (1 + 2 * nu)
            _write(editing, node, young=young * (1 + new) / (1 + nu), poisson=new)
        elif dimension(flex) == 2 and mode == "bend":
            _write(editing, node, young=0.75 * (1 - nu) * young)
        elif dimension(flex) == 2 and mode in ("stretch", "both"):
            if nu >= 0.25:
                editing.warn(
                    node,
                    f"no `poisson` gives the stiffness in MuJoCo 4.0 that {nu:g} had before",
                    "write `young` and `poisson` of the material anew",
                )
                continue
            if mode == "stretch":
                _write(editing, node, young=young * (1 + 2 * nu) / (4 * (1 + nu)), poisson=2 * nu)
            else:
                new = thickness * (3 * (1 - 2 * nu)) ** 0.5
                _write(editing, node, young=young * thickness * (1 + 2 * nu) / (4 * (1 + nu) * new), poisson=2 * nu,
                       thickness=new)  # fmt: skip


def constants_as_they_were(editing: Editing) -> None:
    """The same back."""
    for flex, node, young, nu, thickness, mode in _elastic(editing):
        if dimension(flex) == 3:
            old = nu / (2 * (1 - nu))
            _write(editing, node, young=young * (1 + old) / (1 + nu), poisson=old)
        elif dimension(flex) == 2 and mode == "bend":
            _write(editing, node, young=young / (0.75 * (1 - nu)))
        elif dimension(flex) == 2 and mode in ("stretch", "both"):
            old = nu / 2
            if mode == "stretch":
                _write(editing, node, young=young * 4 * (1 + old) / (1 + 2 * old), poisson=old)
            else:
                thin = thickness / (3 * (1 - 2 * old)) ** 0.5
                _write(editing, node, young=young * 4 * (1 + old) * thickness / (thin * (1 + 2 * old)), poisson=old,
                       thickness=thin)  # fmt: skip


def _write(editing: Editing, node: Node, **numbers: float) -> None:
    for name, value in numbers.items():
        if value or node.get(name) is not None:
            editing.set(node, name, number_text(float(f"{value:.12g}")))


def has_elasticity(editing: Editing) -> bool:
    return any(_number(node, "young") for each in editing.whole for _, node in _flexes(each))


def implicit_flexes(editing: Editing) -> None:
    """3.11 and 3.12 integrated flexes implicitly with the solver CG; since 3.13 that is the integrator `discrete`."""
    options = editing.at("option")
    integrator = next((str(node.get("integrator")) for node in reversed(options) if node.get("integrator")), "Euler")
    solver = next((str(node.get("solver")) for node in reversed(options) if node.get("solver")), "Newton")
    if integrator not in ("implicit", "implicitfast") or not has_elasticity(editing):
        return
    holder = next(node for node in reversed(options) if node.get("integrator"))
    editing.refuse(
        holder,
        f"MuJoCo {editing.after} has no elastic flex with the integrator `{integrator}`",
        'write `integrator="discrete"`, which is close to it'
        + (" with the solver CG" if solver == "CG" else "")
        + ', or `integrator="Euler"` with a small timestep',
        attribute="integrator",
    )


def shortcut_of_another(editing: Editing) -> None:
    """Before 3.16 the parameters that a class gives to one kind of actuator reached those of another kind."""
    for node in editing.root.iterfind("actuator/*"):
        tag = str(node.tag)
        here = editing.unit.classes.get(str(node.get("class") or "main"))
        around: list[tuple[str, Node]] = []
        found: object = here
        while found is not None:
            around += [(name, each) for name, several in found.elements.items() for each in several  # type: ignore[attr-defined]
                       if name in _SHORTCUTS and name != tag]  # fmt: skip
            found = found.parent  # type: ignore[attr-defined]
        if tag in _SHORTCUTS and any(_gives_gains(name, each) for name, each in around):
            editing.warn(
                node,
                f"{called(node)} has gains of its class that are written for another kind of actuator,"
                " which MuJoCo does not give it since 3.16, and gave it before",
                "write its gains on the actuator itself",
            )


_SHORTCUTS = (
    "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion", "pid",
    "dcmotor",
)  # fmt: skip
_GAINS = ("kp", "kv", "dampratio", "timeconst", "area", "diameter", "bias", "force", "scale", "gain")


def _gives_gains(tag: str, node: Node) -> bool:
    return tag != "motor" and any(node.get(name) is not None for name in _GAINS)


def keys_of_replicates(editing: Editing) -> None:
    """Before 3.16 each copy of a replicate had a copy of every key."""
    moving = [
        node for node in editing.at("replicate") if next(node.iter("joint", "freejoint", "attach"), None) is not None
    ]
    for node in editing.at("keyframe/key") if moving else ():
        editing.warn(
            node,
            f"MuJoCo makes a copy of {called(node)} for each copy of a `<replicate>` before 3.16,"
            " and keeps one, of the whole model, since then",
            "write its values for the whole model",
        )


def is_turned_frame(editing: Editing, node: Node) -> bool:
    """Whether a flexcomp is in a frame that moves what is in it."""
    above = node.getparent()
    while above is not None and above.tag in ("frame", "replicate"):
        if above.tag == "frame" and any(above.get(name) is not None for name in ("pos", "quat", *_TURNED)):
            return True
        above = above.getparent()
    return False
