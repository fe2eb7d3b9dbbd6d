"""Edits cost as much in a large model as in a small one, counted in calls: time is for the benchmark."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

import pytest
from mjcompose import mjcf
from mjcompose.mjcf import RootElement

_FEW = 50
_MANY = 1000


def _calls(work: Callable[[], object]) -> int:
    count = 0

    def note(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    return count


def _large(count: int) -> RootElement:
    root = mjcf.RootElement("large")
    site = root.worldbody.add("site", name="one")
    for number in range(count):
        root.worldbody.add("geom", name=f"g{number}", size=[1])
        root.sensor.add("touch", name=f"s{number}", site=site)
    return root


def _add(root: RootElement, count: int) -> None:
    for number in range(count):
        root.worldbody.add("geom", name=f"more{number}", size=[1])


def _insert(root: RootElement, count: int) -> None:
    for _ in range(count):
        root.worldbody.insert("geom", 0, size=[1])


def _find(root: RootElement, count: int) -> None:
    for number in range(count):
        assert root.find("geom", f"g{number}") is not None


def _rename(root: RootElement, count: int) -> None:
    site = root.find("site", "one")
    assert site is not None
    site.name = "renamed"
    assert root.sensor.touch[-1].site is site


def _remove(root: RootElement, count: int) -> None:
    for geom in root.find_all("geom")[::2]:
        geom.remove()


def _remove_all_that_refer(root: RootElement, count: int) -> None:
    site = root.find("site", "one")
    assert site is not None
    site.remove(cascade=True)
    assert root.sensor.touch == []


def _write(root: RootElement, count: int) -> None:
    assert mjcf.from_xml_string(root.to_xml_string()).find("geom", f"g{count - 1}") is not None


@pytest.mark.parametrize(
    "edit", [_add, _insert, _find, _rename, _remove, _remove_all_that_refer, _write], ids=lambda each: each.__name__
)
def test_an_edit_is_linear(edit: Callable[[RootElement, int], None]) -> None:
    edit(_large(_FEW), _FEW)  # what is made once and kept
    few, many = (_large(count) for count in (_FEW, _MANY))
    for_few = _calls(lambda: edit(few, _FEW)) / _FEW
    for_many = _calls(lambda: edit(many, _MANY)) / _MANY
    assert for_many <= 1.2 * for_few


def test_ten_thousand_geoms_stand_as_they_were_added() -> None:
    root = mjcf.RootElement("large")
    geoms = [root.worldbody.add("geom", name=f"g{number}", size=[1]) for number in range(10_000)]
    for geom in geoms[::2]:
        geom.remove()
    assert root.find_all("geom") == geoms[1::2]
    assert root.find("geom", "g4") is None and root.find("geom", "g9999") is geoms[-1]
