"""The plainest MJCF of a model, made by passes.

MuJoCo's compiler moves each mesh into a frame of its own, and moves its geoms accordingly. Every mesh is written with
these vertices, so a program that uses files unchanged sees the same surface.
"""

from __future__ import annotations

import copy
import posixpath
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.naming import portable_step
from mjcompose.base.words import number_text
from mjcompose.mujoco.arrays import words
from mjcompose.mujoco.attributes import NameTable, save_digits
from mjcompose.mujoco.index import compiled_order
from mjcompose.targets.target import Draft
from mjcompose.tree.classes import ORIENTATIONS, Classes, chain, given, text_in_effect
from mjcompose.tree.files import file_attributes, join, stem
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.select import kind_of
from mjcompose.tree.values import items, parse_real

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


def text(values: Any) -> str:
    """Return one or several numbers with the fewest digits that their precision needs.

    >>> text([0.1, 2.0]), text(np.float32(0.1))
    ('0.1 2', '0.1')
    """
    return " ".join(_one(value) for value in np.ravel(values))


def _one(value: Any) -> str:
    if isinstance(value, np.integer):
        return str(int(value))
    if isinstance(value, np.bool_):
        return "true" if value else "false"
    if value == 0:
        return "0"
    write = np.format_float_positional if 1e-5 <= abs(value) < 1e16 else np.format_float_scientific
    return write(value, trim="-", unique=True)


_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_MISNAMED = {"potential": "e_potential", "kinetic": "e_kinetic"}
"""Sensors that MuJoCo 3.11 and 3.12 save under names that they do not read."""


def saved(mujoco: Any, spec: Any) -> Node:
    """Return the tree that MuJoCo saves for a compiled spec. Angles are in radians."""
    compiler = spec.compiler
    for setting in ("savecompiled", "savecanonical"):
        if hasattr(compiler, setting):
            setattr(compiler, setting, True)
    save_digits(mujoco)
    # A comment may contain `--`, which MuJoCo reads and writes although XML does not allow it.
    root = etree.fromstring(_COMMENT.sub("", spec.to_xml()))
    for text in root.iterfind("custom/text"):
        if text.text and text.get("data") is None:  # MuJoCo saves text that has to be escaped as CDATA
            text.set("data", str(text.text))
            text.text = None
    for element in root.iterfind("sensor/*"):
        element.tag = _MISNAMED.get(str(element.tag), element.tag)
    for element in root.iter("*"):
        kind = kind_of(element)
        for name, value in element.items():
            attribute = kind.attributes.get(str(name))
            if attribute is not None and attribute.is_number:  # MuJoCo writes 0.1 as 0.10000000000000001
                numbers = [parse_real(each) for each in items(str(value))]
                if None not in numbers:
                    element.set(str(name), " ".join(number_text(each) for each in numbers if each is not None))
    return root


def without_classes(root: Node) -> None:
    """Write all values that elements get from their classes, then remove the classes.

    >>> from lxml import etree
    >>> classes = '<default><geom friction=".5"/></default>'
    >>> root = etree.fromstring(f'<mujoco>{classes}<worldbody><geom size="1"/></worldbody></mujoco>')
    >>> without_classes(root)
    >>> etree.tostring(root)
    b'<mujoco><worldbody><geom size="1" friction=".5 0.005 0.0001"/></worldbody></mujoco>'
    """
    classes = Classes(root)
    found = []
    for section in root.iterchildren("*"):
        if section.tag != "default":
            for element in section.iter("*"):
                kind = kind_of(element)
                names = [attribute.name for attribute, _ in given(element, kind, classes)]
                if element.tag == "material":
                    _layers(element, classes)
                found.append((element, {name: text_in_effect(element, kind, name, classes=classes) for name in names}))
    for element, texts in found:
        for name, text in texts.items():
            if text is not None:
                element.set(name, _without_zeros(text) if name in _POLYNOMIALS else text)
    for element in root.iter("*"):
        if element.tag != "default":
            for name in ("class", "childclass"):
                element.attrib.pop(name, "")
    for section in list(root.iterchildren("default")):
        root.remove(section)


_POLYNOMIALS = ("damping", "stiffness")
"""Attributes of one number in older versions of MJCF, and in the programs that read them."""


def _without_zeros(text: str) -> str:
    """Return the coefficients of a polynomial without the zeros at their end; the linear one stays."""
    linear, *higher = text.split() or [""]
    while higher and float(higher[-1]) == 0:
        higher.pop()
    return " ".join([linear, *higher])


