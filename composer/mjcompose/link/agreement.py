"""Passes: settings that a model has only once, and which value wins.

The model takes the base's value if the base writes one, else the value that all parts that write the setting agree
on, else MuJoCo's default. A setting that the recipe writes itself cannot conflict. Other conflicts are reported.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache, partial
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.link import numbers
from mjcompose.link.linking import Linking, Part, shown_name
from mjcompose.link.settings import merge_sizes, model_autolimits
from mjcompose.tree import journal
from mjcompose.tree.classes import text_in_effect
from mjcompose.tree.files import file_attributes
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.journal import because, explained
from mjcompose.tree.merged_settings import Adopted
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit

SINGLETONS = ("option", "visual", "statistic")
_SMALLER_IS_SAFER = ("timestep", "tolerance", "ls_tolerance", "noslip_tolerance", "ccd_tolerance", "sleep_tolerance")
_LARGER_IS_SAFER = (
    "iterations",
    "ls_iterations",
    "noslip_iterations",
    "ccd_iterations",
    "sdf_iterations",
    "sdf_initpoints",
)


class WrittenSetting(NamedTuple):
    """A setting, its place, and the parts that it comes from if the unit is a nested recipe."""

    value: str
    span: Callable[[], Span]
    parts: tuple[str, ...] = ()


def written_settings(unit: Unit) -> dict[str, WrittenSetting]:
    """Return every setting in the unit's own tree by its path. If a section repeats, the last value wins."""
    found: dict[str, WrittenSetting] = {}
    waiting = [(section, str(section.tag)) for section in unit.root.iterchildren(*SINGLETONS)][::-1]
    while waiting:
        element, path = waiting.pop()
        for name, value in element.items():
            if value and not value.isspace():
                span = partial(unit.origins.span, element, unit.file, str(name))
                found[f"{path}/{name!s}"] = WrittenSetting(str(value), span)
        waiting += [(child, f"{path}/{child.tag!s}") for child in element.iterchildren("*", reversed=True)]
    return found


def requested_settings(unit: Unit) -> dict[str, WrittenSetting]:
    """Return the settings a unit requests: its own, and for a nested recipe the defaults that its parts agree on."""
    own = written_settings(unit)
    if not unit.adopted:
        return own
    agreed = {each.path: each for each in unit.adopted}
    found = {
        path: WrittenSetting(each.value, each.at, each.parts) for path, each in agreed.items() if not each.is_written
    }
    for path, each in own.items():
        known = agreed.get(path)
        parts = known.parts if known is not None and equal_values(known.value, each.value) else ()
        found[path] = WrittenSetting(each.value, each.span, parts)
    return found


_DEFAULT_DIFFERS = ("visual/global/bvactive",)
"""Settings whose default is not the same in each MuJoCo that builds: `true` in 3.11, `false` since 3.12."""


@cache
def default_of(path: str) -> str | None:
    """Return MuJoCo's default of a setting, or None if it has none, computes it, or another version has another."""
    if path in _DEFAULT_DIFFERS:
        return None
    element, name = path.rsplit("/", 1)
    attribute = GRAMMAR.element(element).attributes.get(name)
    value = attribute.default if attribute is not None else None
    if value is None:
        return None
    if isinstance(value, bool):
        return "true" if value else "false"
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


@lru_cache(4096)
def equal_values(a: str, b: str) -> bool:
    """Return whether two values of a setting are equal: `1e-2` is `0.01`."""
    if a == b or a.split() == b.split():
        return True
    try:
        return numbers.read(a) == numbers.read(b)
    except ValueError:
        return False


def merge_values(path: str, have: WrittenSetting | None, wanted: WrittenSetting) -> str | None:
    """Return two values merged as MuJoCo does (the smaller step or tolerance, more iterations); None for a conflict."""
    # If two models write a `timestep` of 0.003 and of 0.004, MuJoCo 4.0 takes the smaller value, whichever model writes
    # it. It takes 0.004 if the other model does not write a `timestep`.
    if have is None:
        return wanted.value
    name = path.rsplit("/", 1)[1]
    safer = min if name in _SMALLER_IS_SAFER else max if name in _LARGER_IS_SAFER else None
    return None if safer is None else safer(have.value, wanted.value, key=lambda text: numbers.first(text))


