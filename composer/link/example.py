"""For the examples in the passes: a tiny base and a part go in, what one pass changes in them comes out."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.contract import Fact
from composer.link.link import FINISHING, PASSES, row_of
from composer.link.linking import Linking
from composer.link.measure import measure_with
from composer.link.part import Joint, Part, Place
from composer.tree.parse import parse_text
from composer.tree.unit import Unit


def after(
    run: object, part: str = "", base: str = "", *, on: str = "", joint: str = "", weld: bool = False
) -> None:
    """Link a part with the prefix `p/` to a base, up to a pass, and print the sections that this pass has changed.

    Both are the text inside `<mujoco>`. The part is attached to the world, or `on` a site, with a `joint` if one is
    given. Faults are printed, too.
    """
    row = row_of(run)
    assert row is not None
    sink = Sink()
    place = Place("site", on) if on else Place()
    joints = (Joint("joint", {"name": joint}),) if joint else ()
    hung = Part(_unit("part", part), "p/", place, joints=joints, weld=weld)
    linking = Linking(
        _unit("base", base), [hung], sink, measure=measure_with(Context(sink=sink, environment={}))
    )
    facts: set[Fact] = set()
    before: list[list[str]] = []
    for each in (*PASSES, *FINISHING):
        before = [_sections(unit) for unit in linking.units]
        each.run(linking)
        facts |= each.leaves
        if each is row:
            break
    joined = Fact.JOINED in facts
    units = [("model" if joined else "base", linking.base)] + ([] if joined else [("part", hung.unit)])
    for (label, unit), old in zip(units, before, strict=False):
        for text in _sections(unit):
            if text not in old:
                print(f"{label}: {text}")  # noqa: T201
    for fault in sink.diagnostics:
        print(f"{fault.severity.value}: {fault.message}")  # noqa: T201


def _unit(label: str, text: str) -> Unit:
    sink = Sink()
    source = f"<mujoco>{text}</mujoco>".encode()
    unit = parse_text(source, sink, file=f"{label}.xml", directory=Path(), label=label)
    assert unit is not None, sink.diagnostics
    return unit


def _sections(unit: Unit) -> list[str]:
    sections = unit.root.iterchildren("*")
    return [" ".join(etree.tostring(each, with_tail=False).decode().split()) for each in sections]
