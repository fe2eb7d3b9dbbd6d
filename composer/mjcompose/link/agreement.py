"""Passes: settings that a model has only once, and which value wins.

Pass: the sections that a model has only once. A setting of a part that the model does not take is reported.

The model takes the base's value if the base writes one, else the value that all parts that write the setting agree
on, else MuJoCo's default. A setting that the recipe writes itself cannot conflict.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache, partial
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.link import numbers
from mjcompose.link.linking import Linking, Part
from mjcompose.link.numbers import read
from mjcompose.link.settings import merge_sizes, model_autolimits
from mjcompose.model.classes import text_in_effect
from mjcompose.model.files import file_attributes
from mjcompose.model.grammar import GRAMMAR
from mjcompose.model.merged_settings import Adopted
from mjcompose.model.select import kind_of
from mjcompose.model.unit import Unit

SINGLETONS = ("option", "visual", "statistic")
_SMALLER_IS_SAFER = ("timestep", "tolerance", "ls_tolerance", "noslip_tolerance", "ccd_tolerance", "sleep_tolerance")
_LARGER_IS_SAFER = ("iterations", "ls_iterations", "noslip_iterations", "ccd_iterations", "sdf_iterations",
                    "sdf_initpoints")  # fmt: skip


class WrittenSetting(NamedTuple):
    """A setting, and a function that finds where it is written.

    `parts` are the parts that it comes from, if the unit is a nested recipe.
    """

    value: str
    span: Callable[[], Span]
    parts: tuple[str, ...] = ()


def written_settings(unit: Unit) -> dict[str, WrittenSetting]:
    """Return every setting in the unit's own tree by its path. If a section repeats, the last value wins."""
    found: dict[str, WrittenSetting] = {}
    for section in unit.root.iterchildren(*SINGLETONS):
        _note(section, str(section.tag), unit, found=found)
    return found


def requested_settings(unit: Unit) -> dict[str, WrittenSetting]:
    """Return the settings a unit asks for: its own, and for a nested recipe the defaults that its parts agree on."""
    own = written_settings(unit)
    if not unit.adopted:
        return own
    agreed = {each.path: each for each in unit.adopted}
    found = {
        path: WrittenSetting(each.value, each.at, each.parts) for path, each in agreed.items()
        if not each.is_written
    }  # fmt: skip
    for path, each in own.items():
        known = agreed.get(path)
        parts = known.parts if known is not None and equal_values(known.value, each.value) else ()
        found[path] = WrittenSetting(each.value, each.span, parts)
    return found


def _note(element: Node, path: str, unit: Unit, found: dict[str, WrittenSetting]) -> None:
    for name, value in element.items():
        if value and not value.isspace():
            found[f"{path}/{name!s}"] = WrittenSetting(str(value), partial(_span, unit, element, str(name)))
    for child in element.iterchildren("*"):
        _note(child, f"{path}/{child.tag!s}", unit, found=found)


def _span(unit: Unit, element: Node, name: str) -> Span:
    return unit.origins.span(element, unit.file, name)


@cache
def default_of(path: str) -> str | None:
    """Return MuJoCo's default of a setting, or None if it has none or computes it."""
    element, name = path.rsplit("/", 1)
    attribute = GRAMMAR.element(element).attributes.get(name)
    value = attribute.default if attribute is not None else None
    if value is None:
        return None
    if isinstance(value, bool):
        return "true" if value else "false"
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def is_default(path: str, value: str) -> bool:
    """Return whether the value is MuJoCo's default of the setting."""
    default = default_of(path)
    return default is not None and equal_values(default, value)


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
    """Return two values merged as MuJoCo does, or None if they conflict.

    A value that is not written gives way. Of steps and tolerances the smaller is used, of iterations the larger.
    """
    # MuJoCo 4.0 takes of a `timestep` of 0.003 and one of 0.004 the smaller one, whoever writes it, and 0.004 where the
    # other model has it not written.
    if have is None:
        return wanted.value
    name = path.rsplit("/", 1)[1]
    if name in _SMALLER_IS_SAFER:
        return min(have.value, wanted.value, key=lambda text: numbers.read(text)[0])
    if name in _LARGER_IS_SAFER:
        return max(have.value, wanted.value, key=lambda text: numbers.read(text)[0])
    return None


