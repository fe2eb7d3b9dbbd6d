"""Selectors as a recipe writes them, and the section `contact`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.base.suggest import unknown_attribute as no_attribute
from mjcompose.language.element import Reader, path_of
from mjcompose.language.element_schema import mapping
from mjcompose.language.forms.definitions import Schema, reference
from mjcompose.language.sections import Lists
from mjcompose.language.value import Element, attribute_and_index
from mjcompose.language.wording import EXCLUSIVE, fault_at, kind_of, shown, unknown_key
from mjcompose.model.grammar import GRAMMAR, ElementType
from mjcompose.model.pattern import fault_of, is_pattern, is_regular, length_fault, stray_brace
from mjcompose.model.selector import Selector, known_tags, paths_of
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError
from mjcompose.text.node import is_template

GLOB: Schema = {
    "type": "string",
    "minLength": 1,
    "pattern": r"^/.*/$|\$\{|^(?:[^{}]|\{[^{}]*\})*$",
    "patternErrorMessage": "a choice is `{a,b}`, with no other one in it",
}
"""A glob or a regular expression over names."""


def pattern_fault(text: str, owner: str, at: Path) -> Fault | None:
    """Return the fault of the pattern with which `owner` is compared, or None."""
    if is_pattern(text) and (wrong := length_fault(text)) is not None:
        return Fault(
            "wrong-type",
            f"{owner}: {wrong}",
            at,
            help="give the elements a class or a `part`, or write several entries",
        )
    if is_regular(text):
        wrong = fault_of(text[1:-1])
        return Fault("wrong-type", f"the regular expression of {owner} is not valid: {wrong}", at) if wrong else None
    stray = stray_brace(text)
    if stray is None:
        return None
    message = f"the `{text[stray]}` in the glob `{text}` of {owner} is part of no choice"
    help = "a choice is `{a,b}`, with no other one in it; `/(a|b)[{]c/` is a regular expression"
    return Fault("wrong-type", message, at, help=help)


NARROWING = ("parent", "in", "part", "class", "where")
_BESIDE = (
    "expect", "optional", "when", "id", "set", "scale", "simplify", "collision", "convert",
    "move", "rename", "remove", "attr", "per",
)  # fmt: skip
"""Keys that stand beside a `select`."""
_EXAMPLE = 'write for instance `{geom: "**/pad*"}`'


def read_selector(
    value: Any, at: Path, owner: str, faults: list[Fault], beside: tuple[str, ...] = ()
) -> Selector | None:
    """Return the selector, or None after a reported fault. The keys `beside` it do not belong to it."""
    if not isinstance(value, dict):
        message = f"{owner} expects a selector, a mapping from a tag to names, got {kind_of(value)}"
        faults.append(Fault("wrong-type", message, at, help=_EXAMPLE))
        return None
    before = len(faults)
    keys = (*NARROWING, *beside)
    tags = [name for name in value if name not in keys]
    if not tags:
        faults.append(Fault("missing-key", f"{owner} lacks a tag", at, help=_EXAMPLE))
        return None
    tag, *others = tags
    if others:
        known = bool(paths_of(others[0]))
        help, fix = advised(others[0], keys)
        if others[0] in _BESIDE and owner.startswith("`select`"):
            help = f"write it beside `select`, behind the `}}` of the selector: `{others[0]}: …`"
            fix = None
        faults.append(
            Fault(
                EXCLUSIVE if known else "unknown-key",
                f"{owner} has both `{tag}` and `{others[0]}`, of which only one may stand"
                if known
                else f"`{others[0]}` is not a key of a selector",
                (*at, others[0]),
                key=True,
                notes=() if known else (exists_note("key", keys, others[0]),),
                help="write an entry of its own for each" if known else help,
                fix=None if known else fix,
            )
        )
    if not paths_of(tag):
        faults.append(_unknown_tag(tag, (*at, tag)))
        return None
    pattern = _pattern(value[tag], tag, (*at, tag), faults)
    outer = {
        name: read_selector(value[name], (*at, name), f"`{name}`", faults) for name in ("parent", "in") if name in value
    }
    texts = {name: _text(value[name], name, (*at, name), faults) for name in ("part", "class") if name in value}
    kinds = kinds_of(tag)
    if "class" in value and kinds and not any(kind.takes_class or kind.tag == "default" for kind in kinds):
        message = f"`{tag}` takes no class"
        faults.append(Fault("unknown-key", message, (*at, "class"), key=True, help="leave `class` out"))
    where = _where(value["where"], tag, (*at, "where"), faults) if "where" in value else None
    if len(faults) > before or pattern is None:
        return None
    return Selector(
        tag, pattern, outer.get("parent"), outer.get("in"), texts.get("part"), texts.get("class"), where,
        path_of(value),
    )  # fmt: skip


def advice_on_narrowing(name: str) -> str | None:
    """Return what to write if a key of a selector is beside it instead, or None for any other key."""
    return f"write it inside `select`: `select: {{TAG: NAME, {name}: …}}`" if name in NARROWING else None


def kinds_of(tag: str) -> tuple[ElementType, ...]:
    """Return the element types that a selector's tag means."""
    return tuple(GRAMMAR.element(path) for path in sorted(paths_of(tag)))


