"""What `dm_control.mjcf` makes of a composition or a file, where it is installed."""

from __future__ import annotations

import importlib
import importlib.metadata
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
from fidelity import stored
from fidelity.corpus import Composition
from lxml import etree

NAME = "dm_control"


def version() -> str | None:
    """None where it is not installed."""
    try:
        return importlib.metadata.version(NAME)
    except importlib.metadata.PackageNotFoundError:
        return None


def renamed(composition: Composition) -> Composition:
    """The same with the prefixes that dm_control can give: always a name and `/`."""
    attachments = tuple(
        replace(each, prefix=_name(each.prefix, number) + "/") for number, each in enumerate(composition.attachments)
    )
    return replace(composition, attachments=attachments)


def attached(composition: Composition) -> mujoco.MjModel:
    """The compiled model. Raises ValueError for whatever dm_control or MuJoCo raises."""
    return _refusing(lambda: _attached(composition))


def reread(path: Path) -> mujoco.MjModel:
    """A file read and written again, compiled. Raises ValueError for whatever dm_control or MuJoCo raises."""
    return _refusing(lambda: _compiled(importlib.import_module("dm_control.mjcf").from_path(str(path))))


def _refusing(make: Callable[[], mujoco.MjModel]) -> mujoco.MjModel:
    try:
        return make()
    except Exception as error:  # it raises nearly anything
        raise ValueError(f"{type(error).__name__}: {error}") from None


def _attached(composition: Composition) -> mujoco.MjModel:
    mjcf: Any = importlib.import_module("dm_control.mjcf")
    base = mjcf.from_path(str(composition.parent))
    for number, attachment in enumerate(composition.attachments):
        child = mjcf.from_path(str(attachment.child))
        child.model = _name(attachment.prefix, number)
        moved = any(attachment.pos) or attachment.quat != (1.0, 0.0, 0.0, 0.0)
        if attachment.site is not None:
            if moved:
                raise ValueError("it attaches to a site without an offset")
            place = base.find("site", attachment.site)
        else:
            body = base.worldbody if attachment.body is None else base.find("body", attachment.body)
            place = body.add("site", pos=attachment.pos, quat=attachment.quat)
        place.attach(child)
    return _compiled(base)


def _name(prefix: str, number: int) -> str:
    return prefix.rstrip("/_:.-") or f"part{number}"


def _compiled(root: Any) -> mujoco.MjModel:
    """Its files are named after their content; names that it makes up are taken away again."""
    tree = etree.fromstring(root.to_xml_string().encode())
    used = Counter(value for element in tree.iter("*") for value in element.attrib.values())
    for element in tree.iter("*"):
        name = element.get("name", "")
        if "//unnamed_" in f"/{name}" and used[name] == 1:
            del element.attrib["name"]
    files = {name: bytes(content) for name, content in root.get_assets().items()}
    return mujoco.MjModel.from_xml_path(
        str(stored.folder(NAME, {**files, "model.xml": etree.tostring(tree)}) / "model.xml")
    )
