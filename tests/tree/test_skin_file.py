from __future__ import annotations

import struct
from pathlib import Path

import pytest
from lxml import etree

from composer.tree.skin_file import BadBone, bones, renamed_skin, skins


def _skin(*names: str) -> bytes:
    """A triangle with a bone for each name."""
    header = struct.pack("<4i9f3i", 3, 0, 1, len(names), *range(9), 0, 1, 2)
    bind = struct.pack("<7fi3i3f", 0, 0, 0, 1, 0, 0, 0, 3, 0, 1, 2, 1, 1, 1)
    return header + b"".join(name.encode().ljust(40, b"\0") + bind for name in names)


def test_two_bones_change_places() -> None:
    assert renamed_skin(_skin("a", "b", "c"), {"a": "b", "b": "a"}.get) == _skin("b", "a", "c")


def test_a_file_without_any_of_the_names_stays(tmp_path: Path) -> None:
    (tmp_path / "coat.skn").write_bytes(_skin("a"))
    assert renamed_skin(tmp_path / "coat.skn", {"b": "c"}.get) is None
    assert bones(tmp_path / "coat.skn") == ["a"]


@pytest.mark.parametrize("source", [_skin("a")[:-1], b"nothing", Path("does-not-exist.skn")])
def test_a_file_that_cannot_be_read_stays(source: bytes | Path) -> None:
    assert renamed_skin(source, {"a": "b"}.get) is None
    assert bones(source) is None


def test_a_name_that_has_no_room_is_a_fault() -> None:
    with pytest.raises(BadBone, match="longer than the 39 bytes"):
        renamed_skin(_skin("a"), {"a": "b" * 40}.get)


def test_skins_stand_in_two_sections_and_follow_the_compiler_settings() -> None:
    root = etree.fromstring(
        '<mujoco><compiler meshdir="m"/><asset><skin file="a.skn"/><mesh file="b.obj"/></asset>'
        '<deformable><skin name="x"/><skin file="c.skn"/></deformable></mujoco>'
    )
    assert [(each.path, each.written) for each in skins(root)] == [("m/a.skn", "a.skn"), ("m/c.skn", "c.skn")]