def _layers(material: Node, classes: Classes) -> None:
    """Write the textures of a material by their roles. The class's textures count if the material has none."""
    if next(material.iterchildren("layer"), None) is not None:
        return
    for each in chain(material, classes):
        for writer in reversed(each.elements.get("material", [])):
            layers = list(writer.iterchildren("layer"))
            if layers:
                material.extend(copy.deepcopy(layers))
                return


def without_frames(root: Node) -> None:
    """Replace each frame by its children.

    >>> from lxml import etree
    >>> inner = "<frame><body/><frame><geom/></frame></frame><site/>"
    >>> root = etree.fromstring(f"<mujoco><worldbody>{inner}</worldbody></mujoco>")
    >>> without_frames(root)
    >>> [str(each.tag) for each in root[0]]
    ['body', 'geom', 'site']
    """
    for frame in list(root.iter("frame"))[::-1]:
        holder = frame.getparent()
        assert holder is not None
        at = holder.index(frame)
        holder[at : at + 1] = list(frame)


def keep_files(root: Node, folder: Path, spec: Any) -> dict[str, bytes]:
    """Return the content of the files by path. Meshes are excluded, because they are written again. Raises OSError."""
    files: dict[str, bytes] = {}
    for element, attribute, name in list(file_attributes(root)):
        if element.tag == "mesh":
            continue
        under = spec.texturedir if element.tag == "texture" else spec.meshdir
        path = join(under or "", posixpath.basename(name) if spec.strippath else name)
        element.set(attribute, path)
        files[path] = (folder / path).read_bytes()
    return files


FOLDER = "assets"
_GONE = (
    "file",
    "content_type",
    "vertex",
    "normal",
    "texcoord",
    "face",
    "refpos",
    "refquat",
    "scale",
    "smoothnormal",
    "builtin",
    "params",
)
_NOT_IN_FILES = re.compile(r"[^A-Za-z0-9_.-]+")


def write_meshes(root: Node, model: MjModel, names: list[str]) -> dict[str, bytes]:
    """Make each mesh name its file, and return the files by path. `names` are the names of the compiled meshes."""
    ids = {name: number for number, name in enumerate(names)}
    files: dict[str, bytes] = {}
    for mesh in root.iterfind("asset/mesh"):
        number = ids[mesh.get("name") or stem(str(mesh.get("file")))]
        if next(mesh.iterchildren("plugin"), None) is not None:
            continue  # a plugin makes its surface
        mesh.set("name", names[number])
        for attribute in _GONE:
            mesh.attrib.pop(attribute, "")
        name = f"{FOLDER}/{portable_step(_NOT_IN_FILES.sub('_', names[number]))}"
        copies = 1
        path = f"{name}.obj"
        taken = {each.casefold() for each in files}
        while path.casefold() in taken:
            copies += 1
            path = f"{name}_{copies}.obj"
        mesh.set("file", path)
        files[path] = obj(model, number)
    return files


def obj(model: MjModel, number: int) -> bytes:
    """Return a mesh of a compiled model as an OBJ file."""
    return ("\n".join(_lines(model, number)) + "\n").encode()


def _lines(model: MjModel, number: int) -> Iterator[str]:
    def rows(name: str) -> Any:
        start = getattr(model, f"mesh_{name}adr")[number]
        return getattr(model, f"mesh_{name}")[start : start + getattr(model, f"mesh_{name}num")[number]].tolist()

    faces = slice(model.mesh_faceadr[number], model.mesh_faceadr[number] + model.mesh_facenum[number])
    corners = [model.mesh_face[faces], model.mesh_facenormal[faces]]
    yield from ("v {:.9g} {:.9g} {:.9g}".format(*each) for each in rows("vert"))
    if model.mesh_texcoordadr[number] >= 0:
        # MuJoCo flips the second texture coordinate of OBJ files.
        yield from (f"vt {u:.9g} {np.float32(1) - np.float32(v):.9g}" for u, v in rows("texcoord"))
        corners.insert(1, model.mesh_facetexcoord[faces])
    yield from ("vn {:.9g} {:.9g} {:.9g}".format(*each) for each in rows("normal"))
    between = "/" if len(corners) == 3 else "//"
    for face in np.stack(corners, axis=-1) + 1:
        yield "f " + " ".join(between.join(map(str, corner)) for corner in face.tolist())


_DYNAMICS = ("dyntype", "dynprm", "actrange", "actlimited", "actdim", "actearly")
_MOTOR = {
    *GRAMMAR.element("actuator/motor").attributes,
    "gaintype",
    "gainprm",
    "biastype",
    "biasprm",
    "input",
}
_GAIN = ("gaintype", "gainprm", "biastype", "biasprm", "input")


