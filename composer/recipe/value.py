"""The value of one attribute, checked against the grammar."""

from __future__ import annotations

from typing import Any

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.fix import Fix
from composer.diagnostics.suggest import advised, exists_note
from composer.expr.angle import Angle
from composer.grammar.attribute import Attribute
from composer.grammar.check import check_number, check_python, expected
from composer.grammar.refusal import Refusal
from composer.recipe.advice import instead, item_instead
from composer.recipe.element import Value
from composer.recipe.fault import Fault, Path
from composer.recipe.shown import kind_of, shown
from composer.recipe.text import is_unprintable, unprintable


def read_value(attribute: Attribute, value: Any, at: Path, owner: str, faults: list[Fault]) -> Value | None:
    """Return the value with lists as tuples, or None after a reported fault.

    `owner` is the element of the attribute in messages. An `Angle` is allowed for any real number.
    """
    subject = f"`{attribute.name}` of {owner}"
    if isinstance(value, dict):
        faults.append(Fault("wrong-type", f"{subject} expects {expected(attribute)}, got a mapping", at))
        return None
    if isinstance(value, list):
        return _read_list(attribute, value, at, subject=subject, faults=faults)
    read = _angle(attribute, value)
    answer = check_python(attribute, read.value if isinstance(read, Angle) else read)
    if answer is not None:
        faults.append(_fault(attribute, value, answer, code=_code(attribute, read), at=at, subject=subject))
        return None
    return read if _printable(attribute, read, at, subject=subject, faults=faults) else None


def _read_list(
    attribute: Attribute, value: list[Any], at: Path, subject: str, faults: list[Fault]
) -> Value | None:
    items: list[Any] = [_angle(attribute, item) for item in value]
    several = attribute.is_number and attribute.max_length != 1
    if several:
        # Each number is checked alone, so that a fault points at the number and not at the whole list.
        before = len(faults)
        for index, item in enumerate(items):
            number = item.value if isinstance(item, Angle) else item
            if check_number(attribute, number) is not None:
                faults.append(_item_fault(attribute, item, (*at, index), subject=subject))
        if len(faults) > before:
            return None
    answer = check_python(attribute, [item.value if isinstance(item, Angle) else item for item in items])
    if answer is not None:
        code = "wrong-length" if several else _list_code(attribute, items)
        faults.append(_fault(attribute, value, answer, code=code, at=at, subject=subject))
        return None
    for index, item in enumerate(items):
        if not _printable(attribute, item, (*at, index), subject=subject, faults=faults):
            return None
    return tuple(items)


def _angle(attribute: Attribute, value: Any) -> Any:
    if attribute.type != "real" or not isinstance(value, str):
        return value
    return Angle.read(value) or value


def _code(attribute: Attribute, value: object) -> str:
    """Return the error code for a single value that the grammar refused."""
    if attribute.is_number:
        return "wrong-length" if isinstance(value, Angle) else _number_code(attribute, value)
    if attribute.type in ("keyword", "keywords") and isinstance(value, str | bool | int):
        return "wrong-keyword"
    return "wrong-length" if attribute.type == "chars" and isinstance(value, str) else "wrong-type"


def _number_code(attribute: Attribute, value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "wrong-type"
    if attribute.type == "int" and isinstance(value, float) and not value.is_integer():
        return "wrong-type"
    return "out-of-range" if check_number(attribute, value) else "wrong-length"


def _list_code(attribute: Attribute, items: list[Any]) -> str:
    """Return the error code for a list that the grammar refused, for another reason than a single number."""
    if attribute.type == "keywords" and items and all(isinstance(item, str | bool | int) for item in items):
        return "wrong-keyword"
    return "wrong-length" if attribute.separated and not items else "wrong-type"


def _item_fault(attribute: Attribute, item: object, at: Path, subject: str) -> Fault:
    code = _number_code(attribute, item)
    noun = "integers" if attribute.type == "int" else "numbers"
    wanted = f"{noun} of 32 bits" if code == "out-of-range" else noun
    advice = item_instead(attribute, item)
    message = f"{subject} expects {wanted}, got {kind_of(item)}"
    return (
        Fault(code, message, at)
        if advice is None
        else Fault(code, message, at, help=advice.help, fix=advice.fix)
    )


def _fault(attribute: Attribute, value: Any, answer: Refusal, code: str, at: Path, subject: str) -> Fault:
    """Return the grammar's answer as a fault."""
    advice = None if answer.advice else instead(attribute, value)
    help = answer.advice if advice is None else advice.help
    notes: tuple[Note, ...] = ()
    fix = None if advice is None else advice.fix
    if code == "wrong-keyword":
        words = value if isinstance(value, list) else [value]
        wrong = next((text for text in map(shown, words) if text not in attribute.keywords), None)
        if wrong is not None:
            near, renamed = advised(wrong, attribute.keywords)
            if near is not None:
                help, fix = near, renamed if value == wrong else None
            if answer.unknown is not None and not answer.lists_keywords:
                notes = (exists_note("keyword", attribute.keywords, wrong),)
    elif answer.instead is not None:
        help, fix = f"write `{attribute.name}: {answer.instead}`", Fix(answer.instead)
    return Fault(code, f"{subject} {answer.message}", at, notes=notes, help=help, fix=fix)


def _printable(attribute: Attribute, value: object, at: Path, subject: str, faults: list[Fault]) -> bool:
    if not isinstance(value, str) or not is_unprintable(value):
        return True
    faults.append(unprintable(subject, at, name=attribute.type in ("name", "reference", "references")))
    return False
