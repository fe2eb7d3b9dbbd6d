"""A composition as one flat model: copies of all units go through the linker, the models themselves stay."""

from __future__ import annotations

import posixpath
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import get_args

from lxml.etree import _Element as Node

from composer.context import Context
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.diagnostics.text import render
from composer.link.defaults import choose_classes
from composer.link.link import finish, link
from composer.link.linking import FileUse, Linking, Part, Policy
from composer.mjcf.asset import Asset
from composer.mjcf.call_site import call_site
from composer.mjcf.errors import MjcfError, MjcfWarning, failure
from composer.mjcf.loose_ends import check_references
from composer.mjcf.model import UNNAMED, Model
from composer.mjcf.mounting import Mounting
from composer.tree.unit import Unit
from composer.tree.write import write

# The linker speaks to the writers of recipes; this is what a Python user can do.
_HELP = {
    "option-conflict": "make the two agree, or pass `conflict='warning'`, which lets the model's own value stand and "
    "says so, or `conflict='merge'`",
    "freejoint-on-body": "remove the free joint, or attach the model to the worldbody",
    "mocap-on-body": "attach the model to the worldbody",
    "plane-on-body": "remove the plane, or attach the model to the worldbody",
    "name-clash": "rename one of the two: the element, or the attached model (`child.model = '…'`)",
    "class-clash": "rename one of the two: the class, or the attached model (`child.model = '…'`)",
    "not-supported": None,
}
_HOLDERS = ("option", "visual", "compiler")


@dataclass(frozen=True, slots=True)
class Flat:
    """One model without attachments, and the files it names."""

    unit: Unit
    files: list[FileUse]


def flatten(model: Model, conflict: Policy) -> Flat:
    """The composition below a model, linked. Raises `MjcfError` with everything that is wrong with it."""
    if conflict not in get_args(Policy):
        words = ", ".join(f"`{word}`" for word in get_args(Policy))
        raise failure("wrong-keyword", f"`conflict` is one of {words}, got `{conflict}`", call_site())
    sink = _NamesChecked()
    check_references(model, sink)
    if not sink.unresolved:
        mounting = Mounting(model, _copy)
        linking = Linking(mounting.base, mounting.parts, sink, conflict=conflict, measure=_measure(sink))
        choose_classes(linking)
        mounting.add_joints(linking)
        link(linking)
        if not sink.has_errors:
            finish(linking)
        mounting.clear_up()
    if sink.has_errors:
        raise MjcfError([_for_python(each) for each in sink.sorted() if each.severity == "error"])
    for each in sink.sorted():
        warnings.warn(render(_for_python(each)), MjcfWarning, stacklevel=_depth())
    _prune(linking.base.root)
    return Flat(linking.base, linking.files)


def text(model: Model, conflict: Policy) -> str:
    """See `RootElement.to_xml_string`."""
    flat = flatten(model, conflict)
    for use, name in _told_apart(flat.files):
        use.element.set(use.attribute, name)
    return write(flat.unit.root).decode()


def assets(model: Model) -> dict[str, bytes]:
    """See `RootElement.assets`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MjcfWarning)
        flat = flatten(model, "warning")
    found: dict[str, bytes] = {}
    for use, name in _told_apart(flat.files):
        if name not in found:
            found[name] = Asset(path=Path(use.source)).contents if use.content is None else use.content
    return found


class _NamesChecked(Sink):
    """The linker looks up names unit by unit; what refers from one model into another has been looked up before."""

    @property
    def unresolved(self) -> bool:
        return self.has_errors

    def add(self, diagnostic: Diagnostic) -> None:
        super().add(diagnostic)