def set_value(unit: Unit, path: str, value: str) -> Node:
    """Write a setting into the tree, and return the element that has it."""
    section, *inner, name = path.split("/")
    element = unit.section(section)
    for tag in inner:
        child = next(element.iterchildren(tag), None)
        if child is None:
            child = element.makeelement(tag)
            journal.place(element, child)
        element = child
    journal.write(element, name, value)
    return element


Opinions = Mapping[str, WrittenSetting]


def common_settings(
    base: Opinions, parts: Sequence[tuple[str, Opinions]], overridden: Collection[str]
) -> tuple[dict[str, Adopted], dict[str, list[tuple[str, WrittenSetting]]]]:
    """Return the settings that the parts agree on, and the settings on which they differ, by path.

    `base` and `parts` are the settings that each unit requests, with the parts by their names in messages; `overridden`
    has the paths that the recipe sets itself. Each setting on which the parts differ has the value of each part.
    """
    requested: dict[str, list[tuple[str, WrittenSetting]]] = {}
    for name, opinions in parts:
        for path, wanted in opinions.items():
            if path not in base and path not in overridden:
                requested.setdefault(path, []).append((name, wanted))
    common: dict[str, Adopted] = {}
    for path, given in list(requested.items()):
        first = given[0][1]
        if all(equal_values(first.value, wanted.value) for _, wanted in given):
            names = tuple(
                name for owner, wanted in given for name in ([owner + inner for inner in wanted.parts] or [owner])
            )
            default = default_of(path)
            is_written = default is None or not equal_values(default, first.value)
            common[path] = Adopted(path, first.value, names, at=first.span, is_written=is_written)
            del requested[path]
    return common, requested


def of_base(adopted: tuple[Adopted, ...], now: Opinions, overridden: Collection[str]) -> tuple[Adopted, ...]:
    kept = (each for each in adopted if each.path in now and each.path not in overridden)
    return tuple(each for each in kept if equal_values(now[each.path].value, each.value))


_NAMED = 4  # settings that a message names; the notes have all of them


class _Wish(Struct):
    """A setting of a part that differs from the model's setting; `settled` is the value that a merge gives it."""

    path: str
    wanted: WrittenSetting
    have: WrittenSetting | None
    settled: str | None = None

    @property
    def section(self) -> str:
        return self.path.split("/")[0]

    @property
    def shown(self) -> str:
        return f"`{self.path.replace('/', '.')}`"

    def written(self) -> Span | None:
        return None if self.have is None else self.have.span()

    def difference(self, wanted: str) -> str:
        default = default_of(self.path)
        if self.have is not None:
            owner = f"`{self.have.parts[0]}`" if self.have.parts else "the model"
            has = f"{owner} has `{self.have.value}`"
        else:
            has = "the model leaves it to MuJoCo"
            if default is not None:
                has = f"the model has `{default}`, MuJoCo's default"
        return f"{wanted} `{self.wanted.value}`, {has}"


def agreement(linking: Linking) -> None:
    """Compare the settings of all units, take the values that the parts agree on, then merge the sizes."""
    if not linking.parts:
        return
    base = linking.base
    overridden = linking.request.overridden_options
    model = requested_settings(base)
    requests = [(part, requested_settings(part.unit)) for part in linking.parts]
    common, disagreed = common_settings(model, [(part.called, wanted) for part, wanted in requests], overridden)
    base.adopted = (*of_base(base.adopted, model, overridden), *common.values())
    if linking.request.conflict == "mujoco":  # as in MuJoCo, a default gives way, wherever it is written
        unwritten = {each.path for each in base.adopted if not each.is_written}
        model = {path: have for path, have in model.items() if path not in unwritten}
    elif linking.request.conflict == "error":
        for path, given in disagreed.items():
            owner, first = given[0]
            model[path] = first._replace(parts=(owner,))
    wishes = [(part, [*_wishes(linking, part, wanted, model, common=common)]) for part, wanted in requests]
    conflicts = [wish for _, of_part in wishes for wish in of_part if wish.settled is None]
    for part, of_part in wishes:
        if merged := [wish for wish in of_part if wish.settled is not None]:
            message, notes, span, cause = _message_of(part, merged)
            message += f"; merged to `{merged[0].settled}`" if len(merged) == 1 else "; they are merged"
            linking.sink.warning("option-conflict", message, span, notes=notes, cause=cause)
        _report(linking, part, [wish for wish in of_part if wish.settled is None], all_wishes=conflicts)
    merge_sizes(linking)


