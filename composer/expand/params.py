"""The section `params`: declared parameters and their values."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Mapping as Map
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note, renaming
from composer.diagnostics.unknown import unknown_key
from composer.document.node import Key, Mapping, Node, Scalar
from composer.expand.name import is_usable
from composer.expand.parameter import TYPES, Parameter, inferred
from composer.expand.plain import plain
from composer.expr.angle import UNITS, Angle
from composer.expr.opening import is_template
from composer.expr.value import Value

KEYS = {
    "type": "what kind of value it has; without it, that of the default",
    "default": "its value where none is given; without it, one must be given",
    "min": "the least that it, or a component of it, may be",
    "max": "the most that it, or a component of it, may be",
    "choices": "the values that it may have",
    "length": "how many numbers a vector has",
    "unit": "for readers; `deg` and `rad` make it an angle",
    "doc": "what it is for",
}
"""The keys of a parameter with their meaning, in the order in which `fmt` writes them."""


def read_params(node: Node | None, sink: Sink) -> dict[str, Parameter]:
    """Return the declared parameters, without faulty ones."""
    if node is None:
        return {}
    if not isinstance(node, Mapping):
        help = "write `params: {reach: {default: 0.45, unit: m}}`"
        sink.error("wrong-type", "`params` is a mapping from names to parameters", node.span, help=help)
        return {}
    found: dict[str, Parameter] = {}
    for key, value in node.entries.values():
        if is_usable(key, "a parameter", sink):
            parameter = _read(key, value, sink)
            if parameter is not None:
                found[key.name] = parameter
    return found


def _read(key: Key, node: Node, sink: Sink) -> Parameter | None:
    before = sink.error_count
    written = node.entries if isinstance(node, Mapping) else {"default": (key, node)}
    _check_keys(key, written, sink)

    def part(name: str) -> tuple[Value | None, Node | None]:
        found = written.get(name)
        return (plain(found[1]), found[1]) if found is not None else (None, None)

    default, at = part("default")
    if at is not None and default is None:
        sink.error("wrong-type", f"the default of `{key.name}` is a value or a list of numbers", at.span)
    if isinstance(default, str) and at is not None and is_template(default):
        help = "a default is written out; use the parameter where the value is needed"
        sink.error("wrong-type", f"the default of `{key.name}` cannot be an expression", at.span, help=help)
    type, at_type = part("type")
    choices, at_choices = part("choices")
    if at_choices is not None and (not isinstance(choices, tuple) or not choices):
        sink.error("wrong-type", f"`choices` of `{key.name}` is a list of values", at_choices.span)
        choices = None
    sample = default if default is not None else choices[0] if isinstance(choices, tuple) else None
    guess, value, unit = inferred(sample) if sample is not None else (None, None, None)
    if at_type is not None and type not in TYPES:
        help = did_you_mean(str(type), TYPES) or "`choices: […]` lists the values of a choice"
        sink.error("wrong-keyword", f"`type` of `{key.name}` is none of the types", at_type.span,
                   notes=(exists_note("type", TYPES),), help=help, fix=renaming(str(type), TYPES))  # fmt: skip
    if type is None and guess is None and at is None:
        sink.error("missing-key", f"parameter `{key.name}` has neither `default` nor `type`", key.span,
                   help="write `{default: …}`, or `{type: float}` for one that must be given")  # fmt: skip
    own_unit, own_doc = part("unit")[0], part("doc")[0]
    unit = unit if own_unit is None else str(own_unit)
    low, high, length = (
        _number(part(name)[1], name, key.name, unit=unit, sink=sink) for name in ("min", "max", "length")
    )
    if low is not None and high is not None and low > high:
        at_high = part("max")[1]
        assert at_high is not None
        sink.error("out-of-range", f"`max` of `{key.name}` is below its `min`", at_high.span)
    if sink.error_count > before:
        return None
    if type == "string":
        value, unit = sample, None if own_unit is None else str(own_unit)
    parameter = Parameter(
        key.name, str(type or guess), None if default is None else value, span=key.span, low=low, high=high,
        choices=tuple(_in_unit(each, unit) for each in choices) if isinstance(choices, tuple) else (),
        length=int(length) if length is not None else len(value) if isinstance(value, tuple) else None,
        unit=unit, doc=str(own_doc or ""),
    )  # fmt: skip
    if default is None:
        return parameter
    settled = parameter.read(default)
    if isinstance(settled, Diagnostic):
        assert at is not None
        sink.add(replace(settled, span=at.span))
        return None
    return replace(parameter, default=settled)


def _check_keys(key: Key, written: Map[str, tuple[Key, Node]], sink: Sink) -> None:
    """Report unknown keys of a parameter, and values that should be text."""
    for name, (each, value) in written.items():
        if name not in KEYS:
            message = f"parameter `{key.name}` has no key `{name}`"
            sink.add(unknown_key(name, KEYS, each.span, message=message))
        elif name in ("unit", "doc") and not isinstance(plain(value), str):
            sink.error("wrong-type", f"`{name}` of `{key.name}` is text", value.span)


def _in_unit(value: Value, unit: str | None) -> Value:
    """Return an angle with a unit as a number in the unit of its parameter."""
    angle = Angle.read(value) if isinstance(value, str) and unit in UNITS else None
    return value if angle is None else angle.in_unit(str(unit))


def _number(node: Node | None, what: str, name: str, unit: str | None, sink: Sink) -> float | None:
    if node is None:
        return None
    value = _in_unit(node.value, unit) if isinstance(node, Scalar) and node.value is not None else None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != value:
        sink.error("wrong-type", f"`{what}` of `{name}` is a number", node.span)
        return None
    return value


def settle(
    parameters: Map[str, Parameter], given: Map[str, Node], sink: Sink, in_cells: Collection[str] = ()
) -> dict[str, Value]:
    """Return the value of every parameter: the given one, else its default, which also replaces faulty values.

    A parameter without a default that is not given has no value. The cells of a matrix set those `in_cells`.
    """
    scope = {name: each.default for name, each in parameters.items() if each.default is not None}
    for name, parameter in parameters.items():
        node = given.get(name)
        if node is None:
            if parameter.default is None:
                cells = "with `--all` the cells of the matrix, which set it, " if name in in_cells else ""
                help = f"build with `--set {name}=…`, {cells}or write `with: {{{name}: …}}` where the recipe is used"
                message = f"parameter `{name}` has no default and must be given"
                sink.error("missing-key", message, parameter.span, help=help)
            continue
        value = plain(node)
        answer = (
            Diagnostic("wrong-type", f"parameter `{name}` is a value")
            if value is None
            else parameter.read(value)
        )
        if isinstance(answer, Diagnostic):
            note = Note("the parameter is declared here", parameter.span)
            sink.add(replace(answer, span=node.span, notes=(note,)))
        else:
            scope[name] = answer
    return scope
