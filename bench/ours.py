"""Our side of the comparisons: files in, text out, as a build does it but for the recipe and the assets."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.link.link import finish, link
from mjcompose.link.linking import AttachmentPlace, Linking, LinkRequest, ModelMeasure, Part
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write

# What the hands ask for and the arms do not: a recipe has to say which it is, or it does not build.
_SETTLED = frozenset({"option/cone", "option/impratio"})


def attached(arm: Path, hand: Path, site: str) -> bytes:
    """The text of the arm with the hand at its site."""
    sink = Sink()
    base = parse_file(arm, sink)
    unit = parse_file(hand, sink)
    assert base is not None and unit is not None
    return _linked(
        Linking(
            base, [Part(unit, "hand/", AttachmentPlace("site", site))], sink, LinkRequest(overridden_options=_SETTLED)
        )
    )


def paired(base: Path, parts: Iterable[tuple[Path, str, AttachmentPlace]], measure: ModelMeasure) -> bytes | None:
    """The text of a model with parts in their places; None where they cannot be joined.

    Where they disagree about an option the model's value stands, and the warnings say so.
    """
    sink = Sink()
    units = [parse_file(file, sink) for file in (base, *(file for file, *_ in parts))]
    first, *others = (unit for unit in units if unit is not None)
    if sink.has_errors:
        return None
    hung = [Part(unit, prefix, place) for unit, (_, prefix, place) in zip(others, parts, strict=True)]
    linking = Linking(first, hung, sink, LinkRequest(separator="", conflict="warning"), measure)
    if not link(linking):
        return None
    finish(linking)
    return None if sink.has_errors else write(linking.base.root)


def copies(model: Path, count: int) -> bytes:
    """The text of an empty world with so many copies of a model; the file is read once."""
    sink = Sink()
    unit = parse_file(model, sink)
    assert unit is not None
    base = Unit(etree.Element("mujoco"), "", Path(), "world")
    parts = [Part(unit.copied() if number else unit, f"{number}/") for number in reversed(range(count))]
    return _linked(Linking(base, parts, sink, LinkRequest(conflict="mujoco")))


def _linked(linking: Linking) -> bytes:
    link(linking)
    finish(linking)
    assert not linking.sink.has_errors, linking.sink.errors
    return write(linking.base.root)