def set_value(unit: Unit, path: str, value: str) -> Node:
    """Write a setting into the tree, and return the element that has it."""
    section, *inner, name = path.split("/")
    element = unit.section(section)
    for tag in inner:
        child = next(element.iterchildren(tag), None)
        if child is None:
            child = element.makeelement(tag)
            element.append(child)
        element = child
    element.set(name, value)
    return element


Opinions = Mapping[str, WrittenSetting]


def common_settings(
    base: Opinions, parts: Sequence[tuple[str, Opinions]], overridden: Collection[str]
) -> tuple[dict[str, Adopted], dict[str, list[tuple[str, WrittenSetting]]]]:
    """Return the settings that the parts agree on, and those that they do not agree on, by path.

    `base` and `parts` are what each unit asks for, the parts by what messages call them; `overridden` are the paths
    that the recipe sets itself. What the parts do not agree on comes with who writes which value.
    """
    asked: dict[str, list[tuple[str, WrittenSetting]]] = {}
    for name, opinions in parts:
        for path, wanted in opinions.items():
            if path not in base and path not in overridden:
                asked.setdefault(path, []).append((name, wanted))
    found: dict[str, Adopted] = {}
    for path, given in list(asked.items()):
        first = given[0][1]
        if all(equal_values(first.value, wanted.value) for _, wanted in given):
            names = tuple(
                name for owner, wanted in given for name in ([owner + inner for inner in wanted.parts] or [owner])
            )
            found[path] = Adopted(path, first.value, names, at=first.span, is_written=not is_default(path, first.value))
            del asked[path]
    return found, asked


def of_base(adopted: tuple[Adopted, ...], now: Opinions, overridden: Collection[str]) -> tuple[Adopted, ...]:
    """Return the settings from the parts of a base that is a recipe, if it still asks for the same values `now`."""
    return tuple(
        each
        for each in adopted
        if each.path not in overridden and each.path in now and equal_values(now[each.path].value, each.value)
    )


_NAMED = 4  # settings that a message names; the notes have all of them


@dataclass(frozen=True, slots=True)
class _Wish:
    """A setting of a part that differs from the model's; `settled` is the value that a merge gives it."""

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
        """The place of the model's own value, or None if it is not written."""
        return None if self.have is None else self.have.span()

    def difference(self, wanted: str) -> str:
        return f"{wanted} `{self.wanted.value}`, {_model_has(self.have, default_of(self.path))}"


def agreement(linking: Linking) -> None:
    """Compare what every unit writes, take what the parts agree on, then merge the sizes."""
    if not linking.parts:
        return
    model = requested_settings(linking.base)
    asked = [(part, requested_settings(part.unit)) for part in linking.parts]
    common, disagreed = _note_common(linking, model, asked)
    if linking.request.conflict == "mujoco":  # as in MuJoCo, a default gives way, wherever it is written
        unwritten = {each.path for each in linking.base.adopted if not each.is_written}
        model = {path: have for path, have in model.items() if path not in unwritten}
    elif linking.request.conflict == "error":
        for path, given in disagreed.items():
            owner, first = given[0]
            model[path] = first._replace(parts=(owner,))
    found = [(part, [*_wishes(linking, wanted, model, common=common)]) for part, wanted in asked]
    open_ones = [wish for _, wishes in found for wish in wishes if wish.settled is None]
    for part, wishes in found:
        _report_merged(linking, part, [wish for wish in wishes if wish.settled is not None])
        _report(linking, part, [wish for wish in wishes if wish.settled is None], all_wishes=open_ones)
    merge_sizes(linking)


def _note_common(
    linking: Linking, now: Opinions, asked: list[tuple[Part, dict[str, WrittenSetting]]]
) -> tuple[dict[str, Adopted], dict[str, list[tuple[str, WrittenSetting]]]]:
    """Return the settings that the parts agree on, which the base notes, and those that they do not agree on."""
    base, overridden = linking.base, linking.request.overridden_options
    parts = [(part.called, wanted) for part, wanted in asked]
    found, disagreed = common_settings(now, parts, overridden)
    base.adopted = (*of_base(base.adopted, now, overridden), *found.values())
    return found, disagreed


