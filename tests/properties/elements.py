"""Random MJCF elements, built from the grammar: what an attribute takes decides what is drawn for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from random import Random
from typing import TypeVar

from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType

T = TypeVar("T")

# Drawn by those who know what fits, or of no use in a model without files.
NEVER = frozenset(
    {
        "sleep",
        "dampratio",
        "file",
        "name",
        "class",
        "childclass",
        "plugin",
        "instance",
        "content_type",
        "prefix",
        "mocap",
    }
)


@dataclass
class Maker:
    """Draws elements that may refer to what is declared so far.

    `optional` has the attributes of each element that the model could do without.
    """

    random: Random
    version: str
    declared: dict[str, list[str]] = field(default_factory=dict)
    optional: dict[Node, list[str]] = field(default_factory=dict)
    degrees: bool = True
    count: int = 0

    def chance(self, percent: int) -> bool:
        return self.random.random() * 100 < percent

    def pick(self, values: Sequence[T]) -> T:
        return self.random.choice(values)

    def some(self, values: Sequence[T], most: int, least: int = 0) -> list[T]:
        """Some of the values, in any order."""
        most = min(most, len(values))
        return self.random.sample(values, self.random.randint(min(least, most), most))

    def number(self, low: float, high: float) -> float:
        """In steps of a thousandth of the range."""
        return float(f"{low + self.random.randint(0, 1000) * (high - low) / 1000:.6g}")

    def numbers(self, count: int, low: float, high: float) -> str:
        return " ".join(f"{self.number(low, high):g}" for _ in range(count))

    def declare(self, namespace: str, stem: str) -> str:
        """A new name. Other models take the same ones, so that only a prefix keeps them apart."""
        names = self.declared.setdefault(namespace, [])
        name = f"{stem}{len(names)}"
        names.append(name)
        return name

    def known(self, namespace: str) -> list[str]:
        return self.declared.get(namespace, [])

    def fill(self, node: Node, kind: ElementType, most: int, leave: Sequence[str] = ()) -> bool:
        """Write what is required and at most `most` other attributes; False where it is not to be had."""
        known = {name: each for name, each in kind.attributes.items() if each.exists_in(self.version)}
        free = [name for name in known if name not in NEVER and name not in leave and name not in node.attrib]
        drawn = self.some(free, most)
        required = [name for name, each in known.items() if each.required and name not in node.attrib]
        for name in dict.fromkeys([*required, *drawn]):
            value = self.value(known[name], node)
            if value is not None:
                node.set(name, value)
        self._obey(node, kind)
        self.optional.setdefault(node, []).extend(
            name for name in drawn if name in node.attrib and name not in required
        )
        return self._complete(node, kind)

    def value(self, attribute: Attribute, node: Node) -> str | None:
        match attribute.type:
            case "reference":
                namespace = attribute.refers
                if attribute.refers_by:
                    namespace = GRAMMAR.objtypes.get(str(node.get(attribute.refers_by)))
                names = self.known(namespace or "")
                if namespace == "body" and self.chance(10):
                    return "world"
                return self.pick(names) if names else None
            case "references":
                return None
            case "bool":
                return self.pick(("true", "false"))
            case "keyword":
                return self.pick(attribute.keywords)
            case "keywords":
                return self.pick(attribute.keywords)
            case "int":
                low = 0 if attribute.name in ("group", "condim", "priority") else 1
                return " ".join(str(self.random.randint(low, 4)) for _ in range(self._length(attribute)))
            case "real":
                return self._real(attribute)
            case "string" | "chars" | "name":
                return None
            case _:
                return None

    def _length(self, attribute: Attribute) -> int:
        if attribute.lengths:
            return self.pick(attribute.lengths)
        low = attribute.min_length or 1
        high = attribute.max_length or 3
        return low if self.chance(20) else min(high, max(low, 8))

    def _real(self, attribute: Attribute) -> str:
        count = self._length(attribute)
        name = attribute.name
        if attribute.angle == "orientation-euler":
            return self.numbers(3, -170, 170) if self.degrees else self.numbers(3, -3, 3)
        if attribute.angle == "orientation-axisangle":
            return (
                self.numbers(3, 0.1, 1) + " " + (self.numbers(1, -170, 170) if self.degrees else self.numbers(1, -3, 3))
            )
        if name in ("quat", "zaxis", "xyaxes"):
            return (
                self.numbers(count, 0.1, 1)
                if name != "xyaxes"
                else self.numbers(3, 0.5, 1) + " " + self.numbers(3, -1, -0.2)
            )
        if name.endswith("range") and count == 2:
            scale = 40 if attribute.angle == "joint" and self.degrees else 1
            low = self.number(-scale, 0)
            high = self.number(0.1 * scale, scale)
            if name == "forcerange" or not self.chance(8):
                return f"{low:g} {high:g}"
            return f"{high:g} {low:g}"  # no range at all
        if attribute.angle == "joint" and self.degrees:
            return self.numbers(count, -30, 30)
        if name == "biasprm":  # above zero the third is a damping ratio, which the whole model decides
            return self.numbers(count, -1, -0.05)
        if name == "pos":
            return self.numbers(count, -1, 1)
        return self.numbers(count, 0.05, 1)

    def _obey(self, node: Node, kind: ElementType) -> None:
        """Take out what the grammar's rules do not allow beside the rest."""
        for rule in kind.constraints:
            present = [bundle for bundle in rule.bundles if any(name in node.attrib for name in bundle)]
            if rule.kind == "exclusive" and len(present) > 1:
                kept = self.pick(present)
                for name in {each for bundle in present for each in bundle} - set(kept):
                    node.attrib.pop(name, None)
            elif rule.kind == "together" and 0 < len(present) < len(rule.bundles):
                for bundle in present:
                    for name in bundle:
                        node.attrib.pop(name, None)

    def _complete(self, node: Node, kind: ElementType) -> bool:
        for rule in kind.constraints:
            if rule.kind == "oneof" and not any(all(name in node.attrib for name in bundle) for bundle in rule.bundles):
                self._obtain(node, kind, rule.bundles)
                if not any(all(name in node.attrib for name in bundle) for bundle in rule.bundles):
                    return False
        return all(name in node.attrib for name, each in kind.attributes.items() if each.required)

    def _obtain(self, node: Node, kind: ElementType, bundles: Sequence[Sequence[str]]) -> None:
        for name in self.pick(bundles):
            attribute = kind.attributes[name]
            value = self.value(attribute, node)
            if value is not None:
                node.set(name, value)
                for rule in kind.constraints:
                    if rule.kind == "exclusive":
                        others = [bundle for bundle in rule.bundles if name not in bundle]
                        for other in (each for bundle in others for each in bundle):
                            if other not in self.pick(bundles):
                                node.attrib.pop(other, None)


def element(parent: Node, tag: str, **attributes: str) -> Node:
    return etree.SubElement(parent, tag, {name.rstrip("_"): value for name, value in attributes.items()})
