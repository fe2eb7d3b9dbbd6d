"""The check `expect`: the number of elements in the compiled model, and their values."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.report import with_rest
from mjcompose.base.words import counted
from mjcompose.language.checks.expect import MASS, SUBTREE_MASS, WHERE, ElementSelector, Expect, with_unit
from mjcompose.mujoco.attributes import KINDS, holder
from mjcompose.verify.checks.check import (
    ROUNDING,
    CheckEnds,
    Quantity,
    Scope,
    equal,
    failed,
    like,
    plain,
    quantities_of,
    quantity,
    unit_of,
    unknown,
    values_of,
    words_of,
)

_SHOWN = 8
_UNITS = {MASS: " kg", SUBTREE_MASS: " kg"}
_COUNTED = {kind.size: word for word, kind in KINDS.items() if word not in ("body", "key")}


def check(scope: Scope, expect: Expect) -> list[Fault]:
    """Report another number of elements than expected, and elements with other values."""
    select = expect.select
    if select is None:
        return _of_the_model(scope, expect)
    tag = select.tag
    glob = select.glob
    named = [0] if (tag, glob) == ("body", "world") else scope.matching(tag, glob)
    is_there = (index for index in named if _is_there(scope, index, select))
    elements = [index for index in is_there if _fits(scope, index, select)]
    scope.found(f"{tag} {glob}", len(elements))
    wrong = _miscounted(scope, expect, select, elements)
    if expect.attribute is None:
        return wrong
    return wrong + _differing(scope, expect, select, elements)


def _miscounted(scope: Scope, expect: Expect, select: ElementSelector, elements: list[int]) -> list[Fault]:
    tag = select.tag
    glob = select.glob
    count = expect.counts
    low, high = count or (1, math.inf)
    if low <= len(elements) <= high:
        return []
    expected = "at least one" if count is None else f"{low}" if low == high else f"{low} to {high}"
    seen = unknown(tag, glob, scope.names(tag), "select", tag)
    if elements:
        message = f"`{glob}` names {counted(len(elements), 'element')} `{tag}`, not {expected}"
        names = ", ".join(scope.written(tag, each) for each in elements[:_SHOWN])
        those = "it is" if len(elements) == 1 else "they are"
        more = [f"{those}: {names}" + (", …" if len(elements) > _SHOWN else "")]
        return [failed(message, expected, str(len(elements)), "count", more=more)]
    if count is None and expect.attr is not None:
        return [seen]
    more = [note.message for note in seen.notes]
    return [failed(f"{seen.message}{_there(select)}", expected, "0", *seen.at, more=more, help=seen.help)]


def _there(select: ElementSelector) -> str:
    """Return in words the conditions on the elements, besides their name."""
    there = f" right on a body `{select.parent.body}`" if select.parent is not None else ""
    there += f" in a body `{select.inside.body}`" if select.inside is not None else ""
    keys = ", ".join(f"`{condition.key}`" for condition in select.conditions)
    return f"{there} with such {keys}" if keys else there


def _is_there(scope: Scope, index: int, select: ElementSelector) -> bool:
    """Return whether the bodies around an element are those that the selector names."""
    if select.parent is None and select.inside is None:
        return True
    around = [holder(scope.model, select.tag, index)]
    while around[-1]:
        around.append(holder(scope.model, "body", around[-1]))
    named = ((select.parent, around[:1]), (select.inside, around))
    return all(body is None or not set(bodies).isdisjoint(scope.matching("body", body.body)) for body, bodies in named)


def _fits(scope: Scope, index: int, select: ElementSelector) -> bool:
    """Return whether an element has the values in `where`. Raises CheckEnds if they cannot be looked up."""
    tag = select.tag
    for condition in select.conditions:
        if condition.word is not None:
            if not scope.fitting(condition.word, set(words_of(scope, tag, index, attr=condition.key))):
                return False
            continue
        try:
            actual = values_of(scope, tag, index, condition.attr, condition.subscript)
            expected = quantities_of(scope, tag, index, condition.attr, condition.numbers)
        except CheckEnds as end:
            if end.fault.code == "wrong-length":
                return False
            raise CheckEnds(replace(end.fault, at=("select", WHERE, condition.key))) from None
        if len(expected) != actual.size or not equal(actual, expected, None):
            return False
    return True


def _differing(scope: Scope, expect: Expect, select: ElementSelector, elements: list[int]) -> list[Fault]:
    """Report the elements that do not have the expected values, or an attribute that they lack."""
    assert expect.attribute is not None
    tag = select.tag
    attr, subscript = expect.attribute
    key = _key(expect)
    unit = _UNITS.get(attr, "")
    wrong: list[tuple[str, str]] = []
    expected = ""
    for index in elements:
        try:
            actual = values_of(scope, tag, index, attr, subscript)
            quantities = quantities_of(scope, tag, index, attr, expect.numbers)
        except CheckEnds as end:
            return [replace(end.fault, at=end.fault.at or (key,))]
        scope.values[scope.written(tag, index)] = plain(actual)
        if key == "equals" and len(quantities) != actual.size:
            message = f"`{attr}` of {tag} `{select.glob}` has {actual.size} numbers, `equals` has {len(quantities)}"
            return [Fault("wrong-length", message, ("equals",))]
        holds, expected = _compared(expect, actual, quantities, unit_of(tag, attr), unit)
        if not holds:
            wrong.append((scope.called(tag, index), _listed(like(quantities, actual.tolist())) + unit))
    if not wrong:
        return []
    name, have = wrong[0]
    shown = attr + ("" if subscript is None else f"[{subscript}]")
    _, *more = with_rest([f"{other}: {value}" for other, value in wrong], _SHOWN)
    return [failed(f"`{shown}` of {name} is {have}, not {expected}", expected, have, key, more=more)]


def _key(expect: Expect) -> str:
    """Return the key that has the expected values."""
    return "range" if expect.equals is None else "equals"


def _compared(expect: Expect, actual: Any, quantities: list[Quantity], own_unit: str, unit: str) -> tuple[bool, str]:
    """Return whether numbers are as expected, and the expected numbers in words."""
    if expect.equals is None:
        low, high = quantities
        holds = all(low.value <= number <= high.value for number in actual.tolist())
        return holds, f"{low} to {high}{unit}"
    tol = None if expect.tol is None else quantity(*with_unit(expect.tol), own_unit)
    expected = _listed([str(number) for number in quantities]) + unit
    if tol is None:
        return equal(actual, quantities, None), expected
    return equal(actual, quantities, tol.value), f"{expected} ± {tol}{unit}"


def _of_the_model(scope: Scope, expect: Expect) -> list[Fault]:
    """Report a number of the model that is not the expected one. Merged keyframes belong to no single recipe."""
    assert expect.attribute is not None
    attr, _ = expect.attribute
    masses = (float(scope.model.body_mass[index]) for index in scope.own("body"))
    actual = sum(masses, 0.0) if attr == MASS else _size(scope, attr)
    if actual is None:
        return []
    scope.found(attr, actual)
    unit = _UNITS.get(attr, "")
    low, high, expected = _bounds(expect, unit)
    if low <= actual <= high:
        return []
    owner = "the model" if scope.whole else "this recipe's model"
    have = f"{actual:.9g}{unit}"
    return [failed(f"`{attr}` of {owner} is {have}, not {expected}", expected, have, _key(expect))]


def _bounds(expect: Expect, unit: str) -> tuple[float, float, str]:
    """Return the least and greatest number of the model that fits, and words for both."""
    numbers = [number for number, _ in expect.numbers]
    if expect.equals is None:
        low, high = numbers
        return low, high, f"{low:.9g} to {high:.9g}{unit}"
    (number,) = numbers if len(numbers) == 1 else (math.nan,)
    if expect.tol is None:
        slack = ROUNDING[8] * max(1.0, abs(number))
        return number - slack, number + slack, f"{number:.9g}{unit}"
    slack, _ = with_unit(expect.tol)
    return number - slack, number + slack, f"{number:.9g}{unit} ± {slack:g}{unit}"


def _size(scope: Scope, size: str) -> int | None:
    """Return a size of mjModel, counting the recipe's own elements; None if that is impossible."""
    from mjcompose.mujoco.addresses import VECTORS, span

    model = scope.model
    if scope.whole:
        value = getattr(model, size, None)
        return scope.roster.count("actuator") if value is None and size == "nactuator" else value
    if size in _COUNTED:
        return len(list(scope.own(_COUNTED[size])))
    if size == "nbody":
        return 1 + len(list(scope.own("body")))  # every model has the world
    for vector, (kind, summed) in VECTORS.items():
        if summed == size:
            return sum(len(span(model, vector, index)) for index in scope.own(kind))
    return None


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"[{', '.join(words)}]"