def _wishes(
    linking: Linking, asked: Opinions, model: dict[str, WrittenSetting], common: Mapping[str, Adopted]
) -> Iterator[_Wish]:
    """Yield the settings that a part asks for and the model does not have. Later parts see the results of merges.

    What the parts agree on is written on the way, so that settings stand in the order in which parts write them.
    """
    for path, wanted in asked.items():
        if path in linking.request.overridden_options:
            continue
        if path in common:
            _adopt(linking, common[path])
            continue
        have = model.get(path)
        current = have.value if have is not None else default_of(path)
        if current is not None and equal_values(current, wanted.value):
            continue
        settled = merge_values(path, have, wanted) if linking.request.conflict == "mujoco" else None
        yield _Wish(path, wanted, have, settled=settled)
        if settled is not None:
            set_value(linking.base, path, settled)
            model[path] = wanted._replace(value=settled)


def _adopt(linking: Linking, adopted: Adopted) -> None:
    if adopted.is_written:
        element = set_value(linking.base, adopted.path, adopted.value)
        linking.base.origins.settings.setdefault(element, {})[adopted.path.rsplit("/", 1)[1]] = adopted.at


def _report(linking: Linking, part: Part, wishes: list[_Wish], all_wishes: list[_Wish]) -> None:
    """Report all settings of a part in one finding with one help text for all parts. Equal parts share a finding."""
    if not wishes:
        return
    message, notes, span, cause = _message_of(part, wishes)
    if linking.request.conflict == "base":
        stands = ", which stands" if len(wishes) == 1 else "; the model's values stand"
        linking.sink.warning("option-conflict", f"{message}{stands}", span, notes=notes, cause=cause)
        return
    asked: dict[str, str] = {}
    for wish in all_wishes:
        asked.setdefault(wish.path, wish.wanted.value)
    sections = dict.fromkeys(wish.section for wish in wishes)
    others = [f"leave those of the part out: `drop: [{', '.join(sections)}]`"]
    if linking.request.conflict == "error" and _would_merge(all_wishes):
        others.append("write `conflict: mujoco`")
    sentence, *lines = resolving_settings(asked, linking.request.overridden_options).split("\n")
    help = "\n".join([f"{sentence}; or {', or '.join(others)}", *lines])
    subjects = (part.called, *(wish.path for wish in wishes))
    linking.sink.error("option-conflict", message, span, notes=notes, help=help, cause=cause, subjects=subjects)


def _report_merged(linking: Linking, part: Part, wishes: list[_Wish]) -> None:
    if not wishes:
        return
    message, notes, span, cause = _message_of(part, wishes)
    message += f"; merged to `{wishes[0].settled}`" if len(wishes) == 1 else "; they are merged"
    linking.sink.warning("option-conflict", message, span, notes=notes, cause=cause)


def _message_of(part: Part, wishes: list[_Wish]) -> tuple[str, list[Note], Span, Cause]:
    """Return the message, the notes with both values, the place, and the cause by which equal parts are recognized."""
    first = wishes[0]
    if len(wishes) == 1:
        message = first.difference(f"`{part.called}` wants {first.shown} to be")
        place = first.written()
        notes = [] if place is None or first.have is None else [Note(f"`{first.have.value}` is written here", place)]
    else:
        names = ", ".join(wish.shown for wish in wishes[:_NAMED])
        more = f" and {len(wishes) - _NAMED} more settings" if len(wishes) > _NAMED else ""
        message = f"`{part.called}` wants other values than the model has of {names}{more}"
        notes = [Note(_note_of(wish), wish.written()) for wish in wishes]
    same = [[wish.path, wish.wanted.value, wish.settled] for wish in wishes]
    return message, notes, first.wanted.span(), Cause(str(same), f"`{part.called}`")


def _note_of(wish: _Wish) -> str:
    said = wish.difference(f"{wish.shown}: it wants")
    return said if wish.settled is None else f"{said}; merged to `{wish.settled}`"


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


def _model_has(have: WrittenSetting | None, current: str | None) -> str:
    if have is not None:
        return f"{f'`{have.parts[0]}`' if have.parts else 'the model'} has `{have.value}`"
    if current is not None:
        return f"the model has `{current}`, MuJoCo's default"
    return "the model leaves it to MuJoCo"


