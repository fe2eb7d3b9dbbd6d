"""Pass: sections of which a model has one. What a part asks for and the model does not do is told, never dropped.

The model's value is the base's, where it writes one, else MuJoCo's default; what the recipe sets itself is settled.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Cause, Note
from composer.diagnostics.span import Span
from composer.grammar import GRAMMAR
from composer.link import numbers
from composer.link.linking import Linking
from composer.link.part import Part
from composer.link.room import asked, bytes_of
from composer.tree.unit import Unit

SINGLETONS = ("option", "visual", "statistic")
# Sizes only make room: the larger of two serves both.
_LARGEST = ("njmax", "nconmax", "nstack", "nuserdata")
# Older ways to say how much memory there is. MuJoCo 4.0 refuses `<size memory="1M" njmax="5"/>`: "at most one of".
INSTEAD_OF_MEMORY = ("njmax", "nstack")
_SMALLER_IS_SAFER = (
    "timestep",
    "tolerance",
    "ls_tolerance",
    "noslip_tolerance",
    "ccd_tolerance",
    "sleep_tolerance",
)
_LARGER_IS_SAFER = ("iterations", "ls_iterations", "noslip_iterations", "ccd_iterations", "sdf_iterations",
                    "sdf_initpoints")  # fmt: skip
_NAMED = 4  # settings that a message names; the notes have all of them


@dataclass(frozen=True, slots=True)
class _Written:
    value: str
    element: Node
    unit: Unit


@dataclass(frozen=True, slots=True)
class _Wish:
    """A setting that a part writes and the model has otherwise; `settled` is the value that a merge gives it."""

    path: str
    wanted: _Written
    have: _Written | None
    settled: str | None = None

    @property
    def section(self) -> str:
        return self.path.split("/")[0]

    @property
    def shown(self) -> str:
        return f"`{self.path.replace('/', '.')}`"

    def span(self, linking: Linking) -> Span:
        return linking.span(self.wanted.unit, self.wanted.element, _name(self.path))

    def written(self, linking: Linking) -> Span | None:
        """Where the model's own value is written."""
        have = self.have
        return None if have is None else linking.span(have.unit, have.element, _name(self.path))

    def difference(self, wanted: str) -> str:
        return f"{wanted} `{self.wanted.value}`, {_model_has(self.have, default_of(self.path))}"


def agreement(linking: Linking) -> None:
    """Compare what every unit writes, then merge the sizes.

    Sizes make room for both; what contradicts the base is reported:

    >>> from composer.link.example import after
    >>> part = '<option gravity="0 0 0"/><size nuserdata="3"/>'
    >>> base = '<option gravity="0 0 -1"/>'
    >>> after(agreement, part, base)
    base: <size nuserdata="3"/>
    error: `p/` wants `option.gravity` to be `0 0 0`, the model has `0 0 -1`
    """
    if not linking.parts:
        return
    model = dict(written(linking.base))
    found = [(part, [*_wishes(linking, part, model)]) for part in linking.parts]
    open_ones = [wish for _, wishes in found for wish in wishes if wish.settled is None]
    for part, wishes in found:
        _tell_merged(linking, part, [wish for wish in wishes if wish.settled is not None])
        _tell(linking, part, [wish for wish in wishes if wish.settled is None], open_ones)
    _sizes(linking)


def _wishes(linking: Linking, part: Part, model: dict[str, _Written]) -> Iterator[_Wish]:
    """What a part asks for and the model does not do; what a merge settles is what later parts meet."""
    for path, wanted in dict(written(part.unit)).items():  # of several sections the last counts
        if path in linking.request.overridden_options:
            continue
        have = model.get(path)
        current = have.value if have is not None else default_of(path)
        if current is not None and _equal(current, wanted.value):
            continue
        settled = merged(path, have, wanted) if linking.request.conflict == "merge" else None
        yield _Wish(path, wanted, have, settled)
        if settled is not None:
            set_value(linking.base, path, settled)
            model[path] = _Written(settled, wanted.element, part.unit)


def written(unit: Unit) -> Iterator[tuple[str, _Written]]:
    for section in unit.root.iterchildren(*SINGLETONS):
        yield from _attributes(section, str(section.tag), unit)


def _attributes(element: Node, path: str, unit: Unit) -> Iterator[tuple[str, _Written]]:
    for name, value in element.items():
        if str(value).strip():
            yield f"{path}/{name!s}", _Written(str(value), element, unit)
    for child in element.iterchildren("*"):
        yield from _attributes(child, f"{path}/{child.tag!s}", unit)