def _unknown_tag(tag: str, at: Path) -> Fault:
    help, fix = advised(tag, known_tags())
    if tag == "xpath":
        fix = None
        help = (
            "write a tag and narrow it: `parent` and `in` are the steps of a path, `where` is a condition; the first"
            ' geom without a name of a body is `{geom: "**", parent: {body: torso}, where: "${index == 0}"}`'
        )
    notes = () if help else (Note("a tag of MJCF (`geom`), a path (`equality/joint`), a family (`actuator`)"),)
    message = f"MJCF has no element `{tag}`"
    return Fault("unknown-element", message, at, key=True, notes=notes, help=help, fix=fix)


def _pattern(value: Any, tag: str, at: Path, faults: list[Fault]) -> str | None:
    if not isinstance(value, str) or not value:
        help = f'write `{tag}: "**"` for all of them'
        if isinstance(value, int | float) and not isinstance(value, bool):
            help = f"quote it: `{tag}: '{shown(value)}'`"
        message = f"`{tag}` expects a name or a glob, got {kind_of(value) if value != '' else 'empty text'}"
        faults.append(Fault("wrong-type", message, at, help=help))
        return None
    return value if _is_sound(value, tag, at, faults) else None


def _is_sound(value: str, name: str, at: Path, faults: list[Fault]) -> bool:
    wrong = pattern_fault(value, f"`{name}`", at)
    faults += [wrong] if wrong is not None else []
    return wrong is None


def _text(value: Any, name: str, at: Path, faults: list[Fault]) -> str | None:
    if isinstance(value, str) and value:
        return value if _is_sound(value, name, at, faults) else None
    faults.append(Fault("wrong-type", f"`{name}` expects a name or a glob, got {kind_of(value)}", at))
    return None


def _where(value: Any, tag: str, at: Path, faults: list[Fault]) -> dict[str, Any] | str | None:
    if isinstance(value, str) and is_template(value):
        check_template(value, at, faults)
        return value
    if not isinstance(value, dict) or not value:
        help = 'write `where: {type: mesh}`, or `where: "${size[0] > 0.1}"`'
        message = f"`where` is a mapping from attributes to values, or one boolean expression, got {kind_of(value)}"
        faults.append(Fault("wrong-type", message, at, help=help))
        return None
    kinds = kinds_of(tag)
    for name, wanted in value.items():
        attribute, _ = attribute_and_index(name)
        if isinstance(wanted, dict) or wanted is None:
            message = f"`{name}` in `where` is compared with a value, got {kind_of(wanted)}"
            faults.append(Fault("wrong-type", message, (*at, name)))
        if kinds and not any(attribute in kind.attributes for kind in kinds):
            faults.append(unknown_attribute(attribute, tag, kinds, (*at, name)))
    return dict(value)


def unknown_attribute(name: str, tag: str, kinds: tuple[ElementType, ...], at: Path) -> Fault:
    """Return the fault of an attribute that no element with the tag has."""
    known = sorted({each for kind in kinds for each in kind.attributes})
    help, fix = advised(name, known)
    if tag == "general" and name in ("kp", "kv"):
        help = "it has `gainprm` and `biasprm`; `convert: {to: position}` makes one with `kp` and `kv` of it"
        fix = None
    return fault_at(no_attribute(name, f"`{tag}`", known), at, key=True, help=help, fix=fix)


def check_template(text: str, at: Path, faults: list[Fault]) -> Template | None:
    """Return the parsed text with `${…}`, or None after a reported fault."""
    try:
        return Template.parse(text)
    except ExpressionError as error:
        faults.append(Fault("expression", error.message, at, help=error.help))
        return None


EXCLUDE: Literal["exclude"] = "exclude"
COLLIDE: Literal["collide"] = "collide"
BETWEEN, TOUCHING, AUTO = "between", "touching", "auto"
SAMPLES = 1000
_MOST_SAMPLES = 1_000_000