def simple_actuators(root: Node, *, any_input: bool = False) -> None:
    """Rename each `general` actuator that has a simpler form.

    MuJoCo 4 records the meaning of an actuator's control. With `any_input`, its gains alone decide whether it is a
    servo.

    >>> from lxml import etree
    >>> servo = '<general joint="j" biastype="affine" gainprm="5" biasprm="0 -5 -1"/>'
    >>> root = etree.fromstring(f"<mujoco><actuator>{servo}</actuator></mujoco>")
    >>> simple_actuators(root, any_input=True)
    >>> etree.tostring(root[0][0])
    b'<position joint="j" kp="5" kv="1"/>'
    """
    for actuator in list(root.iterfind("actuator/general")):
        form = _simpler_form(actuator, any_input)
        if form is not None:
            _rename(actuator, *form)


def _simpler_form(actuator: Node, any_input: bool) -> tuple[str, dict[str, float]] | None:
    """Return the tag and the gains of the motor or servo that a `general` actuator is, or None."""
    gain = _numbers(actuator, "gainprm", 1.0)
    bias = _numbers(actuator, "biasprm", 0.0)
    if any(gain[1:]) or any(bias[3:]) or not _is_plain(actuator):
        return None
    kind = actuator.get("biastype", "none")
    control = actuator.get("input", "")
    if kind == "none":
        return ("motor", {}) if gain[0] == 1 and not control else None
    if kind != "affine":
        return None
    unsaid = "" if any_input else "pos"
    if control in ("pos", unsaid) and not bias[0] and bias[1] == -gain[0] < 0 and bias[2] <= 0:
        return "position", {"kp": gain[0], **({"kv": -bias[2]} if bias[2] else {})}
    if control in ("vel", unsaid and "vel") and bias[:3] == [0, 0, -gain[0]]:
        return "velocity", {"kv": gain[0]}
    return None


def _is_plain(actuator: Node) -> bool:
    """Return whether an actuator has no activation, a fixed gain, and no attribute that a motor does not have."""
    if any(actuator.get(name) for name in _DYNAMICS) or actuator.get("gaintype", "fixed") != "fixed":
        return False
    return _MOTOR.issuperset(map(str, actuator.keys()))


def _rename(actuator: Node, tag: str, values: dict[str, float]) -> None:
    actuator.tag = tag
    for name in _GAIN:
        actuator.attrib.pop(name, "")
    for name, value in values.items():
        actuator.set(name, f"{value!r}".removesuffix(".0"))


def _numbers(actuator: Node, name: str, first: float) -> list[float]:
    written = [float(each) for each in (actuator.get(name) or "").split()]
    return [*written, *([first, 0.0, 0.0])[len(written) :]]


Elements = Mapping[str, Sequence[Node]]
"""By kind: the elements in the order of the compiled model."""

_MESHES = ("mesh", "sdf")


def write_values(mujoco: Any, model: MjModel, elements: Elements) -> None:
    """Write the compiled values of everything in the body tree."""
    for number, body in enumerate(elements["body"]):
        if number:
            _place(body, model.body_pos[number], model.body_quat[number])
            _inertia(model, number, body)
    for number, joint in enumerate(elements["joint"]):
        if joint.tag == "freejoint":
            joint.set("align", "false")  # has been done
        else:
            joint.set("type", words(mujoco, "jnt_type")[int(model.jnt_type[number])])
            _joint(model, number, joint)
    for number, geom in enumerate(elements["geom"]):
        _shape(geom, words(mujoco, "geom_type")[int(model.geom_type[number])], model.geom_size[number])
        _place(geom, model.geom_pos[number], model.geom_quat[number])
        _geom(model, number, geom)
    for number, site in enumerate(elements["site"]):
        _shape(site, words(mujoco, "site_type")[int(model.site_type[number])], model.site_size[number])
        _place(site, model.site_pos[number], model.site_quat[number])
        # MuJoCo 3.12 saves no `class="main"`, which keeps a site out of the class of its body.
        site.set("group", text(model.site_group[number]))
        if site.get("material") is None:
            site.set("rgba", text(model.site_rgba[number]))
    for number, camera in enumerate(elements["camera"]):
        _place(camera, model.cam_pos[number], model.cam_quat[number])
    for number, light in enumerate(elements["light"]):
        light.set("pos", text(model.light_pos[number]))
        light.set("dir", text(model.light_dir[number]))


def _place(element: Node, pos: Any, quat: Any) -> None:
    for name in ORIENTATIONS:
        element.attrib.pop(name, "")
    element.set("pos", text(pos))
    element.set("quat", text(quat))


