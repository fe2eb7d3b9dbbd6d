"""Pass: memory for the simulation. A source's request is for that source alone, not for the whole model.

Without a request, MuJoCo chooses the memory by the size of the model. A source's request would apply to the whole
model: with `memory="1M"` from a lamp beside 300 boxes, MuJoCo 4.0 drops contacts, and boxes fall through the floor.
`njmax`, `nconmax` and `nstack` are older ways to set the same amount.
"""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.linking import Linking
from composer.link.notes import MemoryRequest
from composer.tree.unit import Unit

ROOM = ("memory", "njmax", "nconmax", "nstack")
_MOVING = ("joint", "freejoint", "flexcomp", "attach", "composite")
_SCALE = {"k": 2**10, "m": 2**20, "g": 2**30, "t": 2**40, "p": 2**50, "e": 2**60}


def asked(linking: Linking) -> tuple[MemoryRequest, ...]:
    """Return the memory that the units ask for if several of them move, when MuJoCo must check whether it is enough."""
    calls = ["the base", *(part.called for part in linking.parts)]
    moving = [next(unit.root.iter(*_MOVING), None) is not None for unit in linking.units]
    for number, part in enumerate(linking.parts, 1):
        moving[number] |= bool(part.joints)
    if sum(moving) < 2 or any(f"size/{name}" in linking.request.overridden_options for name in ROOM):
        return ()
    return tuple(each for unit, called in zip(linking.units, calls, strict=True)
                 for each in _written(linking, unit, called))  # fmt: skip


def _written(linking: Linking, unit: Unit, called: str) -> Iterator[MemoryRequest]:
    for size in unit.root.iterchildren("size"):
        for name in ROOM:
            value = str(size.get(name) or "").strip()
            # `memory="-1"` leaves it to MuJoCo, as if it were not written.
            if value and value != "-1":
                yield MemoryRequest(name, value, called, linking.span(unit, size, name))


def room(linking: Linking) -> None:
    """Remove the memory size if MuJoCo's own for the whole model is larger than any source asks for.

    >>> from composer.link.example import after
    >>> base = '<worldbody>' + '<body><freejoint/><geom size=".1"/></body>' * 30 + '</worldbody>'
    >>> part = '<size memory="1K"/><worldbody><body><joint/><geom size=".1"/></body></worldbody>'
    >>> after(room, part, base)  # doctest: +ELLIPSIS
    warning: `size.memory` of `p/` is 1K, ...
    """
    if not linking.notes.memory or linking.measure is None:
        return
    unit = linking.flat()
    sizes = [size for size in unit.root.iterchildren("size") if any(size.get(name) for name in ROOM)]
    memory = [str(size.get("memory")) for size in sizes if size.get("memory")]
    written = bytes_of(memory[-1]) if memory else _measured(linking, unit)
    kept = [(size, dict(size.attrib)) for size in sizes]
    for size in sizes:
        for name in ROOM:
            size.attrib.pop(name, "")
    own = _measured(linking, unit)
    if written is None or own is None or own <= written:
        for size, attributes in kept:
            size.attrib.update(attributes)
        return
    for size in sizes:
        _leave_out_empty(size)
    first, *others = linking.notes.memory
    linking.sink.warning(
        "option-conflict",
        f"`size.{first.name}` of {_quoted(first.called)} is {first.value}, which is too little for the whole model:"
        f" MuJoCo's own choice, {_megabytes(own)}, is used",
        first.span,
        notes=[
            Note(f"{_quoted(each.called)} asks for `{each.name}` {each.value}", each.span) for each in others
        ],
        help=f"to set it yourself, write in the recipe `size: {{memory: {_megabytes(own)}}}`, or another amount",
    )


def _measured(linking: Linking, unit: Unit) -> float | None:
    """Return MuJoCo's memory size for the current model, or None if it refuses the model, which is reported later."""
    assert linking.measure is not None
    found = linking.measure(unit, ("narena",), attempt=True)
    return found["narena"][0] if found else None


def _leave_out_empty(size: Node) -> None:
    parent = size.getparent()
    if parent is not None and not size.attrib and not len(size):
        parent.remove(size)


def bytes_of(text: str) -> float:
    """Return an amount of memory written in MJCF as a number of bytes.

    >>> bytes_of("2M")
    2097152.0
    """
    text = text.strip().lower()
    return float(text[:-1]) * _SCALE[text[-1]] if text and text[-1] in _SCALE else float(text or 0)


def _megabytes(count: float) -> str:
    return f"{round(count / 2**20)}M"


def _quoted(called: str) -> str:
    return called if called == "the base" else f"`{called}`"
