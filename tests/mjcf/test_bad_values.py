"""Every attribute of one element of each kind, given what it cannot be: told at the line that did it, or it reads back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from mjcompose import mjcf
from mjcompose.mjcf import Element, MjcfError, RootElement
from mjcompose.tree.grammar import GRAMMAR

_SECTIONS = ("asset", "contact", "equality", "tendon", "actuator", "sensor", "keyframe", "custom")
_ON_BODIES = ("body", "joint", "geom", "site", "camera", "light", "inertial", "frame")


class _NoArray:
    def __array__(self, *_: object) -> np.ndarray:
        raise RuntimeError("not this one")


def _elements() -> tuple[RootElement, list[Element]]:
    root = mjcf.RootElement("all")
    body = root.worldbody.add("body", name="b")
    elements = [body.add(tag) for tag in _ON_BODIES]
    for section in _SECTIONS:
        holder = getattr(root, section)
        elements += [holder.add(tag) for tag in GRAMMAR.section(section).children]
    return root, [*elements, root.option, root.compiler, root.size, root.statistic, root.visual.headlight]


def _bad() -> dict[str, object]:
    other = mjcf.RootElement("other").worldbody.add("body", name="of another")
    gone = mjcf.RootElement("third").worldbody.add("geom", name="gone")
    gone.remove()
    return {
        "nan": float("nan"),
        "nans": np.array([np.nan, 0, 0]),
        "nan as text": "nan",
        "complex": 1j,
        "huge": 10**400,
        "object": object(),
        "set": {1, 2},
        "mapping": {"x": 1},
        "ragged": [1, [2]],
        "table": np.zeros((2, 2)),
        "words": np.array(["x", "y"]),
        "date": np.datetime64("2020-01-01"),
        "objects": np.array([None, 1], dtype=object),
        "raises": _NoArray(),
        "module": mjcf,
        "path": Path("a"),
        "bytes": b"abc",
        "none in a list": [None],
        "generator": (each for each in [1]),
        "control character": "a\x00b",
        "surrogate": "\ud800",
        "of another model": other,
        "removed": gone,
        "removed among others": [gone, 3],
        "file": mjcf.Asset(b"solid", ".stl"),
    }


@pytest.mark.parametrize("what", _bad())
def test_it_is_told_and_nothing_has_changed(what: str) -> None:
    root, elements = _elements()
    value = _bad()[what]
    told = 0
    for element in elements:
        for attribute in element._kind.attributes:
            before = etree.tostring(root._node)
            try:
                setattr(element, attribute, value)
            except MjcfError as error:
                told += 1
                assert etree.tostring(root._node) == before, (element, attribute)
                span = error.diagnostics[0].span
                assert span is not None and span.file == __file__
            else:
                element.get(attribute)
                delattr(element, attribute)
    assert told > 500


@pytest.mark.parametrize(("position", "place"), [(10**30, 1), (-(10**30), 0)])
def test_a_position_beyond_all_children_is_an_end(position: int, place: int) -> None:
    world = RootElement().worldbody
    first = world.add("geom", size=[1])
    world.insert("geom", position, size=[2])
    assert world.geom[1 - place] is first