@cache
def default_of(path: str) -> str | None:
    element, name = path.rsplit("/", 1)
    attribute = GRAMMAR.element(element).attributes.get(name)
    value = attribute.default if attribute is not None else None
    if value is None:
        return None
    if isinstance(value, bool):
        return "true" if value else "false"
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def _equal(a: str, b: str) -> bool:
    if a.split() == b.split():
        return True
    try:
        return numbers.read(a) == numbers.read(b)
    except ValueError:
        return False


def merged(path: str, have: _Written | None, wanted: _Written) -> str | None:
    """As MuJoCo merges: a default gives way; of two steps or tolerances the smaller, of iterations the larger."""
    if have is None:
        return wanted.value
    name = path.rsplit("/", 1)[1]
    if name in _SMALLER_IS_SAFER:
        return min(have.value, wanted.value, key=lambda text: numbers.read(text)[0])
    if name in _LARGER_IS_SAFER:
        return max(have.value, wanted.value, key=lambda text: numbers.read(text)[0])
    return None


def set_value(unit: Unit, path: str, value: str) -> None:
    section, *inner, name = path.split("/")
    element = unit.section(section)
    for tag in inner:
        child = next(element.iterchildren(tag), None)
        if child is None:
            child = element.makeelement(tag)
            element.append(child)
        element = child
    element.set(name, value)


def _tell(linking: Linking, part: Part, wishes: list[_Wish], all_wishes: list[_Wish]) -> None:
    """One finding for all settings of a part, with one help for those of all parts; equal parts are one finding."""
    if not wishes:
        return
    message, notes, span, cause = _described(linking, part, wishes)
    if linking.request.conflict == "warning":
        stands = ", which stands" if len(wishes) == 1 else "; the model's values stand"
        linking.sink.warning("option-conflict", f"{message}{stands}", span, notes=notes, cause=cause)
        return
    asked: dict[str, str] = {}
    for wish in all_wishes:
        asked.setdefault(wish.path, wish.wanted.value)
    sections = dict.fromkeys(wish.section for wish in wishes)
    others = [f"leave those of the part out: `drop: [{', '.join(sections)}]`"]
    if linking.request.conflict == "error" and _would_merge(all_wishes):
        others.append("write `conflict: merge`")
    sentence, *lines = settling(asked, linking.request.overridden_options).split("\n")
    help = "\n".join([f"{sentence}; or {', or '.join(others)}", *lines])
    subjects = (part.called, *(wish.path for wish in wishes))
    linking.sink.error(
        "option-conflict", message, span, notes=notes, help=help, cause=cause, subjects=subjects
    )


def _tell_merged(linking: Linking, part: Part, wishes: list[_Wish]) -> None:
    if not wishes:
        return
    message, notes, span, cause = _described(linking, part, wishes)
    message += f"; merged to `{wishes[0].settled}`" if len(wishes) == 1 else "; they are merged"
    linking.sink.warning("option-conflict", message, span, notes=notes, cause=cause)


def _described(linking: Linking, part: Part, wishes: list[_Wish]) -> tuple[str, list[Note], Span, Cause]:
    """What is said of wishes of a part: the message, both values and places, and what makes another part equal."""
    first = wishes[0]
    if len(wishes) == 1:
        message = first.difference(f"`{part.called}` wants {first.shown} to be")
        place = first.written(linking)
        notes = (
            []
            if place is None or first.have is None
            else [Note(f"`{first.have.value}` is written here", place)]
        )
    else:
        names = ", ".join(wish.shown for wish in wishes[:_NAMED])
        more = f" and {len(wishes) - _NAMED} more settings" if len(wishes) > _NAMED else ""
        message = f"`{part.called}` wants other values than the model has of {names}{more}"
        notes = [Note(_noted(wish), wish.written(linking)) for wish in wishes]
    same = [[wish.path, wish.wanted.value, wish.settled] for wish in wishes]
    return message, notes, first.span(linking), Cause(str(same), f"`{part.called}`")


def _noted(wish: _Wish) -> str:
    said = wish.difference(f"{wish.shown}: it wants")
    return said if wish.settled is None else f"{said}; merged to `{wish.settled}`"


def _would_merge(wishes: Iterable[_Wish]) -> bool:
    """Whether `conflict: merge` would leave no conflict."""
    model: dict[str, _Written | None] = {}
    for wish in wishes:
        have = model.get(wish.path, wish.have)
        if have is not None and _equal(have.value, wish.wanted.value):
            continue
        settled = merged(wish.path, have, wish.wanted)
        if settled is None:
            return False
        model[wish.path] = _Written(settled, wish.wanted.element, wish.wanted.unit)
    return True


