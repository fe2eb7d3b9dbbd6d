"""The text of a recipe that a page changes: only the characters of the new values, and nothing else.

The offset of a part or an element is written in the existing form of orientation.
"""

from __future__ import annotations

import math
from codecs import BOM_UTF8
from dataclasses import field
from pathlib import Path
from typing import Any, TypeAlias

from mjcompose.base import rotation
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Path as Steps
from mjcompose.base.rotation import IDENTITY_QUAT, Pose, Quat
from mjcompose.base.sink import Sink
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.plan.steps import AngleSettings
from mjcompose.text import node as yaml_tree
from mjcompose.text.expression import UNITS, Angle
from mjcompose.text.faults import quoted, word
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, TextChange, find, is_template, lines_of, to_python

Written: TypeAlias = "str | dict[str, Written]"
"""The text of a value in YAML, or a mapping of them by the plain text of their keys."""


class DraftRefused(Exception):
    """The reason that nothing is written; `more` is for the page."""

    def __init__(self, message: str, **more: Any) -> None:
        super().__init__(message)
        self.more = more


def value_of(text: str) -> Any:
    """Return the value of a text in YAML. Raises DraftRefused if it is none."""
    sink = Sink()
    tree = load(f"value: {text}", "", sink)
    if sink.has_errors or not isinstance(tree, Mapping) or list(tree.entries) != ["value"]:
        raise DraftRefused("this cannot be written as YAML")
    return to_python(tree.entries["value"][1])


def name_text(name: str) -> str:
    """Return a name as YAML that means the same name again. Raises DraftRefused if it cannot be written."""
    text = word(name)
    text = text if isinstance(yaml_tree.resolve(text), str) else quoted(name)
    if not name.isprintable() or not name or is_template(name) or value_of(text) != name:
        raise DraftRefused("this name has characters that a recipe cannot have")
    return text


def short(value: float, digits: int) -> str:
    """Return a number with at most `digits` after the point.

    >>> short(0.30000000004, 5), short(-1e-9, 5)
    ('0.3', '0')
    """
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class RecipeDraft(Struct, frozen=False):
    """A recipe, its tree, and the changes to be made. `wanted` is the intended meaning of its new text.

    Every change raises DraftRefused if the recipe has no place for it.
    """

    file: str
    path: Path
    raw: bytes
    text: str
    tree: Mapping
    wanted: Any
    changes: list[TextChange] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, file: str, path: Path, raw: bytes) -> RecipeDraft:
        sink = Sink()
        tree = load(raw, file, sink)
        if sink.has_errors or not isinstance(tree, Mapping):
            raise DraftRefused(f"`{file}` is not a valid recipe now")
        return cls(file, path, raw, text=raw.decode("utf-8-sig"), tree=tree, wanted=to_python(tree))

    def set(self, path: Steps, value: Any, *changes: TextChange) -> None:
        """Note the changes that replace the value at a path."""
        self.changes += changes
        self._holder(path)[path[-1]] = value

    def rename(self, path: Steps, name: str) -> None:
        """Note another name for a key."""
        holder = self._holder(path)
        node = find(self.tree, path[:-1])
        assert isinstance(node, Mapping)
        holder[name] = holder.pop(path[-1])
        self.changes.append(TextChange(node.entries[str(path[-1])][0].span, name))

    def _holder(self, path: Steps) -> Any:
        holder = self.wanted
        for step in path[:-1]:
            holder = holder.setdefault(step, {}) if isinstance(step, str) else holder[step]
        return holder

    def write(self, path: Steps, value: Written) -> None:
        """Write a value, with the missing keys above it. A mapping is written only in an empty place."""
        found = next(depth for depth in range(len(path), -1, -1) if find(self.tree, path[:depth]) is not None)
        holder = find(self.tree, path[:found])
        if found == len(path) and isinstance(holder, Scalar) and isinstance(value, str):
            self.set(path, value_of(value), TextChange(holder.span, value))
            return
        if not isinstance(holder, Mapping) or found == len(path):
            raise DraftRefused(f"there is no place for `{path[-1]}` in `{self.file}`: write it yourself")
        self.set(path, _meaning(value))
        lines = lines_of(self.text)
        row = holder.span
        is_flow = found > 0 and (not holder.entries or lines[row.line - 1][row.column - 1 :][:1] == "{")
        indent = 0 if found == 0 or is_flow else next(iter(holder.entries.values()))[0].span.column - 1
        for step in reversed(path[found + 1 :]):
            value = {str(step): value}
        text = f"{name_text(str(path[found]))}:{_rendered(value, None if is_flow else indent + 2)}"
        self.changes.append(yaml_tree.added_key(holder, lines, self.file, text=text, top=found == 0))

    def append(self, key: str, value: str) -> None:
        """Append an item to a list at the top of the recipe."""
        change = yaml_tree.with_item(self.tree, lines_of(self.text), self.file, key=key, value=value)
        if change is None:
            raise DraftRefused(f"`{key}` of `{self.file}` is not a list")
        self.wanted.setdefault(key, []).append(value_of(value))
        self.changes.append(change)

    def numbers(self, path: Steps, texts: list[str]) -> None:
        """Write a list of numbers; unchanged numbers keep their text."""
        node = find(self.tree, path)
        whole = f"[{', '.join(texts)}]"
        if node is None:
            self.write(path, whole)
            return
        items = [each for each in node.items if isinstance(each, Scalar)] if isinstance(node, Sequence) else []
        if not isinstance(node, Sequence) or len(items) < len(node.items):
            raise DraftRefused(f"`{path[-1]}` is not a list of numbers")
        values = list(map(value_of, texts))
        changes = [TextChange(node.span, whole)]
        if len(items) == len(texts):
            kept = {at for at, item in enumerate(items) if _is_same(item.value, values[at])}
            values = [item.value if at in kept else values[at] for at, item in enumerate(items)]
            changes = [TextChange(item.span, texts[at]) for at, item in enumerate(items) if at not in kept]
        else:
            start = lines_of(self.text)[node.span.line - 1][node.span.column - 1]
            if start != "[" or items[-1].span.end_line != node.span.line:
                raise DraftRefused(f"`{path[-1]}` is written over several lines: write `{whole}` yourself")
        self.set(path, values, *changes)

    def result(self) -> bytes:
        """Return the new text. Raises DraftRefused if it would mean something else than `wanted`."""
        end = "\r\n" if "\r\n" in self.text else "\n"
        text = yaml_tree.changed(
            self.text, [TextChange(each.span, each.text.replace("\n", end)) for each in self.changes]
        )
        sink = Sink()
        tree: Node | None = load(text, self.file, sink)
        if sink.has_errors or tree is None or to_python(tree) != self.wanted:
            raise DraftRefused(
                f"`{self.file}` cannot be changed here without changing something else: write it yourself"
            )
        return self.encoded(text)

    def encoded(self, text: str) -> bytes:
        """Return the bytes of a text, with the byte order mark of the file, if it has one."""
        return (BOM_UTF8 if self.raw.startswith(BOM_UTF8) else b"") + text.encode()


