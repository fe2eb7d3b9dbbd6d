"""Verb `move`: move an element to another body or frame."""

from __future__ import annotations

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.compose.editing import Editing
from mjcompose.compose.values import EntryValues, UnusableValue, report_unusable
from mjcompose.compose.verbs.values import SET, Entry, ValueChange
from mjcompose.language.placing import Frame
from mjcompose.language.verbs.move import Move
from mjcompose.link.key_layout import JOINTS
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, NESTED, childclass_of, through_frames
from mjcompose.tree.cost import all_scaled_above
from mjcompose.tree.edit import assign, unresolved
from mjcompose.tree.names import WORLD
from mjcompose.tree.select import kind_of


def carry_out(verb: Move, entry: Entry, at: Path) -> None:
    # Each element moves first: its pose is relative to the new parent.
    for index, node in enumerate(entry.found):
        _move(entry.editing, node, index, to=verb.to, at=at)
        if verb.pose:
            ValueChange(entry.editing, SET, entry.masses).carry_out(node, index, verb.pose, at=at)


def _move(editing: Editing, node: Node, index: int, to: str | Frame, at: Path) -> None:
    """Append a node to its new parent. It keeps its class, and its written pose is its pose there."""
    target = _target(editing, node, index, to=to, at=(*at, "to"))
    if node is target or node in list(target.iterancestors()):
        message = f"{editing.called(node)} cannot be moved into itself"
        span = editing.span((*at, "to"))
        editing.sink.error("wrong-type", message, span, subjects=(*editing.subjects(node), *editing.subjects(target)))
        raise UnusableValue
    if str(node.tag) not in kind_of(target).children:
        message = f"{editing.called(node)} cannot stand in {editing.called(target)}"
        fault = Fault("unknown-element", message, (*at, "to"), names=editing.subjects(target))
        report_unusable(editing, node, fault, it="it")
    _check_free(editing, node, target, at=at)
    _check_scale(editing, node, target, at=at)
    _keep_class(editing, node, target)
    origins = editing.making.origins
    owner = origins.owner(node, editing.making.base_file)
    for joint in node.iter(*JOINTS):
        editing.linking.keys.reshaped.add(joint)
    journal.place(target, node)
    origins.owners.setdefault(node, owner)


def _target(editing: Editing, node: Node, index: int, to: str | Frame, at: Path) -> Node:
    kind = "body"
    written = to
    if isinstance(to, Frame):
        kind = "frame"
        written = to.frame
        at = (*at, "frame")
    name = str(EntryValues(editing, node, index, at=at).of(written, at))
    if kind == "body" and name == WORLD:
        return editing.linking.base.section("worldbody")
    if (found := editing.names.find(kind, name)) is None:
        written = "to: {}" if kind == "body" else "to: {frame: {}}"
        editing.sink.add(unresolved(editing, kind, name, span=editing.span(at), written=written, purpose=" to move to"))
        raise UnusableValue
    return found


def _check_free(editing: Editing, node: Node, target: Node, at: Path) -> None:
    """Report a floating body that would move elsewhere than to the world."""
    # A frame in the world does not count as a body: MuJoCo 4.0 takes `<frame><body><freejoint/>…`, and says of a body
    # below a body "free joint can only be used on top level".
    outer: Node | None = target
    while outer is not None and outer.tag in ("frame", "replicate"):
        outer = outer.getparent()
    if outer is None or outer.tag == "worldbody" or node.tag != "body":
        return
    is_mocap = node.get("mocap") == "true"
    floats = any(
        child.tag == "freejoint" or (child.tag == "joint" and editing.effective(child, "type") == "free")
        for child in through_frames(node)
    )
    if not (is_mocap or floats):
        return
    code = "freejoint-on-body"
    what = "has a free joint"
    help = "remove its free joint first, or move it to the world"
    if is_mocap:
        code = "mocap-on-body"
        what = "is a mocap body"
        help = "set `mocap: false` first"
    message = f"{editing.called(node)} {what} and cannot stand below {editing.called(outer)}"
    report_unusable(editing, node, Fault(code, message, (*at, "to"), help=help, names=editing.subjects(outer)), it="it")


def _check_scale(editing: Editing, node: Node, target: Node, at: Path) -> None:
    """Report a move into or out of a frame that scales: it would change all lengths and masses."""
    here, there = (list(all_scaled_above(each)) for each in (node.getparent(), target))
    if here == there:
        return
    frame = next(each for each in (*here, *there) if (each in here) != (each in there))
    way = "out of" if frame in here else "into"
    message = f"{editing.called(node)} cannot be moved {way} a frame that scales: its sizes and masses would change"
    notes = (Note("the frame", editing.span_of(frame, "scale" if frame.get("scale") else "massscale")),)
    help = "write the frame's content in its final size, without `scale` and `massscale`"
    span = editing.span((*at, "to"))
    subjects = (*editing.subjects(node), *editing.subjects(target))
    editing.sink.error("not-supported", message, span, notes=notes, help=help, subjects=subjects)
    raise UnusableValue


def _keep_class(editing: Editing, node: Node, target: Node) -> None:
    """Write the class in force at the old place onto the node if the new place has another class."""
    if (before := childclass_of(node)) == (str(target.get("childclass") or "") or childclass_of(target)):
        return
    if node.tag in NESTED:
        if not node.get("childclass"):
            assign(editing, node, {"childclass": before or MAIN})
    # `class="main"` means the top class even below a `childclass`.
    elif kind_of(node).takes_class and not node.get("class"):
        assign(editing, node, {"class": before or MAIN})
