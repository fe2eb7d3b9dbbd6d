"""The plain text of a model: the passes in their order."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.compiled.kinds import NameTable
from composer.compiled.order import compiled_order
from composer.targets.draft import Draft
from composer.targets.plain.actuators import simple_actuators
from composer.targets.plain.classes import without_classes
from composer.targets.plain.files import keep_files
from composer.targets.plain.frames import without_frames
from composer.targets.plain.meshes import write_meshes
from composer.targets.plain.saved import saved
from composer.targets.plain.values import write_values

_DONE = (
    "boundmass", "boundinertia", "balanceinertia", "settotalmass", "fusestatic", "discardvisual", "alignfree",
    "fitaabb", "inertiagrouprange", "saveinertial", "savecompiled", "savecanonical", "strippath", "meshdir",
    "texturedir",
    "assetdir", "eulerseq", "passthrough",
)  # fmt: skip

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
    elements = {
        kind: [each for each in nodes if each is not None] for kind, nodes in compiled_order(root).items()
    }
    for kind in (
        "body",
        "joint",
        "geom",
        "site",
        "camera",
        "light",
        "actuator",
        "equality",
        "tendon",
        "sensor",
    ):
        if len(elements[kind]) != names.count(kind):
            count = f"{len(elements[kind])} of {names.count(kind)}"
            raise CannotBePlain(f"MuJoCo {mujoco.__version__} saves {count} elements of the kind {kind}")
    _compiler(root)
    files = keep_files(root, path.parent, spec)
    files |= write_meshes(root, model, names.names["mesh"])
    write_values(mujoco, model, elements)
    _materials(model, elements, names)
    simple_actuators(root, any_input=mujoco.mj_version() < _WITH_INPUTS)
    elements["actuator"] = list(root.iterfind("actuator/*"))
    etree.indent(root)
    return Draft(mujoco, model, root, files=files, elements=elements)


def _compiler(root: Node) -> None:
    """Remove the compiler settings that are already applied to the values."""
    for compiler in root.iterchildren("compiler"):
        for name in _DONE:
            compiler.attrib.pop(name, "")
        compiler.set("inertiafromgeom", "false")


def _materials(model: Any, elements: dict[str, list[Node]], names: NameTable) -> None:
    """Write the material of each geom and site.

    MuJoCo 4.0 does not save `material=""`, which undoes the material of a class.
    """
    for kind in ("geom", "site"):
        for number, element in enumerate(elements[kind]):
            material = int(getattr(model, f"{kind}_matid")[number])
            element.attrib.pop("material", "")
            if material >= 0:
                element.set("material", names.names["material"][material])