def _wishes(
    linking: Linking, part: Part, requested: Opinions, model: dict[str, WrittenSetting], common: Mapping[str, Adopted]
) -> Iterator[_Wish]:
    """Yield settings of a part that the model lacks after common ones are written. Later parts see merged values."""
    for path, wanted in requested.items():
        if path in linking.request.overridden_options:
            continue
        if path in common:
            adopted = common[path]
            if adopted.is_written:
                words = f"adopted from {', '.join(adopted.parts)}: neither base nor recipe writes it"
                with explained(because(words, adopted.at)):
                    element = set_value(linking.base, path, adopted.value)
                linking.base.origins.settings.setdefault(element, {})[path.rsplit("/", 1)[1]] = adopted.at
            continue
        have = model.get(path)
        current = have.value if have is not None else default_of(path)
        if current is not None and equal_values(current, wanted.value):
            continue
        settled = merge_values(path, have, wanted) if linking.request.conflict == "mujoco" else None
        yield _Wish(path, wanted, have, settled=settled)
        if settled is not None:
            with explained(because(f"required by the part `{part.called}`", wanted.span)):
                set_value(linking.base, path, settled)
            model[path] = wanted._replace(value=settled)


def _report(linking: Linking, part: Part, wishes: list[_Wish], all_wishes: list[_Wish]) -> None:
    if not wishes:
        return
    message, notes, span, cause = _message_of(part, wishes)
    if linking.request.conflict == "base":
        stays = ", which stays" if len(wishes) == 1 else "; the model's values stay"
        linking.sink.warning("option-conflict", f"{message}{stays}", span, notes=notes, cause=cause)
        return
    wanted: dict[str, str] = {}
    for wish in all_wishes:
        wanted.setdefault(wish.path, wish.wanted.value)
    sections = dict.fromkeys(wish.section for wish in wishes)
    others = [f"drop the settings of the part: `drop: [{', '.join(sections)}]`"]
    if linking.request.conflict == "error" and _would_merge(all_wishes):
        others.append("write `conflict: mujoco`")
    sentence, *lines = resolving_settings(wanted, linking.request.overridden_options).split("\n")
    help = "\n".join([f"{sentence}; or {', or '.join(others)}", *lines])
    subjects = (part.called, *(wish.path for wish in wishes))
    linking.sink.error("option-conflict", message, span, notes=notes, help=help, cause=cause, subjects=subjects)


def _message_of(part: Part, wishes: list[_Wish]) -> tuple[str, list[Note], Span, Cause]:
    """Return the message, the notes with both values, the place, and the cause, which is equal for equal parts."""
    first = wishes[0]
    if len(wishes) == 1:
        message = first.difference(f"`{part.called}` needs {first.shown} to be")
        place = first.written()
        notes = [] if place is None or first.have is None else [Note(f"`{first.have.value}` is written here", place)]
    else:
        names = ", ".join(wish.shown for wish in wishes[:_NAMED])
        more = f" and {len(wishes) - _NAMED} more settings" if len(wishes) > _NAMED else ""
        message = f"`{part.called}` needs values that differ from the model's: {names}{more}"
        notes = [
            Note(
                wish.difference(f"{wish.shown}: it wants") + (f"; merged to `{wish.settled}`" if wish.settled else ""),
                wish.written(),
            )
            for wish in wishes
        ]
    same = [[wish.path, wish.wanted.value, wish.settled] for wish in wishes]
    return message, notes, first.wanted.span(), Cause(str(same), f"`{part.called}`")


def _would_merge(wishes: Iterable[_Wish]) -> bool:
    """Return whether `conflict: mujoco` would resolve all conflicts."""
    model: dict[str, WrittenSetting] = {}
    for wish in wishes:
        have = model.get(wish.path, wish.have)
        if have is not None and equal_values(have.value, wish.wanted.value):
            continue
        settled = merge_values(wish.path, have, wish.wanted)
        if settled is None:
            return False
        model[wish.path] = wish.wanted._replace(value=settled)
    return True


