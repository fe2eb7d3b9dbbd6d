"""Pass: add the part's prefix to every name of a part and to every reference."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.suggest import closest, unknown_name
from mjcompose.link.corrections import added_again, keep_first, without_reference
from mjcompose.link.linking import Linking, Part
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN
from mjcompose.tree.files import NAMED_AFTER_FILE, stem
from mjcompose.tree.journal import Why, because, explained
from mjcompose.tree.names import (
    DECLARES,
    GENERATES,
    LISTS,
    REFERS,
    REFERS_BY,
    WORLD,
    may_be_generated,
    naming_table,
    object_namespace,
    users,
    word,
)
from mjcompose.tree.select import section_of
from mjcompose.tree.unit import Unit, line_of


class _Clash(Struct):
    """A name that two elements declare; `earlier` is the first of them."""

    namespace: str
    name: str
    element: Node
    earlier: Node

    @property
    def code(self) -> str:
        return "class-clash" if self.namespace == "default" else "name-clash"


class _Dangling(NamedTuple):
    """A reference of an element to a name that its unit does not have; `own` are the names that it has."""

    namespace: str
    name: str
    element: Node
    own: Sequence[str]


def referring_attribute(element: Node, name: str) -> str | None:
    """Return the attribute of an element that refers to a name, alone or in a list."""
    return next((str(key) for key, value in element.items() if name in (value, *str(value).split())), None)


_MAY_REPEAT = ("model",)
_NOTHING: Mapping[str, str] = MappingProxyType({})


def names(linking: Linking) -> None:
    """Rename part by part; afterwards `linking.names` knows every name of the model."""
    renamings = [_UnitRenaming(linking, part) for part in (None, *linking.parts)]
    for renaming in renamings:
        renaming.run()
    for renaming in renamings:  # now all parts have the names that another one may refer to
        renaming.report_dangling()


class _UnitRenaming:
    def __init__(self, linking: Linking, part: Part | None) -> None:
        self.linking = linking
        self.part = part
        self.unit = linking.base if part is None else part.unit
        self.prefix = "" if part is None else part.prefix
        self.dangling: list[_Dangling] = []

    def run(self) -> None:
        part = self.part
        unit = self.unit
        top_class = self.linking.top_class(unit)
        outward = part.outward if part else _NOTHING
        reasons = _Reasons(unit, part)
        with explained(reasons.with_prefix):
            found = rename(unit, self.prefix, top_class=top_class, outward=outward, reasons=reasons)
            self._refer_to_keys()
        for namespace, name, element in found.repeated:
            self._report_repeated(_Clash(namespace, name, element, earlier=found.declared[namespace][name]))
        for namespace, name, element in found.dangling():
            if not may_be_generated(name, unit.root):
                own = [each.removeprefix(self.prefix) for each in found.declared[namespace]]
                self.dangling.append(_Dangling(namespace, name, element, own))
        clashes = list(self._declare(found))
        if part is not None and clashes:
            self._report_clashes(part, clashes)

    def _declare(self, found: UnitNames) -> Iterator[_Clash]:
        """Add the unit's names to the model's names, and yield the names that the model already has."""
        known = self.linking.names.declared
        for namespace, declared in sorted(found.declared.items()):
            earlier = known.setdefault(namespace, declared) if declared else declared
            if earlier is declared:
                continue
            if namespace not in _MAY_REPEAT:
                for name in [name for name in declared if name in earlier]:
                    yield _Clash(namespace, name, declared[name], earlier=earlier[name])
                    declared[name] = earlier[name]  # the first one keeps it
            earlier.update(declared)

    def _refer_to_keys(self) -> None:
        request = self.linking.request
        unit = self.unit
        policy = request.base_keyframes if self.part is None else self.part.keyframes
        own = [str(key.get("name") or "") for key in unit.root.iterfind("keyframe/key")]
        for element in unit.root.iterfind("custom//element[@objtype='key']"):
            name = str(element.get("objname") or "")
            # A tuple of a key that is not in the model is an error: "unrecognized object 'k' in tuple 0" in MuJoCo 4.0.
            if name not in own and not may_be_generated(name, unit.root):
                self.dangling.append(_Dangling("key", name, element, own))
            elif name not in own or policy == "prefix":  # the former is of a model that MuJoCo attaches
                journal.write(element, "objname", self.prefix + name)
            elif policy == "none" and request.requested_keys is None:  # else the recipe may write it
                message = f"a tuple refers to the key `{name}`, which `drop: [key]` drops"
                help = "drop the tuple, too: `drop: [tuple]`"
                span = self.linking.span(unit, element, "objname")
                self.linking.sink.error("unknown-name", message, span, help=help, subjects=(name,))

    def report_dangling(self) -> None:
        """Report the names that the unit refers to and does not have."""
        for each in self.dangling:
            attribute = referring_attribute(each.element, each.name)
            shown = each.name if each.namespace == "key" else each.name.removeprefix(self.prefix)
            help = None
            if attribute is not None:
                help = self._help_outside(each, attribute, shown)
            found = unknown_name(
                word(each.namespace),
                shown,
                each.own,
                span=self.linking.span(self.unit, each.element, attribute),
                purpose=f", which `<{each.element.tag}>` refers to,",
                written=f'{attribute}="{{}}"' if attribute else "{}",
                help=help,
            )
            self.linking.sink.add(found)

    def _help_outside(self, dangling: _Dangling, attribute: str, shown: str) -> str | None:
        """Return how the recipe writes a reference to an element that another part has, or that none has."""
        removal = without_reference(dangling.element, attribute, dangling.namespace, self.prefix)
        if removal is None:
            return None
        in_part = f"write in its part of the recipe `{removal.text}`"
        known = self.linking.names.declared.get(dangling.namespace, {})
        final = [shown, *(part.prefix + shown for part in self.linking.parts if part is not self.part)]
        target = next((name for name in final if name in known), None)
        if target is None:
            return None if closest(shown, dangling.own) else in_part
        line = added_again(dangling.element, attribute, dangling.namespace, target, self.unit)
        section = section_of(dangling.element)
        again = f"the section `{'edit' if section == 'worldbody' else section}`" if line is None else f"`{line}`"
        return f"it is `{target}`, outside of the part: {in_part}\nand in the recipe itself {again}"

    def _report_repeated(self, clash: _Clash) -> None:
        name = clash.name.removeprefix(self.prefix)
        attribute = "name" if clash.namespace != "default" else "class"
        notes = (Note("the first one is here", self.linking.span(self.unit, clash.earlier)),)
        message = f"`{self.unit.file}` declares the {word(clash.namespace)} `{name}` twice"
        span = self.linking.span(self.unit, clash.element, attribute)
        first = keep_first(clash.element, name)
        help = None if first is None else f"to keep the first one, write in its part of the recipe `{first.text}`"
        self.linking.sink.error(clash.code, message, span, notes=notes, help=help, subjects=(name,))

    def _report_clashes(self, part: Part, clashes: Sequence[_Clash]) -> None:
        linking = self.linking
        first = min(clashes, key=lambda clash: line_of(clash.element) or 0)
        here = linking.span(part.unit, first.element)
        root = first.earlier.getroottree().getroot()
        there = linking.span(next((unit for unit in linking.units if unit.root is root), linking.base), first.earlier)
        count = len(clashes) - 1
        more = f"; {count} more of its names {'is' if count == 1 else 'are'} taken too" if count else ""
        notes = [Note("it is declared here first", there)]
        if part.span is not None and here != there:
            notes.insert(0, Note("the part declares it here", here))
        what = f"`{part.called}` brings the {word(first.namespace)} `{first.name}`"
        message = f"{what}, and the model already has this name{more}"
        subjects = (part.called, first.name)
        help = "give the part another prefix" if part.prefix else "give the part a prefix: omit `prefix`"
        linking.sink.error(first.code, message, part.span or here, notes=notes, help=help, subjects=subjects)


class _Reasons:
    """The reasons for new names in the unit of a part, or of the base, which has no part."""

    def __init__(self, unit: Unit, part: Part | None = None) -> None:
        self.with_prefix = self._of(part, "prefix of the part `{}`")
        self.in_list = self._of(part, "names with the prefix of the part `{}`")
        self.outside = self._of(part, "the element outside the part `{}` that it refers to")
        self.after_file = because("named after its file, with the prefix of the part", part.span if part else None)
        self.top_class = because(called_here(unit))

    @staticmethod
    def _of(part: Part | None, words: str) -> Why:
        return because("names of the base") if part is None else because(words.format(part.called), part.span)


def called_here(unit: Unit) -> str:
    """Return the words for a reference to the top class of a unit, which has another name in the model."""
    return f"the top class of {unit.file_name} is called that here"


class UnitNames:
    """The names of one unit by namespace, as the model has them, each with its first element.

    `declared` are the names of elements, and `referred` are the names that elements refer to. `repeated` has the
    elements that declare a name again. Names get the `prefix`, and `outward` has the names of elements outside the
    unit.
    """

    def __init__(self, prefix: str, outward: Mapping[str, str], reasons: _Reasons) -> None:
        self.prefix = prefix
        self.outward = outward
        self.reasons = reasons
        self.declared: defaultdict[str, dict[str, Node]] = defaultdict(dict)
        self.referred: defaultdict[str, dict[str, Node]] = defaultdict(dict)
        self.repeated: list[tuple[str, str, Node]] = []

    def declare(self, namespace: str, name: str, element: Node) -> None:
        if self.declared[namespace].setdefault(name, element) is not element and namespace not in _MAY_REPEAT:
            self.repeated.append((namespace, name, element))

    def dangling(self) -> Iterator[tuple[str, str, Node]]:
        for namespace, referred in sorted(self.referred.items()):
            declared = self.declared[namespace]
            yield from ((namespace, name, node) for name, node in referred.items() if name not in declared)

    def take(self, section: Node) -> None:
        """Rename everything in a section, and collect the names."""
        table = _actions(str(section.tag))
        prefix = self.prefix
        outward = self.outward
        # The references of a class need not exist.
        referred = defaultdict(dict) if section.tag == "default" else self.referred
        if table:
            for element in section.iterdescendants("*"):
                actions = table.get(element.tag)
                if actions is None:
                    continue
                items: list[tuple[str, str]] = element.items()  # type: ignore[assignment]  # of a parsed tree
                for key, value in items:
                    if key not in actions:
                        continue
                    kind, namespace = actions[key]
                    if kind not in (DECLARES, REFERS) or namespace == "key" or not value:
                        self._rename_special(element, key, value, action=(kind, namespace))
                        continue
                    if kind == REFERS and value in outward:
                        journal.write(element, key, outward[value], self.reasons.outside)
                        continue
                    if prefix:
                        value = prefix + value
                        journal.write(element, key, value)
                    if kind == DECLARES:
                        self.declare(namespace, value, element)
                    else:
                        referred[namespace].setdefault(value, element)

    def _rename_special(self, element: Node, key: str, value: str, *, action: tuple[int, str]) -> None:
        """Rename a value that is not a plain name: empty, a list, a prefix, a file, or a name typed by a sibling."""
        kind, namespace = action
        name = self.prefix + value
        why: Why | None = None
        if namespace == "key" or (not value and kind != GENERATES):
            return  # keys are named when they are laid out
        if kind == _NAMED_BY_FILE:
            # MuJoCo 4.0 takes the name from the file, without its last suffix: `<mesh file="x.y.obj"/>` is `x.y`.
            if not element.get("name"):
                name = self.prefix + stem(value)
                if self.prefix:
                    journal.write(element, "name", name, self.reasons.after_file)
                self.declare(str(element.tag), name, element)
            return
        if kind == LISTS:
            names = []
            for each in value.split():
                names.append(each if each == WORLD else self.outward.get(each, self.prefix + each))
                if each != WORLD and each not in self.outward:
                    self.referred[namespace].setdefault(self.prefix + each, element)
            name = " ".join(names)
            why = self.reasons.in_list if len(names) > 1 else None
        elif kind == REFERS_BY:
            target = object_namespace(element, namespace)
            if target == "key" or (value == WORLD and target in (None, "body")):
                return  # for keys see `_refer_to_keys`
            if value in self.outward:
                name = self.outward[value]
                why = self.reasons.outside
            elif target:
                self.referred[target].setdefault(name, element)
        if name != value:
            journal.write(element, key, name, why)


_NAMED_BY_FILE = -1
"""The action of the attribute `file` of an element that MuJoCo names after its file."""


@cache
def _actions(section: str) -> dict[str, dict[str, tuple[int, str]]]:
    """Return the naming table of a section, with the files that MuJoCo names elements after."""
    # All actuators share a namespace, joints and free joints do, frames and bodies do not. MuJoCo 4.0 calls
    # `<freejoint name="j"/>` next to `<joint name="j"/>` a repeated name.
    by_file = NAMED_AFTER_FILE if section in ("asset", "deformable") else ()
    return {
        tag: {**actions, "file": (_NAMED_BY_FILE, tag)} if tag in by_file else dict(actions)
        for tag, actions in naming_table(section).items()
    }


def rename(
    unit: Unit,
    prefix: str,
    *,
    top_class: str,
    outward: Mapping[str, str] = _NOTHING,
    reasons: _Reasons | None = None,
) -> UnitNames:
    """Prefix the names of a unit in place, in the only walk over every element of every part, and return them."""
    reasons = reasons or _Reasons(unit)
    names = UnitNames(prefix, outward, reasons)
    for section in unit.root.iterchildren("*"):
        names.take(section)
    # MuJoCo 4.0 refuses `<composite>`, which older models have; its `prefix` names the elements that it makes.
    if prefix:
        for composite in unit.root.iter("composite"):
            if "prefix" not in composite.attrib:
                journal.write(composite, "prefix", prefix)
    # No element declares these two. `world` is always the whole model's, and nothing else may have the name: `<body
    # name="world"/>` is a repeated name in MuJoCo 4.0. `main` is the unit's top class, which is wrapped.
    for namespace, reserved, final in (("body", WORLD, WORLD), ("default", MAIN, top_class)):
        name = prefix + reserved
        if names.referred[namespace].pop(name, None) is not None and name != final:
            for section in unit.root.iterchildren("*"):
                for element, key in users(section, namespace, name):
                    journal.write(element, key, final, reasons.top_class)
    return names
