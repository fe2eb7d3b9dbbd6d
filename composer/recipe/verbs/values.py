"""Check the values of attributes by the grammar before anything is built, as far as the selector's tag allows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest
from composer.expr.angle import Angle
from composer.expr.opening import is_template
from composer.grammar.attribute import Attribute
from composer.grammar.element import ElementType
from composer.recipe.angles import bare_angle
from composer.recipe.fault import EXCLUSIVE, Fault, Path
from composer.recipe.placing import ORIENTATIONS
from composer.recipe.select import check_template, kinds_of, unknown_attribute
from composer.recipe.shown import kind_of
from composer.recipe.subscript import attribute_and_index
from composer.recipe.value import read_value
from composer.tree.selector import Selector

MASS = "mass"


@dataclass(slots=True)
class Checker:
    """Checks the values of `set`, `scale` and `offset`. With `bare_angles`, angles without a unit are allowed."""

    bare_angles: bool
    faults: list[Fault]

    def attributes(self, verb: str, value: Mapping[str, Any], selector: Selector | None, at: Path) -> None:
        """Check the mapping that `set`, `scale` or `offset` is given."""
        kinds = () if selector is None else kinds_of(selector.tag)
        self._attributes(verb, value, kinds, tag=selector.tag if selector else "", at=at)

    def _attributes(
        self, verb: str, value: Mapping[str, Any], kinds: tuple[ElementType, ...], tag: str, at: Path
    ) -> None:
        turned = [name for name in value if name in ORIENTATIONS]
        if len(turned) > 1 and verb == "set":
            message = f"`{tag}` can have one orientation, and there are `{turned[0]}` and `{turned[1]}`"
            self.faults.append(Fault(EXCLUSIVE, message, (*at, turned[1]), key=True,
                                     help=f"leave `{turned[0]}` or `{turned[1]}` out"))  # fmt: skip
        for name, item in value.items():
            path = (*at, name)
            below = tuple(kind.children[name] for kind in kinds if name in kind.children)
            if isinstance(item, dict) and (below or not kinds):
                self._attributes(verb, item, below, tag=name, at=path)
                continue
            attribute, index = attribute_and_index(name)
            if any(kind.path == "body" for kind in kinds) and name == MASS:
                self._number(item, f"`{MASS}` of `body`", path)
                continue
            if attribute == "name" and kinds and kinds[0].path != "default":
                self.faults.append(Fault("unknown-key", f"`{verb}` cannot change a name", path, key=True,
                                         help="write `rename: …`, which every reference follows"))  # fmt: skip
                continue
            fitting = [kind.attributes[attribute] for kind in kinds if attribute in kind.attributes]
            if kinds and not fitting:
                self.faults.append(self.unknown(attribute, tag, kinds, at=path))
                continue
            self.value(verb, fitting, index, value=item, tag=tag, at=path)

    def unknown(self, name: str, tag: str, kinds: tuple[ElementType, ...], at: Path) -> Fault:
        """Return the fault of a name that is not an attribute of what is selected."""
        if all(kind.path == "default" or kind.tag == "default" for kind in kinds):
            known = [child for child in kinds[0].children if child != "default"]
            near = closest(name, known)
            help = f"write the tag first: `{{{near[0] if near and name in known else 'geom'}: {{…}}}}`"
            message = f"`{name}` is not a tag that a class can have settings for"
            return Fault("unknown-element", message, at, key=True, help=help)
        return unknown_attribute(name, tag, kinds, at=at)

    def value(
        self, verb: str, fitting: list[Attribute], index: int | None, value: Any, tag: str, at: Path
    ) -> None:
        """Check the value of one attribute, or of one of its numbers."""
        subject = f"`{tag}`"
        if not self._templates(value, at):
            return
        if index is not None or verb != "set":
            self._arithmetic(verb, fitting, index, value=value, tag=tag, at=at)
            return
        if isinstance(value, dict):
            self.faults.append(
                Fault("wrong-type", f"`{at[-1]}` of {subject} expects a value, got a mapping", at)
            )
            return
        tried: list[list[Fault]] = []
        for attribute in fitting:
            sample = _sample(attribute, value)
            if sample is None:
                return
            found: list[Fault] = []
            read = read_value(attribute, sample, at, owner=subject, faults=found)
            if read is not None and not found and sample == value and not self.bare_angles:
                bare = bare_angle(attribute, read, None, at=at, owner=subject)
                found += [bare] if bare is not None else []
            if not found:
                return
            tried.append(found)
        self.faults += tried[0] if tried else []

    def _arithmetic(
        self, verb: str, fitting: list[Attribute], index: int | None, value: Any, tag: str, at: Path
    ) -> None:
        subject = f"`{at[-1]}` of `{tag}`"
        numeric = [each for each in fitting if each.is_number]
        if fitting and not numeric:
            message = f"{subject} is not a number, which `{verb}` needs"
            if index is not None:
                message = f"`{fitting[0].name}` of `{tag}` has no numbers that could be counted"
            self.faults.append(Fault("wrong-type", message, at, key=True))
            return
        lengths = [each.max_length for each in numeric]
        if index is not None and numeric and all(most is not None and index >= most for most in lengths):
            most = max(each for each in lengths if each is not None)
            message = f"{subject} does not exist: `{numeric[0].name}` has {most} number{'s' * (most != 1)}"
            self.faults.append(Fault("wrong-length", message, at, key=True, help="the first number is `[0]`"))
            return
        if isinstance(value, list) and index is None:
            if numeric and all(most is not None and len(value) > most for most in lengths):
                message = f"{subject} has {max(filter(None, lengths))} numbers, got {len(value)}"
                self.faults.append(Fault("wrong-length", message, at))
            for position, item in enumerate(value):
                self._number(item, subject, (*at, position), angle=verb != "scale")
            return
        self._number(value, subject, at, angle=verb != "scale")

    def _number(self, value: Any, subject: str, at: Path, angle: bool = False) -> None:
        if isinstance(value, str) and is_template(value):
            check_template(value, at, self.faults)
            return
        if isinstance(value, str) and angle and Angle.read(value) is not None:
            return
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.faults.append(Fault("wrong-type", f"{subject} expects a number, got {kind_of(value)}", at))

    def _templates(self, value: Any, at: Path) -> bool:
        """Return whether every `${…}` can be parsed."""
        if isinstance(value, list):
            sound = [self._templates(item, (*at, index)) for index, item in enumerate(value)]
            return all(sound)
        if isinstance(value, str) and is_template(value):
            return check_template(value, at, self.faults) is not None
        return True


def _sample(attribute: Attribute, value: Any) -> Any:
    """Return a value of the same form without `${…}`, or None if only the model shows whether it fits."""
    if isinstance(value, list):
        items = [1 if _computed(item) and attribute.is_number else item for item in value]
        return None if any(map(_computed, items)) else items
    return None if _computed(value) else value


def _computed(value: Any) -> bool:
    return isinstance(value, str) and is_template(value)