@dataclass(frozen=True, slots=True)
class Collisions:
    """Bodies that must not collide (`exclude`), or geoms that may (`collide`).

    The two `sides` are names of parts or globs over bodies. They are empty for bodies that already touch, and for
    bodies that are found with random configurations, of which `samples` are drawn with a `seed`. `at` is the path
    of the entry from the top of the recipe.
    """

    what: Literal["exclude", "collide"]
    sides: tuple[tuple[str, ...], ...]
    at: Path
    samples: int | None = None
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Contacts(Lists):
    """Form of `contact` with `exclude` and `collide`, read as a tuple of `Element` and `Collisions`."""

    def content(self, reader: Reader, value: Any) -> tuple[Any, ...]:
        if not isinstance(value, dict):
            return Lists.content(self, reader, value)
        top: Path = path_of(value) or (self.tag,)
        found: list[Element | Collisions] = []
        rest = dict(value)
        if COLLIDE in rest:
            items = rest.pop(COLLIDE)
            for at, item in _items(items, (COLLIDE,)):
                found += _between(reader, COLLIDE, item, at=at, top=top)
        excludes = rest.get(EXCLUDE)
        if excludes in (TOUCHING, AUTO) or (isinstance(excludes, Mapping) and "body1" not in excludes):
            found += _exclude(reader, rest.pop(EXCLUDE), (EXCLUDE,), top=top)
        elif isinstance(excludes, str):
            reader.faults.append(_no_word(rest.pop(EXCLUDE), (EXCLUDE,)))
        elif isinstance(excludes, list):
            own = [(index, item) for index, item in enumerate(excludes) if not _is_element(item)]
            for index, item in own:
                found += _exclude(reader, item, (EXCLUDE, index), top=top)
            if own:
                kind = self.kind.children[EXCLUDE]
                rest.pop(EXCLUDE)
                for index, item in enumerate(excludes):
                    if _is_element(item):
                        read = reader.element(kind, item, (EXCLUDE, index), f"`{EXCLUDE}`")
                        found += [] if read is None else [read]
        return (*Lists.content(self, reader, rest), *found)

    def schema(self) -> Schema:
        schema = Lists.schema(self)
        between, found = _schema(), _found_schema()
        words: Schema = {
            "enum": [TOUCHING, AUTO],
            "description": "bodies of different parts that touch, or all that need not collide",
        }
        exclude = schema["properties"][EXCLUDE]
        exclude["items"] = {"anyOf": [exclude["items"], found, words]}
        about = exclude.pop("description", "")
        schema["properties"][EXCLUDE] = {"anyOf": [exclude, found, words], "description": about}
        schema["properties"][COLLIDE] = {
            "anyOf": [between, {"type": "array", "items": between}],
            "description": "a contact pair for every two geoms between parts that could not touch otherwise",
        }
        return schema


def _schema() -> Schema:
    side: Schema = {"anyOf": [dict(GLOB), {"type": "array", "items": dict(GLOB), "minItems": 1}]}
    sides = {
        "type": "array", "items": side, "minItems": 2, "maxItems": 2,
        "description": "the two sides: parts by name, or globs over names of bodies",
    }  # fmt: skip
    return {**mapping({BETWEEN: sides}), "required": [BETWEEN]}


def _found_schema() -> Schema:
    """Return the schema of an `exclude` that does not name each pair."""
    samples = {
        **reference("integer"), "minimum": 1, "maximum": _MOST_SAMPLES,
        "description": f"in how many random poses nothing may touch (default: {SAMPLES})",
    }  # fmt: skip
    seed = {**reference("integer"), "minimum": 0, "description": "of the poses (default: 0)"}
    auto = {
        **mapping({"samples": samples, "seed": seed}),
        "description": "bodies that need not collide; `plan` has the reason of each pair",
    }
    return {**mapping({**_schema()["properties"], AUTO: auto}), "minProperties": 1, "maxProperties": 1}


def _is_element(item: Any) -> bool:
    return isinstance(item, Mapping) and not any(key == AUTO or closest(key, (BETWEEN,)) for key in item)


def _items(value: Any, at: Path) -> list[tuple[Path, Any]]:
    return [((*at, index), item) for index, item in enumerate(value)] if isinstance(value, list) else [(at, value)]


def _exclude(reader: Reader, value: Any, at: Path, top: Path) -> list[Collisions]:
    if value == TOUCHING:
        return [Collisions(EXCLUDE, (), (*top, *at))]
    if value == AUTO:
        return [Collisions(EXCLUDE, (), (*top, *at), samples=SAMPLES)]
    if isinstance(value, str):
        reader.faults.append(_no_word(value, at))
        return []
    if isinstance(value, Mapping) and AUTO in value:
        return _auto(reader, value, at, top=top)
    return _between(reader, EXCLUDE, value, at=at, top=top)


