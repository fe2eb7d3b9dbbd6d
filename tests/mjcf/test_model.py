from __future__ import annotations

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from mjcompose import mjcf
from mjcompose.mjcf import model as html
from mjcompose.mjcf.physics import picture

_WITH_PICTURE = """
from mjcompose import mjcf
model = mjcf.RootElement()
model.worldbody.add("geom", size=[1])
print(model._repr_html_())
"""
_PROBE = "import mujoco; mujoco.Renderer(mujoco.MjModel.from_xml_string('<mujoco/>'), 8, 8)"


class _Text(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.found.append(data)


def text(page: str) -> str:
    """What a browser shows, of a page that is well-formed."""
    parser = _Text()
    parser.feed(page)
    assert parser.open == []
    return "".join(parser.found)


def test_a_tree_shows_the_element_and_what_is_in_it() -> None:
    model = mjcf.RootElement()
    body = model.worldbody.add("body", name="a & b")
    body.add("geom", size=[1])
    shown = body._repr_html_()
    assert text(shown) == '<body name="a & b"><geom size="1"/>'
    assert "&amp;" in shown and "<details open>" in shown


def test_attached_models_are_shown_where_they_hang(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    site = arm.find("site", "flange")
    assert site is not None
    site.attach(gripper).add("joint", name="turn")
    shown = text(html.page(arm._model, arm._node))
    assert re.search(r'<site name="flange"[^>]*>gripper/ is attached here:<joint name="turn"/><mujoco', shown)
    assert text(site._repr_html_()).endswith('ctrl="0.03"/>')


def test_of_a_large_model_a_part_is_shown_and_the_rest_counted() -> None:
    model = mjcf.RootElement()
    for _ in range(html.SHOWN + 100):
        model.worldbody.add("geom", size=[1])
    shown = text(html.page(model._model, model._node))
    assert shown.count("<geom") == html.SHOWN - 2 and "… and 102 more elements" in shown


def test_what_cannot_be_compiled_has_a_tree_all_the_same(arm: mjcf.RootElement) -> None:
    arm.find("joint", "shoulder").remove()  # type: ignore[union-attr]
    assert picture(arm._model) is None and text(arm._repr_html_()).startswith('<mujoco model="arm">')
    assert picture(mjcf.RootElement()._model) is None


def test_a_whole_model_has_a_picture_where_there_is_opengl(repository: Path) -> None:
    environment = {**os.environ, "MUJOCO_GL": "egl", "PYTHONPATH": str(repository)}
    if subprocess.run([sys.executable, "-c", _PROBE], capture_output=True, env=environment).returncode:
        pytest.skip("MuJoCo cannot render by EGL here")
    command = [sys.executable, "-c", _WITH_PICTURE]
    shown = subprocess.run(command, capture_output=True, text=True, env=environment, check=True).stdout
    assert '<img alt="unnamed_model" src="data:image/png;base64,iVBOR' in shown


def test_without_opengl_there_is_the_tree(repository: Path) -> None:
    environment = {**os.environ, "MUJOCO_GL": "disable", "PYTHONPATH": str(repository)}
    command = [sys.executable, "-c", _WITH_PICTURE]
    shown = subprocess.run(command, capture_output=True, text=True, env=environment, check=True).stdout
    assert "<img" not in shown and text(shown.strip()).startswith("<mujoco>")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere, OpenGL needs no display")
def test_without_a_display_the_next_models_have_their_trees_too(repository: Path) -> None:
    kept = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment = {**kept, "MUJOCO_GL": "glfw", "PYTHONPATH": str(repository)}
    command = [sys.executable, "-c", 2 * _WITH_PICTURE]
    shown = subprocess.run(command, capture_output=True, text=True, env=environment, check=True).stdout
    assert "<img" not in shown and text(shown).count("<mujoco>") == 2


def test_what_stands_very_deep_is_counted() -> None:
    model = mjcf.RootElement()
    body = model.worldbody
    for number in range(1500):
        body = body.add("body", name=f"b{number}")
    assert len(text(model.worldbody._repr_html_())) < 5000
    assert text(model.worldbody._repr_html_()).endswith("… 1400 elements")
    outer = mjcf.RootElement("outer")
    rest = mjcf.RootElement("rest")
    outer.worldbody.add("body")
    for number in range(html.SHOWN):
        outer.worldbody.add("geom", name=f"g{number}", size=[1])
    rest.worldbody.add("geom", size=[1])
    outer.attach(rest)
    assert text(outer.worldbody._repr_html_()).endswith("… and 5 more elements")
