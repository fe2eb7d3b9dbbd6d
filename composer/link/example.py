"""Run one pass on a tiny base and part, and print what it changes. For the examples in the docstrings of passes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from lxml import etree

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.contract import AT_THE_START, Fact
from composer.link.link import FINISHING, PASSES, row_of
from composer.link.linking import Linking
from composer.link.measure import measure_with
from composer.link.part import Joint, Part, Place
from composer.link.room import asked
from composer.tree.parse import parse_text
from composer.tree.unit import Unit


def after(
    run: object, part: str = "", base: str = "", *, files: Mapping[str, str] | None = None, **hung: Any
) -> None:
    """Link a part with the prefix `p/` to a base, up to a pass, and print the sections that this pass has changed.

    Both are the text inside `<mujoco>`; `files` are models that the part names, as whole texts. `hung` says how the
    part hangs, as in `_part`. Errors are printed, too.
    """
    linking, before, facts = _linked(run, part, base, files or {}, **hung)
    units = [("model" if Fact.JOINED in facts else "base", linking.base)]
    if Fact.OWN_SECTIONS in facts:  # also once the bodies of the part are in the base
        units += [("part", each.unit) for each in linking.parts]
    for (label, unit), old in zip(units, before, strict=False):
        for text in _sections(unit):
            if text not in old:
                print(f"{label}: {text}")  # noqa: T201
    for fault in linking.sink.diagnostics:
        print(f"{fault.severity.value}: {fault.message}")  # noqa: T201


def noted(run: object, part: str = "", base: str = "", **hung: Any) -> Linking:
    """Return the linking after a pass that only records facts. The arguments are those of `after`."""
    linking, _, _ = _linked(run, part, base, {}, **hung)
    return linking


def _linked(
    run: object, part: str, base: str, files: Mapping[str, str], **hung: Any
) -> tuple[Linking, list[list[str]], set[Fact]]:
    """Return the linking after a pass, the sections of its units before it, and the facts that hold after it."""
    row = row_of(run)
    assert row is not None
    sink = Sink()
    measure = measure_with(Context(sink=sink, environment={}))
    linking = Linking(_unit("base", base), [_part(part, files, **hung)], sink, measure=measure)
    linking.notes.memory = asked(linking)
    facts = set(AT_THE_START)
    before: list[list[str]] = []
    for each in (*PASSES, *FINISHING):
        before = [_sections(unit) for unit in linking.units]
        each.run(linking)
        facts = (facts | each.leaves) - each.ends
        if each is row:
            break
    return linking, before, facts


def _part(text: str, files: Mapping[str, str], *, on: str = "", joint: str = "", weld: bool = False) -> Part:
    """Return a part that is attached to the world, or to the site `on`, with a `joint` if one is given."""
    unit = _unit("part", text)
    unit.contents = {name: each.encode() for name, each in files.items()}
    place = Place("site", on) if on else Place()
    return Part(unit, "p/", place, joints=(Joint("joint", {"name": joint}),) if joint else (), weld=weld)


def _unit(label: str, text: str) -> Unit:
    sink = Sink()
    source = f"<mujoco>{text}</mujoco>".encode()
    unit = parse_text(source, sink, file=f"{label}.xml", directory=Path(), label=label)
    assert unit is not None, sink.diagnostics
    return unit


def _sections(unit: Unit) -> list[str]:
    sections = unit.root.iterchildren("*")
    return [" ".join(etree.tostring(each, with_tail=False).decode().split()) for each in sections]
