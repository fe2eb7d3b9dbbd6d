"""The quick way to a model's text says what the linker says, or leaves it to the linker."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer import mjcf
from composer.mjcf.flat import copied, label, linked, name_files
from composer.mjcf.relocated import relocated_text
from composer.tree.write import to_text

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")

_QUICK = {
    "two compilers": "<mujoco><compiler meshdir='m'/><compiler angle='radian'/></mujoco>",
    "nothing": "<mujoco/>",
    "no files": "<mujoco><compiler angle='radian'/><worldbody><geom name='a' size='1'/></worldbody></mujoco>",
    "a folder": "<mujoco><compiler meshdir='m' angle='radian' assetdir='a'/><asset><mesh file='x.obj'/>"
    "<mesh file='in/y.obj'/><texture type='2d' file='z.png'/></asset></mujoco>",
    "text to escape": "<mujoco><!-- &lt; --><compiler texturedir='a&amp;\"&lt;' eulerseq='xyz'/>"
    "<asset><mesh name='&lt;&quot;&gt;' file='&amp;.obj'/></asset></mujoco>",
}
_LEFT = {
    "a comment like a file": "<mujoco><asset><!-- file=\"x\" --><mesh file='x.obj'/></asset></mujoco>",
    "a comment like a compiler": "<mujoco><!-- <compiler/> --><compiler meshdir='m' angle='radian'/></mujoco>",
    "a compiler of folders": "<mujoco><compiler meshdir='m'/></mujoco>",
    "a compiler with children": "<mujoco><compiler meshdir='m'><lengthrange/></compiler></mujoco>",
    "a compiler below": "<mujoco><option/><compiler angle='radian'/></mujoco>",
    "strippath": "<mujoco><compiler strippath='true'/><asset><mesh file='a/b.obj'/></asset></mujoco>",
    "a path to shorten": "<mujoco><asset><mesh file='../x.obj'/></asset></mujoco>",
    "one file name twice": "<mujoco><asset><mesh file='a/x.obj'/><mesh name='y' file='b/X.obj'/></asset></mujoco>",
    "sides": "<mujoco><asset><texture type='cube' fileright='r.png'/></asset></mujoco>",
    "an empty section": "<mujoco><visual><global/></visual></mujoco>",
}


def by_linker(root: mjcf.RootElement) -> str:
    flat = linked(root._model, "error", copied, check_keys=False)
    name_files(flat)
    return to_text(flat.unit.root)


def quick(root: mjcf.RootElement) -> str | None:
    return relocated_text(root._model, label(root._model))


@pytest.mark.parametrize("xml", _QUICK.values(), ids=_QUICK)
def test_the_quick_text_is_the_linkers(xml: str) -> None:
    root = mjcf.from_xml_string(xml)
    assert quick(root) == by_linker(root) == root.to_xml_string()


@pytest.mark.parametrize("xml", _LEFT.values(), ids=_LEFT)
def test_what_is_more_than_a_folder_is_left_to_the_linker(xml: str) -> None:
    root = mjcf.from_xml_string(xml)
    assert quick(root) is None
    assert root.to_xml_string() == by_linker(root)


def test_models_with_parts_and_files_from_memory_are_left_to_the_linker() -> None:
    arm, tool = mjcf.RootElement("arm"), mjcf.RootElement("tool")
    arm.attach(tool)
    assert quick(arm) is None and quick(tool) is not None
    tool.asset.add("mesh", name="m", file=mjcf.Asset(b"o m", ".obj", "m"))
    assert quick(tool) is None


def test_a_setting_that_is_written_later_counts() -> None:
    root = mjcf.from_xml_string(
        "<mujoco><compiler angle='radian' meshdir='m'/><asset><mesh file='a/x.obj'/></asset></mujoco>"
    )
    assert 'file="assets/unnamed_model/a/x.obj"' in root.to_xml_string()
    root.compiler.strippath = "true"
    assert quick(root) is None
    assert 'file="assets/unnamed_model/x.obj"' in root.to_xml_string()


@pytest.mark.skipif(FOLDER is None, reason="MJCOMPOSE_CORPUS is not set")
def test_real_models() -> None:
    assert FOLDER is not None
    taken = 0
    for path in sorted(Path(FOLDER, "models").glob("*/*.xml")):
        try:
            root = mjcf.from_path(path)
            expected = by_linker(root)
        except mjcf.MjcfError:
            continue
        found = quick(root)
        assert found in (None, expected), path
        taken += found is not None
    assert taken > 50