def _meaning(value: Written) -> Any:
    return value_of(value) if isinstance(value, str) else {name: _meaning(each) for name, each in value.items()}


def _rendered(value: Written, indent: int | None) -> str:
    """Return the text after the colon of a key: lines with an indent, or all in one line."""
    if isinstance(value, str):
        return f" {value}"
    entries = [(name_text(name), each) for name, each in value.items()]
    if indent is None or not entries:
        return f" {{{', '.join(f'{name}:{_rendered(each, None)}' for name, each in entries)}}}"
    return "".join(f"\n{' ' * indent}{name}:{_rendered(each, indent + 2)}" for name, each in entries)


def _is_same(before: Any, after: Any) -> bool:
    """Return whether a number need not be written again."""
    if isinstance(before, str) or isinstance(after, str) or isinstance(before, bool) or before is None:
        return bool(before == after)
    return bool(abs(before - after) < 5e-7)


Floats: TypeAlias = "list[float] | tuple[float, ...]"
# The digits of written numbers: 0.01 mm and 0.001 degrees.
_POS = 5
_AXIS = 6
_DEGREES = 3
_RADIANS = 6
_TURN = 2e-4
"""Rotations that differ by fewer radians count as equal."""


class PoseDraft:
    """`pos` and an orientation in the mapping at a path of a recipe."""

    def __init__(self, draft: RecipeDraft, holder: Steps, settings: AngleSettings) -> None:
        self.draft = draft
        self.holder = holder
        self.settings = settings
        found = find(draft.tree, holder)
        assert isinstance(found, Mapping)
        self.mapping = found
        self.form = next((each for each in ORIENTATIONS if each in found.entries), None)

    @property
    def computed(self) -> list[tuple[str, str]]:
        """The keys that have an expression, each with its expression."""
        keys = [key for key in ("pos", self.form) if key is not None and key in self.mapping.entries]
        found = ((key, each.node) for key in keys for each in yaml_tree.walk(self.mapping.entries[key][1]))
        return [(key, node.text) for key, node in found if isinstance(node, Scalar) and is_template(node.text)]

    @property
    def pose(self) -> Pose:
        x, y, z = self._read("pos") or (0.0, 0.0, 0.0)
        return Pose((x, y, z), IDENTITY_QUAT if self.form is None else self._quat(self.form, self._read(self.form)))

    def move(self, pose: Pose, *, anew: bool = False) -> list[str]:
        """Write a new pose and return its words; `anew` forgets the written choice among equal angles."""
        before = self.pose
        written: list[str] = []
        texts = [short(each, _POS) for each in pose.pos]
        if texts != [short(each, _POS) for each in before.pos]:
            self.draft.numbers((*self.holder, "pos"), texts)
            written.append(f"pos: [{', '.join(texts)}]")
        if _turn(before.quat, pose.quat) > _TURN / 10:
            form = self.form or "euler"
            texts = self._texts(form, pose.quat, self._read(form) if self.form and not anew else [])
            if not texts:
                form = "quat"
                texts = self._texts("quat", pose.quat, [])
            self.draft.numbers((*self.holder, self.form or form), texts)
            if self.form not in (None, form):
                self.draft.rename((*self.holder, str(self.form)), form)
                self.draft.notes.append(f"`{self.form}` cannot express this rotation: it is a `quat` now")
            written.append(f"{form}: [{', '.join(texts)}]")
        return written

    def _read(self, key: str) -> list[float]:
        """Return the numbers of a key, angles in radians."""
        node = find(self.mapping, (key,))
        if node is None:
            return []
        values = [each.value for each in node.items if isinstance(each, Scalar)] if isinstance(node, Sequence) else []
        if not isinstance(node, Sequence) or len(values) < len(node.items):
            raise DraftRefused(f"`{key}` is not a list of numbers")
        if len(values) != {"quat": 4, "axisangle": 4, "xyaxes": 6}.get(key, 3):
            raise DraftRefused(f"`{key}` has the wrong length")
        return self._radians(key, values)

    def _radians(self, key: str, values: list[Any]) -> list[float]:
        found = list[float]()
        for at, value in enumerate(values):
            angle = Angle.read(value) if isinstance(value, str) else None
            if angle is None and (isinstance(value, bool) or not isinstance(value, int | float)):
                raise DraftRefused(f"`{key}` has `{value}`, which is not a number")
            number = float(value) if angle is None else angle.radians
            bare = angle is None and self.settings.angle == "degree" and _is_angle(key, at)
            found.append(math.radians(number) if bare else number)
        return found

    def _quat(self, form: str, values: Floats) -> Quat:
        if form == "euler":
            return rotation.quat_from_euler(values, self.settings.eulerseq)
        if form == "axisangle":
            return rotation.quat_from_axisangle(values[:3], values[3])
        alone = {"quat": rotation.normalize, "xyaxes": rotation.quat_from_xyaxes, "zaxis": rotation.quat_from_zaxis}
        return alone[form](values)

    def _texts(self, form: str, quat: Quat, old: list[float]) -> list[str]:
        """Return the numbers of a rotation in a form; none if the form cannot express it."""
        texts = [
            self._angle(form, at, value) if _is_angle(form, at) else short(value, _AXIS)
            for at, value in enumerate(self._values(form, quat, old))
        ]
        written = self._radians(form, [value_of(text) for text in texts]) if texts else []
        return texts if written and _turn(self._quat(form, written), quat) < _TURN else []

    def _values(self, form: str, quat: Quat, old: list[float]) -> Floats:
        """Return a rotation in a form, as close to the old numbers as possible; none if the form cannot express it."""
        if form == "quat":
            sign = -1 if sum(a * b for a, b in zip(quat, old or quat, strict=True)) < 0 else 1
            return [sign * number for number in quat]
        if form == "euler":
            return rotation.euler_of(quat, self.settings.eulerseq, old or (0.0, 0.0, 0.0)) or ()
        if form == "axisangle":
            axis, angle = rotation.axisangle_of(quat, old[:3] or (0.0, 0.0, 1.0))
            is_same = old and math.dist(axis, rotation.unit(old[:3])) < 1e-6
            return (*(old[:3] if is_same else axis), angle)
        axes = ((1, 0, 0), (0, 1, 0)) if form == "xyaxes" else ((0, 0, 1),)
        return [number for axis in axes for number in rotation.rotate(quat, axis)]

    def _angle(self, form: str, at: int, value: float) -> str:
        """Return an angle in the unit of its present text, or in the unit of the recipe."""
        node = find(self.mapping, (form, at))
        written = node.text[-3:] if isinstance(node, Scalar) and node.text[-3:] in UNITS else None
        bare = {"degree": "deg", "radian": "rad"}.get(self.settings.angle or "")
        is_in_radians = (written or bare) == "rad"
        text = short(value, _RADIANS) if is_in_radians else short(math.degrees(value), _DEGREES)
        return text if (written is None and bare) or (text == "0" and written is None) else f"{text}{written or 'deg'}"


def _is_angle(key: str, at: int) -> bool:
    return key == "euler" or (key == "axisangle" and at == 3)


def _turn(a: Quat, b: Quat) -> float:
    """Return the angle between two rotations, at least 120 degrees for larger ones."""
    sign = math.copysign(1, sum(x * y for x, y in zip(a, b, strict=True)))
    return 4 * math.asin(min(0.5, math.dist([sign * each for each in a], b) / 2))
