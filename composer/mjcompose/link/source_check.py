"""Check that a model file is valid MJCF, because linking can hide errors that MuJoCo would report.

Sections of settings are joined, a part's root is unwrapped, and options give way to the recipe's options. Inside
`<frame>` and `<replicate>`, where parts are attached, MuJoCo's reader ignores unknown elements and attributes (4.0:
`<frame><geom mode="x" size="1"/></frame>` compiles, `<geom mode="x" size="1"/>` does not). Text that MuJoCo ignores in
the file itself is not an error here: `tree/ignored.py` reports it as a warning.

The check takes longer than parsing and linking a file (2 ms for 250 elements, against 1.7 ms). Verified builds run
it first. Other builds run it only after the linker has raised `NotMjcf`. Even then the fault may not be the cause:
the work is repeated with the faults corrected; if it still raises, the exception is a bug and is raised.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from itertools import chain

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.link.corrections import without_attribute
from mjcompose.link.settings import ROOM
from mjcompose.mujoco.messages import instead_of_old, of_other_version, unknown_attribute, unknown_element, version_of
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, version_key
from mjcompose.tree.unit import Unit
from mjcompose.tree.values import Refusal, check_value
from mjcompose.tree.xml_faults import BLIND, unread

_FREE = frozenset({"string", "file", "name", "reference", "references"})
"""Types of attributes of which every text is a value."""
# Numbers as almost everybody writes them: most of the values there are, and four times as fast to see.
_PLAIN = re.compile(r"-?[0-9.]+(?: -?[0-9.]+)*", re.ASCII)


class _Fault(Struct):
    """A fault of an element, or of its attribute `name`; the message marks its name (`key`) or value.

    A fault without a `code` is an element or an attribute that MJCF does not have. `first` is the element that it
    repeats. To repair the element, its attributes become `repaired`, with None for each removed attribute; without
    `repaired`, the element is removed.
    """

    node: Node
    code: str = ""
    message: str = ""
    help: str | None = None
    name: str | None = None
    key: bool = False
    first: Node | None = None
    repaired: Mapping[str, str | None] | None = None

    def report(self, unit: Unit, sink: Sink, version: str | None, *, is_part: bool) -> None:
        span = unit.origins.span(self.node, unit.file, self.name, key=self.key)
        if not self.code:
            if self.name is None:
                found = unknown_element(self.node, unit.file, version).diagnostic
            else:
                found = unknown_attribute(self.node, self.name, unit.file, version=version).diagnostic
                if is_part:
                    found = replace(found, help=_help_in_part(found.help, self.node, self.name))
            sink.add(replace(found, span=span))
            return
        notes: tuple[Note, ...] = ()
        if self.first is not None:
            notes = (Note("the other one is here", unit.origins.span(self.first, unit.file, self.name)),)
        sink.error(self.code, self.message, span, notes=notes, help=self.help)

    def repair(self) -> None:
        if self.repaired is None:
            journal.remove(self.node)
        for name, value in (self.repaired or {}).items():
            if value is None:
                journal.drop(self.node, name)
            else:
                journal.write(self.node, name, value)

    @property
    def is_unknown_attribute(self) -> bool:
        return not self.code and self.name is not None

    @property
    def unknown(self) -> tuple[Node, str | None]:
        return self.node, None if self.code else self.name


def _help_in_part(help: str | None, node: Node, name: str) -> str | None:
    """Return the help for an attribute that MJCF does not have, with the entry of a part that removes it.

    Without the entry if another MuJoCo reads the attribute: the file would lose a meaning.
    """
    written = str(node.get(name))
    is_of_other = (
        of_other_version(node, name, None) is not None or instead_of_old(str(node.tag), name, written) is not None
    )
    correction = None if is_of_other else without_attribute(node, name)
    return help if correction is None else f"{help}\nor write in its part of the recipe `{correction.text}`"


def check_source(unit: Unit, sink: Sink, *, is_part: bool = False, later: list[tuple[Node, str]] | None = None) -> bool:
    """Report everything in a file that is not MJCF, before it is linked, and return whether the file is valid.

    `is_part` says that a recipe uses it. With `later`, attributes that MJCF does not have are no faults, because edits
    may remove them: `later` receives them, each with its element.
    """
    faults = _reported_faults(unit)
    if later is not None:
        later += [(fault.node, fault.name) for fault in faults if fault.is_unknown_attribute and fault.name]
        faults = [fault for fault in faults if not fault.is_unknown_attribute]
    version = version_of(fault.unknown for fault in faults if not fault.code)
    for fault in faults:
        fault.report(unit, sink, version, is_part=is_part)
    return not faults


def _reported_faults(unit: Unit) -> list[_Fault]:
    faults = list(_faults(unit.root))
    passed_over = set(unread(unit.root)) if faults else set()
    return [fault for fault in faults if fault.unknown not in passed_over]


def repair(unit: Unit) -> None:
    """Remove unknown elements and attributes; replace the values of malformed attributes by arbitrary valid ones."""
    for fault in list(_faults(unit.root)):
        fault.repair()


def _repeated(root: Node) -> Iterator[_Fault]:
    """Yield keys and classes that repeat an earlier name. Linking merges keys and renames `main`."""
    # MuJoCo 4.0: `repeated default class name`. The class at the top is `main`, written or not.
    tops = list(root.iterchildren("default"))
    classes = dict.fromkeys([MAIN], tops[0]) if tops else {}
    for known, nodes, attribute, code, kind in (
        ({}, root.iterfind("keyframe/key"), "name", "name-clash", "keys"),
        (classes, chain(*(top.iterfind(".//default") for top in tops)), "class", "class-clash", "classes"),
    ):
        for node in nodes:
            name = str(node.get(attribute) or "")
            if name and (first := known.setdefault(name, node)) is not node:
                message = f"two {kind} are called `{name}`"
                help = "give one of them another name"
                yield _Fault(node, code, message, help=help, name=attribute, first=first)


def _faults(root: Node) -> Iterator[_Fault]:
    yield from _repeated(root)
    waiting = [(root, GRAMMAR.root)]
    while waiting:
        node, kind = waiting.pop()
        yield from _of_attributes(node, kind)
        if kind.constraints and len(node.attrib) > 1 and _is_checked(node):
            yield from _of_constraints(node, kind)
        yield from _of_name(node, kind)
        if not len(node):
            continue
        known = kind.children
        below = []
        for child in node.iterchildren("*"):
            if child.tag in known:
                below.append((child, known[child.tag]))
            else:
                yield _Fault(child)
        if len(below) > 1 and kind is not GRAMMAR.root:  # MuJoCo joins sections, however many there are
            yield from _too_many(node, below)
        waiting += reversed(below)


def _of_attributes(node: Node, kind: ElementType) -> Iterator[_Fault]:
    known = kind.attributes
    for name, value in node.items():
        attribute = known.get(str(name))
        if attribute is None:
            is_newer = _installed() > version_key(GRAMMAR.versions[-1])  # and may have attributes that ours does not
            if name not in kind.ignored and not is_newer:
                yield _Fault(node, name=str(name), key=True, repaired={str(name): None})
        elif node.tag == "size" and name in ROOM and not value.strip():
            # MuJoCo 4.0 ignores blanks instead of numbers, except in these attributes.
            yield _malformed(node, attribute, Refusal("is empty"))
        elif attribute.type not in _FREE and not _is_plain(attribute, str(value)):
            refusal = check_value(attribute, str(value))
            if refusal is not None:
                yield _malformed(node, attribute, refusal)


def _malformed(node: Node, attribute: Attribute, refusal: Refusal) -> _Fault:
    name = attribute.name
    code = "wrong-keyword" if attribute.type in ("keyword", "keywords") else "wrong-type"
    message = f"`{name}` of `<{node.tag}>` {refusal.message}"
    return _Fault(node, code, message, help=refusal.advice, name=name, repaired={name: _sample(attribute)})


def _is_checked(node: Node) -> bool:
    """Return whether MuJoCo (3.12 to 4.0) checks the rules for an element of a body: not in a frame."""
    around = {str(each.tag) for each in node.iterancestors()}
    return "worldbody" in around and around.isdisjoint(BLIND)


def _of_constraints(node: Node, kind: ElementType) -> Iterator[_Fault]:
    """Yield attributes that exclude one another. The reader determines which of them counts."""
    for rule in kind.constraints:
        names = [name for (name,) in rule.bundles if name in node.attrib] if rule.kind == "exclusive" else []
        if len(names) > 1:
            *others, last = (f"`{name}`" for name in names)
            message = f"`<{node.tag}>` has {', '.join(others)} and {last}, and MuJoCo takes only one of them"
            repaired = dict.fromkeys(names[1:])
            help = f"remove {last} or the other"
            yield _Fault(node, "wrong-length", message, help=help, name=names[-1], key=True, repaired=repaired)


def _of_name(node: Node, kind: ElementType) -> Iterator[_Fault]:
    """Yield names that MuJoCo reserves; adding a prefix would hide the error."""
    if kind.path == "body" and node.get("name") == "world":
        message = "a body cannot be called `world`, which is the name of the world itself"
        repaired = {"name": "another world"}
        yield _Fault(node, "bad-name", message, help="give it another name", name="name", repaired=repaired)
    elif kind.path == "default":
        parent = node.getparent()
        name = node.get("class")
        if parent is None or parent.tag == "default":
            if not name:
                message = "a default class inside another has no name"
                help = 'write `class="…"`'
                yield _Fault(node, "bad-name", message, help=help, name="class", repaired={"class": "another class"})
        elif name not in (None, "", "main"):
            message = f"a default class at the top must be called `main`, got `{name}`"
            help = f'put it into one: `<default><default class="{name}">`'
            yield _Fault(node, "bad-name", message, help=help, name="class", repaired={"class": MAIN})


@cache
def _installed() -> tuple[int, ...]:
    from importlib import metadata  # few models have an attribute that is not known

    try:
        return version_key(metadata.version("mujoco"))
    except metadata.PackageNotFoundError:
        return ()


def _is_plain(attribute: Attribute, value: str) -> bool:
    if attribute.type != "real" or attribute.lengths is not None or not _PLAIN.fullmatch(value):
        return False
    parts = value.split(" ")
    try:
        list(map(float, parts))
    except ValueError:
        return False
    low = attribute.min_length
    high = attribute.max_length
    return (low or 0) <= len(parts) and (high is None or len(parts) <= high)


def _too_many(parent: Node, children: list[tuple[Node, ElementType]]) -> Iterator[_Fault]:
    counts: Counter[str] = Counter()
    for child, kind in children:
        counts[kind.tag] += 1
        if kind.max_count is not None and counts[kind.tag] > kind.max_count:
            most = "one" if kind.max_count == 1 else str(kind.max_count)
            message = f"MuJoCo takes {most} `<{child.tag}>` in `<{parent.tag}>`, and this is another one"
            yield _Fault(child, "wrong-length", message, help="join them, or remove one")


def _sample(attribute: Attribute) -> str:
    """Return a valid value of an attribute.

    >>> _sample(GRAMMAR.element("geom").attributes["pos"])
    '1 1 1'
    """
    if attribute.type == "bool":
        return "true"
    if attribute.keywords:
        return attribute.keywords[0]
    count = attribute.lengths[0] if attribute.lengths else attribute.min_length or 1
    return "xyz"[:count] if attribute.type == "chars" else " ".join(["1"] * count)
