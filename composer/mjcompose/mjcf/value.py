"""Values and references of attributes, from Python to MJCF and back."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from itertools import count
from typing import Any

import numpy as np
from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.base.words import number_text, tag_text
from mjcompose.mjcf.model import ModelState, ReferencedNode
from mjcompose.tree import values
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.edit import assign
from mjcompose.tree.grammar import GRAMMAR, Attribute, to_text
from mjcompose.tree.names import UP, WORLD, word
from mjcompose.tree.select import kind_of
from mjcompose.tree.values import INT_MAX, NOT_XML, Refusal, expected, items, parse_real, plain

# Types whose values may be text as XML writes it; numbers may be text too.
_WRITTEN = ("bool", "keyword", "keywords", "references")
# Where infinity has no meaning but makes every later number NaN; a range or a limit may be infinite.
_FINITE = frozenset(
    {"pos", "axis", "fromto", "size", "mass", "density", "diaginertia", "fullinertia", *ORIENTATIONS}
    | {"scale", "vertex", "timestep", "gravity", "qpos", "qvel", "mpos", "mquat", "ref"}
)
# One number or several as almost everybody writes them.
_DECIMALS = re.compile(
    r"[ \t\n\r]*(?:[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?:[ \t\n\r]+|$))+", re.ASCII
)


class BadValue(ValueError):
    """A value is not accepted; the message continues the attribute's name."""

    def __init__(self, refusal: Refusal | str) -> None:
        super().__init__(refusal)
        self.refusal = Refusal(refusal) if isinstance(refusal, str) else refusal


def encode(attribute: Attribute, value: object) -> str:
    """Return the MJCF text of a value. A value that is text must be valid MJCF. Raises `BadValue`.

    Numbers are written so that they read back to the same bits. If the attribute has no fixed length, an array of
    more than one dimension is written row by row.
    """
    quick = plain_text(attribute, value)
    if quick is not None:
        return quick
    if isinstance(value, os.PathLike) and attribute.type == "file":
        value = os.fspath(value)
    if isinstance(value, str):
        written = attribute.is_number or attribute.type in _WRITTEN
        fault = (values.check_value if written else values.check_python)(attribute, value)
        text = value
    else:
        value = _flat(attribute, value)
        fault = values.check_python(attribute, value)
        text = "" if fault else to_text(attribute, value)
    if fault is not None:
        raise BadValue(fault)
    if attribute.is_number:
        _check_numbers(attribute, text)
    unwritable = NOT_XML.search(text)
    if unwritable:
        raise BadValue(f"has the character {unwritable.group()!r}, which XML cannot hold")
    return text


def decode(attribute: Attribute, text: str) -> object:
    """Return the Python value of an attribute's text. Raises `BadValue` for text that MuJoCo would refuse.

    One number is returned as a numpy scalar, several as an array of `float64` or `int64` with the shape `(n,)`. A
    keyword is returned as text, a list of keywords as a list, and a boolean as a `bool`.
    """
    if attribute.type == "real" and _DECIMALS.fullmatch(text):
        decimals = list(map(float, text.split()))
        if values.check_length(attribute, len(decimals)) is None and not any(map(math.isinf, decimals)):
            return np.float64(decimals[0]) if attribute.max_length == 1 else np.array(decimals)
    fault = values.check_value(attribute, text)
    if fault is not None:
        raise BadValue(fault)
    if attribute.type == "bool":
        return text == "true"
    if attribute.type == "keywords":
        return items(text)
    if not attribute.is_number:
        return text
    numbers = [parse_real(item) for item in items(text)]
    array = np.array(numbers, dtype=np.int64 if attribute.type == "int" else np.float64)
    return array[0] if attribute.max_length == 1 else array


def _check_numbers(attribute: Attribute, text: str) -> None:
    for item in items(text):
        number = parse_real(item) or 0.0
        if math.isnan(number):
            raise BadValue("expects numbers, got `nan`")
        if math.isinf(number) and attribute.name in _FINITE:
            raise BadValue(f"expects finite numbers, got `{item}`")


def plain_text(attribute: Attribute, value: object) -> str | None:
    """Return the text of a value that is clearly valid, such as finite numbers, or None if it needs a full check."""
    if attribute.type == "keyword":
        return value if type(value) is str and value in attribute.keywords else None
    if attribute.type == "bool":
        return str(value).lower() if type(value) is bool else None
    return _plain_numbers(attribute, value) if attribute.is_number else None


def _plain_numbers(attribute: Attribute, value: object) -> str | None:
    # Types are compared, not tested with `isinstance`: a `bool` is not a number, and a subclass has a text of its own.
    numbers: Any = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    if type(numbers) is float or type(numbers) is int:
        numbers = (numbers,)
    elif (type(numbers) is not list and type(numbers) is not tuple) or attribute.max_length == 1:
        return None
    if values.check_length(attribute, len(numbers)) is not None:
        return None
    texts = []
    for number in numbers:
        if type(number) is int and -INT_MAX <= number <= INT_MAX:
            texts.append(str(number))
        elif type(number) is float and attribute.type == "real" and math.isfinite(number):
            texts.append(number_text(number))
        else:
            return None
    return " ".join(texts)


