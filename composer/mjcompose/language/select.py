"""Selectors as a recipe writes them."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import advised, exists_note, unknown_attribute as no_attribute
from mjcompose.base.words import value_text
from mjcompose.language.element import path_of
from mjcompose.language.forms.context import Schema
from mjcompose.language.value import EXCLUSIVE, attribute_and_index, fault_at, kind_of
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError
from mjcompose.text.node import is_template
from mjcompose.tree.grammar import GRAMMAR, ElementType
from mjcompose.tree.pattern import (
    Selector,
    fault_of,
    is_pattern,
    is_regular,
    known_tags,
    length_fault,
    paths_of,
    stray_brace,
)

GLOB: Schema = {
    "type": "string",
    "minLength": 1,
    "pattern": r"^/.*/$|\$\{|^(?:[^{}]|\{[^{}]*\})*$",
    "patternErrorMessage": "a choice is `{a,b}`, without another choice inside",
}
"""A glob or a regular expression over names."""


def pattern_fault(text: str, owner: str, at: Path) -> Fault | None:
    """Return the fault of the pattern with which `owner` is compared, or None."""
    if is_pattern(text) and (wrong := length_fault(text)) is not None:
        help = "give the elements a class or a `part`, or write several entries"
        return Fault("wrong-type", f"{owner}: {wrong}", at, help=help)
    if is_regular(text):
        wrong = fault_of(text[1:-1])
        return Fault("wrong-type", f"the regular expression of {owner} is not valid: {wrong}", at) if wrong else None
    stray = stray_brace(text)
    if stray is None:
        return None
    message = f"the `{text[stray]}` in the glob `{text}` of {owner} does not belong to a choice"
    help = "a choice is `{a,b}`, without another choice inside; `/(a|b)[{]c/` is a regular expression"
    return Fault("wrong-type", message, at, help=help)


NARROWING = ("parent", "in", "part", "class", "where")
NARROWED = {name: f"write it inside `select`: `select: {{TAG: NAME, {name}: …}}`" for name in NARROWING}
"""What to write instead of one of these next to a `select`."""
_BESIDE = (
    "expect",
    "optional",
    "when",
    "id",
    "set",
    "scale",
    "simplify",
    "collision",
    "convert",
    "move",
    "rename",
    "remove",
    "attr",
    "per",
)
"""Keys next to a `select`."""
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
        faults.append(_second_tag(tag, others[0], at, owner, keys=keys))
    if not paths_of(tag):
        faults.append(_unknown_tag(tag, (*at, tag)))
        return None
    pattern = _glob(value[tag], tag, (*at, tag), faults=faults, help=f'write `{tag}: "**"` for all of them')
    outer = {
        name: read_selector(value[name], (*at, name), f"`{name}`", faults) for name in ("parent", "in") if name in value
    }
    texts = {name: _glob(value[name], name, (*at, name), faults=faults) for name in ("part", "class") if name in value}
    kinds = kinds_of(tag)
    if "class" in value and kinds and not any(kind.takes_class or kind.tag == "default" for kind in kinds):
        message = f"`{tag}` takes no class"
        faults.append(Fault("unknown-key", message, (*at, "class"), key=True, help="leave `class` out"))
    where = _where(value["where"], tag, (*at, "where"), faults) if "where" in value else None
    if len(faults) > before or pattern is None:
        return None
    return Selector(
        tag,
        pattern,
        outer.get("parent"),
        outer.get("in"),
        texts.get("part"),
        texts.get("class"),
        where,
        path_of(value),
    )


def _second_tag(tag: str, name: str, at: Path, owner: str, keys: tuple[str, ...]) -> Fault:
    """Return the fault of a key next to the tag of a selector: another tag, or no key of a selector."""
    if paths_of(name):
        message = f"{owner} has both `{tag}` and `{name}`, of which only one is allowed"
        return Fault(EXCLUSIVE, message, (*at, name), key=True, help="write an entry of its own for each")
    help, fix = advised(name, keys)
    if name in _BESIDE and owner.startswith("`select`"):
        help = f"write it next to `select`, after the `}}` of the selector: `{name}: …`"
        fix = None
    message = f"`{name}` is not a key of a selector"
    notes = (exists_note("key", keys, name),)
    return Fault("unknown-key", message, (*at, name), key=True, notes=notes, help=help, fix=fix)


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
    return Fault("unknown-element", f"MJCF has no element `{tag}`", at, key=True, notes=notes, help=help, fix=fix)


def _glob(value: Any, name: str, at: Path, faults: list[Fault], help: str | None = None) -> str | None:
    if isinstance(value, str) and value:
        wrong = pattern_fault(value, f"`{name}`", at)
    else:
        if isinstance(value, int | float) and not isinstance(value, bool):
            help = f"quote it: `{name}: '{value_text(value)}'`"
        message = f"`{name}` expects a name or a glob, got {kind_of(value) if value != '' else 'empty text'}"
        wrong = Fault("wrong-type", message, at, help=help)
    faults += [wrong] if wrong is not None else []
    return value if wrong is None else None


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


OF_INERTIAL = {"ipos": "pos", "iquat": "quat", "inertia": "diaginertia"}
"""Arrays of mjModel about a body, and the attributes of its `inertial` that give their values."""


def unknown_attribute(name: str, tag: str, kinds: tuple[ElementType, ...], at: Path) -> Fault:
    """Return the fault of an attribute that no element with the tag has."""
    known = sorted({each for kind in kinds for each in kind.attributes})
    help, fix = advised(name, known)
    if tag == "body" and (meant := OF_INERTIAL.get(name.removeprefix("body_"))) is not None:
        selector = '{inertial: "**", parent: {body: NAME}}'
        help = f"`{name}` of mjModel is `{meant}` of an `inertial`: select `{selector}`, and write `{meant}`"
        fix = None
    if tag == "general" and name in ("kp", "kv"):
        help = "it has `gainprm` and `biasprm`; `convert: {to: position}` turns it into an actuator with `kp` and `kv`"
        fix = None
    return fault_at(no_attribute(name, f"`{tag}`", known), at, key=True, help=help, fix=fix)


def check_template(text: str, at: Path, faults: list[Fault]) -> Template | None:
    """Return the parsed text with `${…}`, or None after a reported fault."""
    try:
        return Template.parse(text)
    except ExpressionError as error:
        faults.append(Fault("expression", error.message, at, help=error.help))
        return None