def resolving_settings(wanted: Mapping[str, str], settled: Collection[str]) -> str:
    """Return advice for a recipe that resolves all conflicts.

    `wanted` has the value that one part requests, by path; `settled` are the paths that the recipe sets already.

    >>> resolving_settings({"option/cone": "elliptic", "option/flag/gravity": "disable"}, ())
    'set it in the recipe, for example `option: {cone: elliptic, flag: {gravity: disable}}`'
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
    new = [f"{section}: {_flow(values)}" for section, values in tree.items() if section not in written_already]
    grown = [
        f"set it in the recipe's `{section}`, for example `{_flow(values)[1:-1]}`"
        for section, values in tree.items()
        if section in written_already
    ]
    if len(new) > 1:
        return "\n".join(["; ".join([*grown, "set it in the recipe, for example as follows"]), *new])
    return "; ".join([*grown, *(f"set it in the recipe, for example `{each}`" for each in new)])


def _flow(tree: Mapping[str, Any]) -> str:
    entries = (f"{name}: {value if isinstance(value, str) else _flow(value)}" for name, value in tree.items())
    return f"{{{', '.join(entries)}}}"


_LIMITED_BY = {
    "range": "limited",
    "actuatorfrcrange": "actuatorfrclimited",
    "ctrlrange": "ctrllimited",
    "forcerange": "forcelimited",
    "actrange": "actlimited",
}
_IGNORED_BY = {"range": ("free",), "actuatorfrcrange": ("free", "ball")}
"""Types of joints that these do not limit: MuJoCo (3.12 to 4.0) ignores them there."""


def autolimits(linking: Linking) -> None:
    """Check the units that set `autolimits="false"` in a model that does not, because a range would limit there.

    If all units set it, the model does too, and MuJoCo (3.12 to 4.0) reports the range: "joint has `range` but not
    `limited`".
    """
    if not linking.parts or model_autolimits(linking) == "false":
        return
    for unit in linking.units:
        if unit.settings.autolimits == "false":
            for section in unit.root.iterchildren("worldbody", "tendon", "actuator"):
                for element in section.iterdescendants("*"):
                    _check_limits(linking, unit, element)


def _check_limits(linking: Linking, unit: Unit, element: Node) -> None:
    kind = kind_of(element)
    joint = text_in_effect(element, kind, "type", classes=unit.classes) if element.tag == "joint" else None
    for name, limited in _LIMITED_BY.items():
        if name not in kind.attributes or limited not in kind.attributes or joint in _IGNORED_BY.get(name, ()):
            continue
        if not any(numbers.read(text_in_effect(element, kind, name, classes=unit.classes) or "")):
            continue
        if (text_in_effect(element, kind, limited, classes=unit.classes) or "auto") == "auto":
            tag = element.tag if element.get("name") else f"`<{element.tag}>`"
            message = (
                f'{tag} {shown_name(element)} has `{name}` but not `{limited}`, and its file sets `autolimits="false"`'
            )
            help = f'add `{limited}="true"` or `{limited}="false"`'
            linking.sink.error("mujoco-rejects", message, linking.span(unit, element, name), help=help)


_NAME = "passthrough"


def passthrough(linking: Linking) -> None:
    """Set `passthrough` of the model as its units with textures do; refuse units that differ."""
    if not linking.parts or not any(map(_wants_passthrough, linking.units)):
        return
    asking: list[tuple[Unit, Node]] = []
    others: list[tuple[Unit, Node]] = []
    for unit in linking.units:
        textures = (element for element, _, _ in file_attributes(unit.root) if element.tag == "texture")
        if (texture := next(textures, None)) is not None:
            (asking if _wants_passthrough(unit) else others).append((unit, texture))
    if asking and others:
        unit = asking[0][0]
        other, texture = others[0]
        compiler = next(each for each in unit.root.iterchildren("compiler") if each.get(_NAME))
        which = f"`{other.label}`, whose textures are loaded"
        message = f"`{_NAME}` of `{unit.label}` cannot be kept in a composition with {which}"
        notes = (Note("such a texture", linking.span(other, texture)),)
        help = "set it in all of them, or in none"
        linking.sink.error("compiler-setting", message, linking.span(unit, compiler, _NAME), notes=notes, help=help)
    for compiler in linking.base.root.iterchildren("compiler"):
        journal.drop(compiler, _NAME)
    if asking:
        journal.write(linking.base.section("compiler"), _NAME, "textures")


def _wants_passthrough(unit: Unit) -> bool:
    said = [each.get(_NAME) for each in unit.root.iterchildren("compiler") if each.get(_NAME)]
    return bool(said) and said[-1] == "textures"