def _flat(attribute: Attribute, value: object) -> object:
    """Return arrays and tuples as lists. If the attribute takes any number of items, join the rows."""
    is_open_ended = attribute.is_number and attribute.max_length is None
    shape = getattr(value, "shape", None)
    if shape is not None and len(shape) > 1 and attribute.is_number:
        if not is_open_ended:
            raise BadValue(f"expects a flat array, got one of shape {tuple(shape)}")
        value = np.asarray(value).reshape(-1)
    if isinstance(value, bytes | bytearray):
        raise BadValue(f"expects {expected(attribute)}, got `{value!r}`")
    if isinstance(value, np.ndarray | np.generic) and value.dtype.kind == "f":
        value = value.astype(np.float64)  # a `longdouble` is not a `float`
    value = plain(value)
    if not isinstance(value, list | tuple):
        return value
    flat = [plain(item) for item in value]
    rows = [item for item in flat if isinstance(item, list | tuple)]
    return _joined(rows) if is_open_ended and rows and len(rows) == len(flat) else flat


def _joined(rows: list[list[Any] | tuple[Any, ...]]) -> list[object]:
    if len({len(row) for row in rows}) > 1:
        raise BadValue("expects rows of one length, got several")
    return [plain(number) for row in rows for number in row]


def is_reference(attribute: Attribute) -> bool:
    """Return whether the attribute refers to elements of the model by name."""
    if attribute.refers_by is not None:
        return True
    return attribute.is_reference and not (attribute.refers or "").startswith("attached:")


def namespace_of(attribute: Attribute, written: Mapping[str, str]) -> str | None:
    """Return the namespace of a reference, given all attributes of its element, or None if it is not known."""
    if attribute.refers_by is not None:
        return GRAMMAR.objtypes.get(written.get(attribute.refers_by, ""))
    return attribute.refers


def _declared_name(target: ReferencedNode, namespace: str | None) -> str | None:
    """Return the name that a target has. Raises `BadValue` if a reference to the namespace cannot mean the target."""
    if not target.model.has(target.node):
        raise BadValue(f"got {describe_target(target)}, which was removed")
    declared = target.model.declared(target.node)
    family = declared[0] if declared else kind_of(target.node).family
    if namespace is not None and family != namespace:
        raise BadValue(f"expects {word(namespace, article=True)}, got {describe_target(target)}")
    if declared is None and family is None:
        raise BadValue(f"got {describe_target(target)}, which nothing can refer to")
    return declared[1] if declared else None


def name_for(
    model: ModelState,
    attribute: Attribute,
    target: ReferencedNode,
    namespace: str | None,
    given: dict[ReferencedNode, str],
) -> str:
    """Return the name that refers to `target` in `model`. Raises `BadValue` if no name is possible.

    A target without a name gets one in `given`, which the caller must write. The name in a model that is not in the
    same composition yet is provisional, and the caller must note it in `awaited` of the model.
    """
    declared = _declared_name(target, namespace)
    if declared is None and target not in given:
        given[target] = _free_name(target, str(kind_of(target.node).family), given)
    own = given[target] if declared is None else declared
    way = model.prefix_of(target.model)
    got = f"got {describe_target(target)}"
    if way is None and attribute.type != "references" and namespace != "default" and own != WORLD:
        return f"{UP}{target.model.full_prefix or target.model.prefix}{own}"
    if way is None:
        raise BadValue(f"{got} of the model `{target.model.name}`, which is not attached to `{model.name}`")
    name = way + own if declared is None else target.model.seen_from(model, target.node)
    if name is None:
        raise BadValue(f"{got} of the model `{target.model.name}`, which `{model.name}` cannot refer to")
    if attribute.type == "references" and len(name.split()) != 1:
        raise BadValue(f"{got}, but a list of names cannot hold one with a space")
    return name


def _free_name(target: ReferencedNode, namespace: str, given: Mapping[ReferencedNode, str]) -> str:
    model = target.model
    taken = set(given.values())
    names = (f"unnamed_{namespace}_{number}" for number in count(len(model.names.declared.get(namespace, ()))))
    return next(
        each for each in names if each not in taken and model.top.lookup(namespace, model.full_prefix + each) is None
    )


def resolved(model: ModelState, attribute: Attribute, node: Node, text: str) -> list[ReferencedNode | str]:
    """Return the nodes that an attribute refers to: one, or one for each name in a list.

    A name that does not exist is returned as it is. MuJoCo may still generate it (the copies of a `replicate`); if
    not, it is reported when the model is written.
    """
    awaited = model.awaited.get((node, attribute.name))
    if awaited is not None and awaited[1] == text:
        return [awaited[0]]
    namespace = namespace_of(attribute, {str(key): str(value) for key, value in node.items()})
    names = text.split() if attribute.type == "references" else [text]
    return [(model.lookup(namespace, name) if namespace else None) or name for name in names]


def update_references(top: ModelState) -> None:
    """Write the names of elements that have been attached since then into the models that refer to them."""
    for model in top.composition():
        for (node, attribute), (target, text) in [*model.awaited.items()]:
            if not model.has(node) or node.get(attribute) != text:
                del model.awaited[node, attribute]  # it was removed or written again
            elif model.prefix_of(target.model) is not None and target.model.has(target.node):
                name = target.model.seen_from(model, target.node)
                if name is not None:
                    del model.awaited[node, attribute]
                    assign(model, node, {attribute: name})


def describe_target(target: ReferencedNode) -> str:
    """Return the description of an element for messages. See `describe`."""
    return describe(target.model, target.node)


def is_here(target: ReferencedNode) -> Note:
    return Note(f"{describe_target(target)} is here", target.model.span(target.node))


def describe(model: ModelState, node: Node) -> str:
    """Return the description of an element for messages: its tag, and its name if it has one."""
    declared = model.declared(node) if model.has(node) else ("", str(node.get("name") or ""))
    is_named = declared is not None and declared[1] != WORLD
    return tag_text(str(node.tag), declared[1] if declared is not None and is_named else None)