def _auto(reader: Reader, value: Mapping[str, Any], at: Path, top: Path) -> list[Collisions]:
    """Return the entry of one `{auto: {samples: 5000, seed: 1}}`, or None after a reported fault."""
    before = len(reader.faults)
    for key in value:
        if key != AUTO:
            message = f"`{key}` is not a key of `{EXCLUDE}`"
            note = exists_note("key", (AUTO,), key)
            reader.faults.append(Fault("unknown-key", message, (*at, key), key=True, notes=(note,)))
    given = value[AUTO]
    if not isinstance(given, Mapping):
        message = f"`{AUTO}` expects a mapping, got {kind_of(given)}"
        help = f"write `{AUTO}: {{samples: {SAMPLES}}}`"
        reader.faults.append(Fault("wrong-type", message, (*at, AUTO), help=help))
        return []
    for key, number in given.items():
        path = (*at, AUTO, key)
        if key not in ("samples", "seed"):
            reader.faults.append(unknown_key(f"`{key}` is not a key of `{AUTO}`", key, ("samples", "seed"), at=path))
        elif isinstance(number, bool) or not isinstance(number, int):
            message = f"`{key}` expects a whole number, got {kind_of(number)}"
            reader.faults.append(Fault("wrong-type", message, path))
        elif not (key == "samples") <= number <= (_MOST_SAMPLES if key == "samples" else 2**63):
            message = f"`{key}` is {int(key == 'samples')} to {_MOST_SAMPLES}, got {number}"
            reader.faults.append(Fault("out-of-range", message, path))
    if len(reader.faults) > before:
        return []
    return [Collisions(EXCLUDE, (), (*top, *at), samples=given.get("samples", SAMPLES), seed=given.get("seed", 0))]


def _no_word(word: str, at: Path) -> Fault:
    message = f"`{EXCLUDE}` is a list of pairs, `{TOUCHING}`, `{AUTO}` or `{BETWEEN}`, got `{word}`"
    near = closest(word, (TOUCHING, AUTO))
    help = f"write `{EXCLUDE}: {near[0]}`" if near else f"write `{EXCLUDE}: {{{BETWEEN}: [ARM, TABLE]}}`"
    return Fault("wrong-keyword", message, at, help=help)


def _between(reader: Reader, what: Literal["exclude", "collide"], value: Any, at: Path, top: Path) -> list[Collisions]:
    """Return the entry of one `{between: [ARM, TABLE]}`, or None after a reported fault."""
    example = f"write `{what}: {{{BETWEEN}: [ARM, TABLE]}}`, with names of parts or globs over bodies"
    before = len(reader.faults)
    if not isinstance(value, Mapping):
        message = f"`{what}` expects `{BETWEEN}`, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=example))
        return []
    for key in value:
        if key != BETWEEN:
            note = exists_note("key", (BETWEEN,), key)
            message = f"`{key}` is not a key of `{what}`"
            near = f"write `{BETWEEN}`" if closest(key, (BETWEEN,)) else None
            reader.faults.append(Fault("unknown-key", message, (*at, key), key=True, notes=(note,), help=near))
    if BETWEEN not in value:
        if len(reader.faults) == before:
            reader.faults.append(Fault("missing-key", f"`{what}` lacks `{BETWEEN}`", at, help=example))
        return []
    sides = value[BETWEEN]
    if not isinstance(sides, list) or len(sides) != 2:
        code = "wrong-length" if isinstance(sides, list) else "wrong-type"
        got = f"{len(sides)}" if isinstance(sides, list) else kind_of(sides)
        message = f"`{BETWEEN}` of `{what}` expects two sides, got {got}"
        reader.faults.append(Fault(code, message, (*at, BETWEEN), help=example))
        return []
    read = [_side(reader, side, what, at=(*at, BETWEEN, index)) for index, side in enumerate(sides)]
    return [] if len(reader.faults) > before else [Collisions(what, tuple(read), (*top, *at))]


def _side(reader: Reader, value: Any, what: str, at: Path) -> tuple[str, ...]:
    names = value if isinstance(value, list) else [value]
    for index, name in enumerate(names):
        place = (*at, index) if isinstance(value, list) else at
        if not isinstance(name, str) or not name:
            message = f"a side of `{BETWEEN}` in `{what}` is a name or a glob, got {kind_of(name)}"
            reader.faults.append(Fault("wrong-type", message, place))
        elif (fault := pattern_fault(name, f"`{what}`", place)) is not None:
            reader.faults.append(fault)
    if not names:
        reader.faults.append(Fault("wrong-type", f"a side of `{BETWEEN}` in `{what}` is empty", at))
    return tuple(str(name) for name in names)