def _model_has(have: _Written | None, current: str | None) -> str:
    if have is not None:
        return f"the model has `{have.value}`"
    if current is not None:
        return f"the model has `{current}`, MuJoCo's default"
    return "the model leaves it to MuJoCo"


def _name(path: str) -> str:
    return path.rsplit("/", 1)[1]


def settling(wanted: Mapping[str, str], settled: Collection[str]) -> str:
    """What to write in a recipe to settle conflicts, all of them at once.

    `wanted` has the value that one part asks for, by path; `settled` are the paths that the recipe sets already.

    >>> settling({"option/cone": "elliptic", "option/flag/gravity": "disable"}, ())
    'say in the recipe which it is, for example `option: {cone: elliptic, flag: {gravity: disable}}`'
    """
    tree: dict[str, Any] = {}
    for path, value in wanted.items():
        *inner, name = path.split("/")
        place = tree
        for tag in inner:
            place = place.setdefault(tag, {})
        tokens = value.split()
        place[name] = f"[{', '.join(tokens)}]" if len(tokens) > 1 else value
    written_already = {path.split("/")[0] for path in settled}
    new = [
        f"{section}: {_flow(values)}" for section, values in tree.items() if section not in written_already
    ]
    grown = [
        f"say which it is in the recipe's `{section}`, for example `{_flow(values)[1:-1]}`"
        for section, values in tree.items()
        if section in written_already
    ]
    if len(new) > 1:
        return "\n".join(["; ".join([*grown, "say in the recipe which it is, for example as follows"]), *new])
    return "; ".join([*grown, *(f"say in the recipe which it is, for example `{each}`" for each in new)])


def _flow(tree: Mapping[str, Any]) -> str:
    entries = (f"{name}: {value if isinstance(value, str) else _flow(value)}" for name, value in tree.items())
    return f"{{{', '.join(entries)}}}"


def _sizes(linking: Linking) -> None:
    linking.notes.memory = asked(linking)
    for part in linking.parts:
        for section in part.unit.root.iterchildren("size"):
            for name, value in section.items():
                _enlarge(linking, str(name), str(value))
    _user_widths(linking)
    _one_memory(linking)


def _one_memory(linking: Linking) -> None:
    sizes = list(linking.base.root.iterchildren("size"))
    memory = any(size.get("memory") for size in sizes)
    for size in sizes if memory else ():
        for name in INSTEAD_OF_MEMORY:
            span = linking.span(linking.base, size, name)
            value = size.get(name)
            if value is None:
                continue
            del size.attrib[name]
            for part in linking.parts:
                for section in part.unit.root.iterchildren("size"):
                    if section.get(name) == value:
                        span = linking.span(part.unit, section, name)
            linking.sink.warning(
                "option-conflict",
                f"`size.{name}` = {value} gives way to `size.memory` of another part: only one may be written",
                span,
            )


def _enlarge(linking: Linking, name: str, value: str) -> None:
    have = [str(size.get(name)) for size in linking.base.root.iterchildren("size") if size.get(name)]
    if name == "memory":
        if not have or bytes_of(value) > bytes_of(have[-1]):
            linking.base.section("size").set(name, value)
    elif name in _LARGEST or name.startswith("nuser_"):
        largest = max([int(value), *map(int, have)])
        if largest >= 0:
            linking.base.section("size").set(name, str(largest))


_USERS = {
    "nuser_body": ("body",),
    "nuser_jnt": ("joint", "freejoint"),
    "nuser_geom": ("geom",),
    "nuser_site": ("site",),
    "nuser_cam": ("camera",),
}
_USER_SECTIONS = {"nuser_tendon": "tendon", "nuser_actuator": "actuator", "nuser_sensor": "sensor"}


def _user_widths(linking: Linking) -> None:
    """A written `nuser_*` must be wide enough for the user data of every unit."""
    # MuJoCo 4.0 refuses `<size nuser_geom="1"/>` beside `<geom user="1 2"/>` ("more values than nuser_geom"); without
    # a written width it takes the widest.
    for size in linking.base.root.iterchildren("size"):
        for name, value in size.items():
            if not str(name).startswith("nuser_") or int(value) < 0:
                continue
            widest = int(value)
            for unit in linking.units:
                for element in _with_user(unit.root, str(name)):
                    widest = max(widest, len(str(element.get("user") or "").split()))
            size.set(name, str(widest))


def _with_user(root: Node, name: str) -> Iterator[Node]:
    if name in _USER_SECTIONS:
        for section in root.iterchildren(_USER_SECTIONS[name], "default"):
            yield from section.iter()
    else:
        for section in root.iterchildren("worldbody", "default"):
            yield from section.iter(*_USERS.get(name, ()))