def resolving_settings(wanted: Mapping[str, str], settled: Collection[str]) -> str:
    """Return what to write in a recipe to resolve all conflicts.

    `wanted` has the value that one part asks for, by path; `settled` are the paths that the recipe sets already.

    >>> resolving_settings({"option/cone": "elliptic", "option/flag/gravity": "disable"}, ())
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
    new = [f"{section}: {_flow(values)}" for section, values in tree.items() if section not in written_already]
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


_LIMITED_BY = {
    "range": "limited",
    "actuatorfrcrange": "actuatorfrclimited",
    "ctrlrange": "ctrllimited",
    "forcerange": "forcelimited",
    "actrange": "actlimited",
}
_IGNORED_BY = {"range": ("free",), "actuatorfrcrange": ("free", "ball")}
"""Types of joints that these do not limit: MuJoCo (3.12 to 4.0) does not look at them there."""
_SECTIONS = ("worldbody", "tendon", "actuator")


def autolimits(linking: Linking) -> None:
    """Check the units that set `autolimits="false"` in a model that does not, where such a range would limit.

    If all units set it, the model does too, and MuJoCo (3.12 to 4.0) reports the range: "joint has `range` but not
    `limited`".
    """
    if not linking.parts or model_autolimits(linking) == "false":
        return
    for unit in linking.units:
        if unit.settings.autolimits == "false":
            for section in unit.root.iterchildren(*_SECTIONS):
                for element in section.iterdescendants("*"):
                    _check(linking, unit, element)


def _check(linking: Linking, unit: Unit, element: Node) -> None:
    kind = kind_of(element)
    joint = text_in_effect(element, kind, "type", classes=unit.classes) if element.tag == "joint" else None
    for name, limited in _LIMITED_BY.items():
        if name not in kind.attributes or limited not in kind.attributes or joint in _IGNORED_BY.get(name, ()):
            continue
        if not any(read(text_in_effect(element, kind, name, classes=unit.classes) or "")):
            continue
        if (text_in_effect(element, kind, limited, classes=unit.classes) or "auto") == "auto":
            called = (
                f"{element.tag} `{element.get('name')}`" if element.get("name") else f"`<{element.tag}>` without a name"
            )
            linking.sink.error(
                "mujoco-rejects",
                f'{called} has `{name}` but not `{limited}`, and its file sets `autolimits="false"`',
                linking.span(unit, element, name),
                help=f'write `{limited}="true"` or `{limited}="false"` beside it',
            )


_NAME = "passthrough"


def passthrough(linking: Linking) -> None:
    """Let the model say what its textures are used to; refuse units of which some ask for it and some do not."""
    if not linking.parts or not any(map(_wants_passthrough, linking.units)):
        return
    asking: list[tuple[Unit, Node]] = []
    others: list[tuple[Unit, Node]] = []
    for unit in linking.units:
        textures = (element for element, _, _ in file_attributes(unit.root) if element.tag == "texture")
        if (texture := next(textures, None)) is not None:
            (asking if _wants_passthrough(unit) else others).append((unit, texture))
    if asking and others:
        _refuse(linking, asking[0][0], *others[0])
    for compiler in linking.base.root.iterchildren("compiler"):
        compiler.attrib.pop(_NAME, "")
    if asking:
        linking.base.section("compiler").set(_NAME, "textures")


def _wants_passthrough(unit: Unit) -> bool:
    said = [each.get(_NAME) for each in unit.root.iterchildren("compiler") if each.get(_NAME)]
    return bool(said) and said[-1] == "textures"


def _refuse(linking: Linking, unit: Unit, other: Unit, texture: Node) -> None:
    compiler = next(each for each in unit.root.iterchildren("compiler") if each.get(_NAME))
    linking.sink.error(
        "compiler-setting",
        f"`{_NAME}` of `{unit.label}` cannot be kept in a composition with `{other.label}`, whose textures are loaded",
        linking.span(unit, compiler, _NAME),
        notes=(Note("such a texture", linking.span(other, texture)),),
        help="let all of them say it, or none",
    )
