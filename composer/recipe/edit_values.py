"""The values of an edit, checked by the grammar before anything is built, as far as the selector's tag tells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from composer.diagnostics.suggest import closest, exists_note
from composer.expr.angle import Angle
from composer.expr.opening import is_template
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.grammar.element import ElementType
from composer.recipe.angles import bare_angle
from composer.recipe.fault import EXCLUSIVE, Fault, Path, Remark
from composer.recipe.placing import ORIENTATIONS
from composer.recipe.select import check_template, kinds_of, unknown_attribute
from composer.recipe.shown import kind_of
from composer.recipe.subscript import attribute_and_index
from composer.recipe.value import read_value
from composer.tree.selector import Selector

VERBS = ("unset", "set", "scale", "offset", "convert", "move", "rename")
MASS = "mass"
CONVERTIBLE = ("general", "motor", "pid", "position", "velocity")
FROM = "from-"


@dataclass(slots=True)
class Checker:
    """Checks what stands behind a verb. `bare_angles`: angles without a unit may stand."""

    bare_angles: bool
    faults: list[Fault]

    def verb(self, name: str, value: Any, selector: Selector | None, at: Path) -> Any:
        """The value as `Edit` keeps it; what is wrong goes to the faults."""
        kinds = () if selector is None else kinds_of(selector.tag)
        if name == "unset":
            return self._unset(value, kinds, selector, at)
        if name == "rename":
            return self._rename(value, at)
        if not isinstance(value, dict) or not value:
            example = {"convert": "{to: motor}", "move": "{to: NAME}"}.get(name, "{ATTRIBUTE: VALUE}")
            message = f"`{name}` expects a mapping, got {kind_of(value) if value != {} else 'an empty one'}"
            self.faults.append(Fault("wrong-type", message, at, help=f"write `{name}: {example}`"))
            return {}
        if name == "convert":
            return self._convert(value, kinds, selector, at)
        if name == "move":
            return self._move(value, kinds, selector, at)
        self._attributes(name, value, kinds, selector.tag if selector else "", at)
        return dict(value)

    # -- set, scale and offset ---------------------------------------------------------------------------------

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
                self._attributes(verb, item, below, name, path)
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
                self.faults.append(self._unknown(attribute, tag, kinds, path))
                continue
            self._value(verb, fitting, index, item, tag, path)

    def _unknown(self, name: str, tag: str, kinds: tuple[ElementType, ...], at: Path) -> Fault:
        if all(kind.path == "default" or kind.tag == "default" for kind in kinds):
            known = [child for child in kinds[0].children if child != "default"]
            near = closest(name, known)
            help = f"write the tag first: `{{{near[0] if near and name in known else 'geom'}: {{…}}}}`"
            message = f"`{name}` is not a tag that a class can have settings for"
            return Fault("unknown-element", message, at, key=True, help=help)
        return unknown_attribute(name, tag, kinds, at)

    def _value(
        self, verb: str, fitting: list[Attribute], index: int | None, value: Any, tag: str, at: Path
    ) -> None:
        subject = f"`{tag}`"
        if not self._templates(value, at):
            return
        if index is not None or verb != "set":
            self._arithmetic(verb, fitting, index, value, tag, at)
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
            read = read_value(attribute, sample, at, subject, found)
            if read is not None and not found and sample == value and not self.bare_angles:
                bare = bare_angle(attribute, read, None, at, subject)
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
        """Whether every `${…}` has a form that can be evaluated."""
        if isinstance(value, list):
            sound = [self._templates(item, (*at, index)) for index, item in enumerate(value)]
            return all(sound)
        if isinstance(value, str) and is_template(value):
            return check_template(value, at, self.faults) is not None
        return True

    # -- the other verbs ---------------------------------------------------------------------------------------

    def _unset(self, value: Any, kinds: tuple[ElementType, ...], selector: Selector | None, at: Path) -> Any:
        tag = selector.tag if selector else ""
        if isinstance(value, dict) and tag == "default":
            found: dict[str, tuple[str, ...]] = {}
            for name, items in value.items():
                below = tuple(kind.children[name] for kind in kinds if name in kind.children)
                if not below:
                    self.faults.append(self._unknown(name, tag, kinds, (*at, name)))
                found[name] = self._list(items, below, name, (*at, name))
            return found
        return self._list(value, kinds, tag, at)

    def _list(self, value: Any, kinds: tuple[ElementType, ...], tag: str, at: Path) -> tuple[str, ...]:
        if not isinstance(value, list) or not value or not all(isinstance(item, str) for item in value):
            help = f"write `unset: [{value}]`" if isinstance(value, str) else "write `unset: [ATTRIBUTE]`"
            if tag == "default":
                help = "write `unset: {geom: [ATTRIBUTE]}`"
            got = "an empty list" if value == [] else kind_of(value)
            message = f"`unset` expects a list of attributes, got {got}"
            self.faults.append(Fault("wrong-type", message, at, help=help))
            return ()
        for index, name in enumerate(value):
            fitting = [kind.attributes[name] for kind in kinds if name in kind.attributes]
            if name == "name":
                message, help = "`unset` cannot take a name away", "write `rename: …` for another name"
                self.faults.append(Fault("unknown-key", message, (*at, index), help=help))
            elif kinds and not fitting:
                fault = self._unknown(name, tag, kinds, (*at, index))
                self.faults.append(Fault(fault.code, fault.message, fault.at, remarks=fault.remarks,
                                         help=fault.help))  # fmt: skip
            elif fitting and all(attribute.required for attribute in fitting):
                message = f"`{name}` of `{tag}` must be there"
                self.faults.append(
                    Fault("missing-key", message, (*at, index), help="write another value with `set`")
                )
        return tuple(value)

    def _rename(self, value: Any, at: Path) -> str | None:
        if isinstance(value, str) and value:
            check_template(value, at, self.faults)
            return value
        help = 'write `rename: "${name}_left"`, with `${name}`, `${parent}` or `${index}` where there are several'
        message = f"`rename` expects the new name, got {kind_of(value) if value != '' else 'empty text'}"
        self.faults.append(Fault("wrong-type", message, at, help=help))
        return None

    def _convert(
        self, value: dict[str, Any], kinds: tuple[ElementType, ...], selector: Selector | None, at: Path
    ) -> dict[str, Any]:
        if kinds and not any(kind.path.startswith("actuator/") for kind in kinds):
            tag = selector.tag if selector else ""
            self.faults.append(Fault("wrong-type", f"`convert` is for actuators, and `{tag}` is not one", at))
            return {}
        to = value.get("to")
        if to not in CONVERTIBLE:
            self.faults.append(_no_target(to, at, "to" in value))
            return {}
        kind = GRAMMAR.element(f"actuator/{to}")
        for name, item in value.items():
            path = (*at, name)
            if name == "to":
                continue
            if name not in kind.attributes or name == "name":
                self.faults.append(unknown_attribute(name, str(to), (kind,), path))
            elif isinstance(item, str) and item.startswith(FROM):
                source = item.removeprefix(FROM)
                if source not in GRAMMAR.element("actuator/general").attributes:
                    help = "write for instance `ctrlrange: from-forcerange`"
                    message = f"`{item}` names no attribute of an actuator"
                    self.faults.append(Fault("unknown-attribute", message, path, help=help))
            else:
                self._value("set", [kind.attributes[name]], None, item, str(to), path)
        return dict(value)

    def _move(
        self, value: dict[str, Any], kinds: tuple[ElementType, ...], selector: Selector | None, at: Path
    ) -> dict[str, Any]:
        tag = selector.tag if selector else ""
        inside = {path for top in ("body", "worldbody") for path in _paths(GRAMMAR.element(top))}
        if kinds and not any(kind.path in inside for kind in kinds):
            self.faults.append(
                Fault("wrong-type", f"`move` is for the body tree, and `{tag}` is not in it", at)
            )
            return {}
        to = value.get("to")
        if isinstance(to, dict):
            to = to.get("frame") if list(to) == ["frame"] else None
        if not isinstance(to, str) or not to:
            help = "write `to: NAME` of a body, `to: world`, or `to: {frame: NAME}`"
            message = (
                "`move` lacks `to`"
                if "to" not in value
                else f"`to` expects a name, got {kind_of(value['to'])}"
            )
            code = "missing-key" if "to" not in value else "wrong-type"
            self.faults.append(Fault(code, message, (*at, "to") if "to" in value else at, help=help))
        pose = {name: item for name, item in value.items() if name != "to"}
        for name in [name for name in pose if name not in ("pos", *ORIENTATIONS)]:
            near = closest(name, ("to", "pos", *ORIENTATIONS))
            remark = Remark(exists_note("key", ("to", "pos", *ORIENTATIONS), name).message)
            self.faults.append(Fault("unknown-key", f"`{name}` is not a key of `move`", (*at, name), key=True,
                                     remarks=(remark,), help=f"write `{near[0]}`" if near else None))  # fmt: skip
            del pose[name]
        self._attributes("set", pose, kinds, tag, at)
        return dict(value)


def _paths(kind: ElementType) -> list[str]:
    return [child.path for child in kind.children.values()]


def _no_target(to: Any, at: Path, written: bool) -> Fault:
    known = ", ".join(f"`{name}`" for name in CONVERTIBLE)
    if not written:
        return Fault("missing-key", "`convert` lacks `to`", at, help=f"write `to:` and one of {known}")
    near = closest(str(to), CONVERTIBLE)
    remark = Remark(exists_note("kind", CONVERTIBLE, str(to)).message)
    return Fault(
        "wrong-keyword",
        f"an actuator cannot be converted to {kind_of(to)}",
        (*at, "to"),
        remarks=(remark,),
        help=f"write `to: {near[0]}`" if near else None,
    )


def _sample(attribute: Attribute, value: Any) -> Any:
    """A value of the same form without `${…}`; None where only the model can tell whether it fits."""
    if isinstance(value, list):
        items = [1 if _computed(item) and attribute.is_number else item for item in value]
        return None if any(map(_computed, items)) else items
    return None if _computed(value) else value


def _computed(value: Any) -> bool:
    return isinstance(value, str) and is_template(value)