def _inertia(model: MjModel, number: int, body: Node) -> None:
    for old in list(body.iterchildren("inertial")):
        body.remove(old)
    # MuJoCo 4.0 gives a body without one the `pos` of the body as its center of mass.
    inertial = etree.Element("inertial", mass=text(model.body_mass[number]))
    _place(inertial, model.body_ipos[number], model.body_iquat[number])
    inertial.set("diaginertia", text(model.body_inertia[number]))
    body.insert(0, inertial)


_SPINNING = ("hinge", "slide")


def _joint(model: MjModel, number: int, joint: Node) -> None:
    joint.set("pos", text(model.jnt_pos[number]))
    limited = bool(model.jnt_limited[number])
    joint.set("limited", "true" if limited else "false")
    dof = int(model.jnt_dofadr[number])
    if joint.get("type") in _SPINNING:
        joint.set("axis", text(model.jnt_axis[number]))
    if limited:
        joint.set("range", text(model.jnt_range[number]))
    for name, value in (
        ("armature", model.dof_armature[dof]),
        ("frictionloss", model.dof_frictionloss[dof]),
        ("damping", model.dof_damping[dof]),
        ("stiffness", model.jnt_stiffness[number]),
    ):
        if joint.get(name) is None:
            joint.set(name, text(value))


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2}


def _shape(element: Node, shape: str, size: Any) -> None:
    element.attrib.pop("fromto", "")
    element.set("type", shape)
    if shape in _MESHES or shape == "hfield":
        if element.tag == "geom":
            element.attrib.pop("size", "")
    else:
        count = _SIZES.get(shape, 3)
        element.set("size", text(size if size[count:].any() else size[:count]))
        element.attrib.pop("mesh", "")
    element.attrib.pop("fitscale", "")


_GEOM = ("contype", "conaffinity", "condim", "friction", "group")


def _geom(model: MjModel, number: int, geom: Node) -> None:
    for name in _GEOM:
        geom.set(name, text(getattr(model, f"geom_{name}")[number]))
    for name in ("mass", "density", "shellinertia"):
        geom.attrib.pop(name, "")  # the inertia of its body is written
    if model.body_mass[model.geom_bodyid[number]] == 0:
        geom.set("mass", "0")
    if geom.get("material") is None:
        geom.set("rgba", text(model.geom_rgba[number]))


_DONE = (
    "boundmass",
    "boundinertia",
    "balanceinertia",
    "settotalmass",
    "fusestatic",
    "discardvisual",
    "alignfree",
    "fitaabb",
    "inertiagrouprange",
    "saveinertial",
    "savecompiled",
    "savecanonical",
    "strippath",
    "meshdir",
    "texturedir",
    "assetdir",
    "eulerseq",
    "passthrough",
)

_WITH_INPUTS = 4_000_000
"""MuJoCo before 4.0 saves a servo as its gains alone."""


class CannotBePlain(Exception):
    """Raised if MuJoCo saves another number of elements than the model has."""


def plain(mujoco: Any, path: Path) -> Draft:
    """Return the draft of the model in a file. Raises CannotBePlain, and ValueError for a model that MuJoCo refuses."""
    spec = mujoco.MjSpec.from_file(str(path))
    model = spec.compile()
    root = saved(mujoco, spec)
    without_classes(root)
    without_frames(root)
    names = NameTable(model)
    elements = {kind: [each for each in nodes if each is not None] for kind, nodes in compiled_order(root).items()}
    for kind in ("body", "joint", "geom", "site", "camera", "light", "actuator", "equality", "tendon", "sensor"):
        if len(elements[kind]) != names.count(kind):
            count = f"{len(elements[kind])} of {names.count(kind)}"
            raise CannotBePlain(f"MuJoCo {mujoco.__version__} saves {count} elements of the kind {kind}")
    for compiler in root.iterchildren("compiler"):  # these settings are already applied to the values
        for name in _DONE:
            compiler.attrib.pop(name, "")
        compiler.set("inertiafromgeom", "false")
    files = keep_files(root, path.parent, spec)
    files |= write_meshes(root, model, names.names["mesh"])
    write_values(mujoco, model, elements)
    _materials(model, elements, names)
    simple_actuators(root, any_input=mujoco.mj_version() < _WITH_INPUTS)
    elements["actuator"] = list(root.iterfind("actuator/*"))
    etree.indent(root)
    return Draft(mujoco, model, root, files=files, elements=elements)


def _materials(model: MjModel, elements: dict[str, list[Node]], names: NameTable) -> None:
    """Write the material of each geom and site.

    MuJoCo 4.0 does not save `material=""`, which undoes the material of a class.
    """
    for kind in ("geom", "site"):
        for number, element in enumerate(elements[kind]):
            material = int(getattr(model, f"{kind}_matid")[number])
            element.attrib.pop("material", "")
            if material >= 0:
                element.set("material", names.names["material"][material])
