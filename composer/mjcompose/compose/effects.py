"""Values of the recipe that change nothing: edits, draws and additions whose number MuJoCo does not use.

Each is noted where it is written. On the finished model, an entry is reported if none of its elements uses the value.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import field

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.words import element_text
from mjcompose.link import numbers
from mjcompose.link.inertia import has_mass
from mjcompose.tree.classes import Classes, levels, own, text_in_effect
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.select import kind_of, name_of, section_of
from mjcompose.tree.unit import Origins, RecipeValue, Unit

CODE = "without-effect"
_SWITCHES = {
    ("joint", "range"): "limited",
    ("joint", "actuatorfrcrange"): "actuatorfrclimited",
    ("tendon", "range"): "limited",
    ("actuator", "ctrlrange"): "ctrllimited",
    ("actuator", "forcerange"): "forcelimited",
    ("actuator", "actrange"): "actlimited",
}
_OF_CONTACTS = ("friction", "condim", "solref", "solimp", "solmix", "margin", "gap", "priority")
_OF_MASS = ("mass", "density")
_REFERENCES = {("joint", "springref"): "stiffness", ("tendon", "springlength"): "stiffness"}


_KNOWN = frozenset((*(name for _, name in _SWITCHES), *(name for _, name in _REFERENCES), *_OF_CONTACTS, *_OF_MASS))


class NoEffect(Struct):
    """Why a value has no effect, the element that decides it, and what to write instead."""

    why: str
    element: Node | None = None
    help: str | None = None


class _Rules(Struct):
    """The rules by which MuJoCo ignores a value, on one model."""

    unit: Unit
    paired: frozenset[str]
    counts: dict[tuple[str, str], Mapping[Node, tuple[int, int]]] = field(default_factory=dict)

    @property
    def classes(self) -> Classes:
        return self.unit.classes

    def effective(self, node: Node, name: str) -> str | None:
        return text_in_effect(node, kind_of(node), name, classes=self.classes)

    def reason(self, node: Node, attribute: str) -> NoEffect | None:
        """Return why an attribute of an element has no effect; None if it has one, or if nobody knows."""
        if section_of(node) == "default":
            return self._of_class(node, attribute)
        section = section_of(node)
        family = section if section in ("actuator", "tendon") else node.tag
        if (switch := _SWITCHES.get((str(family), attribute))) is not None:
            return self._of_switch(node, switch)
        if (needs := _REFERENCES.get((str(family), attribute))) is not None:
            return self._of_spring(node, needs)
        if node.tag == "geom" and attribute in _OF_MASS:
            return self._of_mass(node, attribute)
        if node.tag == "geom" and attribute in _OF_CONTACTS:
            return self._of_contacts(node)
        if node.tag == "inertial":
            return self._of_inertial(node)
        return None

    def _of_switch(self, node: Node, switch: str) -> NoEffect | None:
        if self.effective(node, switch) != "false":
            return None
        return NoEffect(f"`{switch}` is false", help=f"write `{switch}: true` next to it")

    def _of_spring(self, node: Node, needs: str) -> NoEffect | None:
        if any(numbers.read(self.effective(node, needs) or "0")):
            return None
        return NoEffect(f"its `{needs}` is 0", help=f"write its `{needs}`, too")

    def _of_mass(self, geom: Node, attribute: str) -> NoEffect | None:
        body = _body_of(geom)
        if body is not None and self.unit.settings.inertiafromgeom != "true" and (inertials := own(body, "inertial")):
            called = f"`{name_of(body)}`" if name_of(body) else "its body"
            return NoEffect(
                f"{called} has an `<inertial>`, which holds instead of the masses of its geoms",
                inertials[-1],
                _own_body(geom),
            )
        mass = self.effective(geom, "mass")
        if attribute == "density" and mass is not None and not math.isnan(numbers.first(mass)):
            return NoEffect("the geom has a `mass`, which holds instead", help="change its `mass`")
        return None

    def _of_inertial(self, inertial: Node) -> NoEffect | None:
        body = _body_of(inertial)
        if body is None or self.unit.settings.inertiafromgeom != "true":
            return None
        if not any(has_mass(geom, self.classes) for geom in own(body, "geom")):
            return None
        why = "`inertiafromgeom` is true, so the geoms of its body hold instead"
        return NoEffect(why, help="write the mass of the body: `set: {mass: …}`")

    def _of_contacts(self, geom: Node) -> NoEffect | None:
        if str(geom.get("name") or "") in self.paired:
            return None
        bits = (self.effective(geom, name) or "1" for name in ("contype", "conaffinity"))
        if any(any(numbers.read(each)) for each in bits):
            return None
        return NoEffect("the geom collides with nothing: its `contype` and `conaffinity` are 0")

    def _of_class(self, setting: Node, attribute: str) -> NoEffect | None:
        """Return why a value of a class has no effect: every element of the class has a value of its own."""
        uses, takers = self._of_tag(str(setting.tag), attribute).get(setting, (0, 0))
        if takers:
            return None
        if not uses:
            default = setting.getparent()
            name = None if default is None else default.get("class")
            return NoEffect(f"no `{setting.tag}` has {f'the class `{name}`' if name else 'this class'}")
        why = "its only element writes its own" if uses == 1 else f"all of its {uses} elements write their own"
        return NoEffect(why, help="change the elements, or remove their values: `set: {…: null}`")

    def _of_tag(self, tag: str, attribute: str) -> Mapping[Node, tuple[int, int]]:
        """Return for each setting of a class the number of elements that have it, and of those that take a value."""
        key = (tag, attribute)
        if key not in self.counts:
            found: dict[Node, tuple[int, int]] = {}
            for element in self._elements(tag):
                kind = kind_of(element)
                if (known := kind.attributes.get(attribute)) is None:
                    continue
                for step in levels(element, kind, known, classes=self.classes):
                    if step.kind == "class" and step.writer is not None:
                        uses, takers = found.get(step.writer, (0, 0))
                        found[step.writer] = (uses + 1, takers + bool(step.taken))
            self.counts[key] = found
        return self.counts[key]

    def _elements(self, tag: str) -> Iterator[Node]:
        family = _ACTUATORS if tag in _ACTUATORS else {tag}
        for section in self.unit.root.iterchildren("*"):
            if section.tag != "default":
                yield from section.iter(*family)


def _own_body(geom: Node) -> str:
    """Return what to write for the mass of a geom to count."""
    name = name_of(geom) or "payload"
    body = f"`body: {{name: {name}, geom: {{…}}}}`"
    return f"put the geom into a body of its own, {body}, or write the mass of the whole body: `set: {{mass: …}}`"


_ACTUATORS = frozenset(GRAMMAR.section("actuator").children)


def _body_of(element: Node) -> Node | None:
    return next(element.iterancestors("body"), None)


def note_added(geoms: Iterable[Node], span_of: Callable[[Node, str], Span], origins: Origins) -> None:
    """Note the masses of the geoms that the recipe adds."""
    for geom in geoms:
        for name in _OF_MASS:
            text = geom.get(name)
            if text and any(numbers.read(text)) and may_be_idle(geom, name):
                origins.values.setdefault(geom, []).append(RecipeValue(name, span_of(geom, name), "add"))


def may_be_idle(node: Node, attribute: str) -> bool:
    """Return whether a value may have no effect. The linker later writes inertias that a mass has decided."""
    if section_of(node) == "default" or node.tag == "inertial":
        return True
    if attribute not in _KNOWN:
        return False
    if node.tag != "geom" or attribute != "mass":
        return True
    body = _body_of(node)
    return body is not None and bool(own(body, "inertial"))


def report_without_effect(unit: Unit, sink: Sink) -> None:
    """Warn about each entry whose value has no effect on any of the elements that it changes."""
    pairs = unit.root.iterfind("contact/pair")
    paired = frozenset(str(pair.get(end)) for pair in pairs for end in ("geom1", "geom2"))
    rules = _Rules(unit, paired)
    entries: dict[tuple[Span, str], list[Node]] = {}
    for node, values in unit.origins.values.items():
        if node.getroottree().getroot() is unit.root:
            for value in values:
                entries.setdefault((value.span, value.attribute), []).append(node)
    for (span, attribute), nodes in entries.items():
        reasons = [rules.reason(node, attribute) for node in nodes]
        if reasons and all(reason is not None for reason in reasons):
            _report(unit, sink, span, attribute=attribute, nodes=nodes, reasons=[each for each in reasons if each])


def _report(unit: Unit, sink: Sink, span: Span, attribute: str, nodes: list[Node], reasons: Iterable[NoEffect]) -> None:
    first = next(iter(reasons))
    node = nodes[0]
    name = name_of(node)
    if section_of(node) == "default":
        whose = "the class"
    elif len(nodes) > 1:
        whose = f"these {len(nodes)} elements"
    else:
        whose = element_text(str(node.tag), name)
    message = f"`{attribute}` of {whose} has no effect: {first.why}"
    notes = []
    if first.element is not None:
        notes.append(Note("it is written here", unit.origins.span(first.element, unit.file)))
    sink.warning(CODE, message, span, notes=notes, help=first.help)
