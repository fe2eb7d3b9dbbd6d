"""Skin files have names of bodies in them."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from composer import mjcf


def _skin(body: str) -> bytes:
    """A triangle on one bone."""
    return b"".join(
        (
            struct.pack("<4i", 3, 0, 1, 1),
            struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0),
            struct.pack("<3i", 0, 1, 2),
            body.encode().ljust(40, b"\0"),
            struct.pack("<7f", 0, 0, 0, 1, 0, 0, 0),
            struct.pack("<i3i3f", 3, 0, 1, 2, 1, 1, 1),
        )
    )


def _model(body: str = "b", name: str = "doll") -> mjcf.RootElement:
    model = mjcf.RootElement(name)
    model.worldbody.add("body", name=body).add("geom", size=[1])
    model.asset.add("skin", name="coat", file=mjcf.Asset(_skin(body), ".skn", "coat"))
    return model


def test_a_bone_follows_its_body() -> None:
    model = _model()
    model.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    assert model.compile_model().model.nskin == 1
    assert model.find("skin", "coat").file.contents == _skin("trunk")  # type: ignore[union-attr]


def test_a_file_on_disk_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "coat.skn").write_bytes(_skin("b"))
    (tmp_path / "doll.xml").write_text(
        '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody>'
        '<deformable><skin file="coat.skn"/></deformable></mujoco>'
    )
    model = mjcf.from_path(tmp_path / "doll.xml")
    model.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    assert model.compile_model().model.skin_bonebodyid.tolist() == [1]
    assert (tmp_path / "coat.skn").read_bytes() == _skin("b")


def test_a_bone_in_an_attached_model_and_in_the_one_above() -> None:
    scene, doll = _model("doll/b", "scene"), _model()
    with pytest.raises(mjcf.MjcfError, match="which would have two"):
        scene.attach(doll)
    scene.worldbody.body["doll/b"].remove()
    scene.attach(doll)
    doll.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    doll.model = "puppet"
    assert scene.compile_model().model.nskin == 2
    assert scene.find("skin", "coat").file.contents == _skin("puppet/trunk")  # type: ignore[union-attr]


def test_a_name_that_has_no_room_in_the_file_changes_nothing() -> None:
    model = _model()
    before = str(model)
    with pytest.raises(mjcf.MjcfError, match="longer than the 39 bytes of a skin file"):
        model.find("body", "b").name = "b" * 40  # type: ignore[union-attr]
    assert str(model) == before and model.compile_model().model.nskin == 1


def test_a_bone_with_a_separator_is_escaped(tmp_path: Path) -> None:
    mjcf.export_with_assets_as_zip(_model("doll/b"), tmp_path / "doll.zip")
    model = mjcf.from_zip(tmp_path / "doll.zip", escape_separators=True)
    assert model.find("skin", "coat").file.contents == _skin("doll\\b")  # type: ignore[union-attr]


def test_a_file_that_is_no_skin_is_told_by_mujoco_as_before() -> None:
    model = _model()
    model.find("skin", "coat").file = mjcf.Asset(b"nothing", ".skn", "coat")  # type: ignore[union-attr]
    model.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError, match="skin"):
        model.compile_model()
