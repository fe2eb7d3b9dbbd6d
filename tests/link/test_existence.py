"""The net of existence: an element that vanishes or multiplies is an error at the line that wrote it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from link.workshop import OLDER
from lxml import etree
from mjcompose.compose import compose
from mjcompose.link.existence import WrittenElements
from mjcompose.mujoco.attributes import KINDS, all_names
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

EVERY_KIND = """<mujoco>
  <extension><plugin plugin="mujoco.pid"><instance name="p"><config key="kp" value="1"/></instance></plugin></extension>
  <custom><numeric name="n" data="1"/><text name="t" data="x"/>
    <tuple name="u"><element objtype="body" objname="b"/></tuple></custom>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/>
    <texture name="x" type="2d" builtin="flat" width="2" height="2"/><material name="a" texture="x"/></asset>
  <worldbody><light name="l"/><camera name="c"/>
    <body name="b"><joint name="j"/><geom name="g" size=".1"/><site name="s"/><geom type="mesh" mesh="m"/></body>
    <body name="d" pos="1 0 0"><freejoint name="f"/><geom name="k" size=".1"/></body>
    <body name="cloth"><flexcomp name="w" type="grid" count="2 2 1" dim="2" rigid="true" radius=".01"/></body></worldbody>
  <deformable><skin name="i" vertex="0 0 0 1 0 0 0 1 0" face="0 1 2">
    <bone body="b" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/></skin></deformable>
  <contact><pair name="pair" geom1="g" geom2="k"/><exclude name="e" body1="b" body2="d"/></contact>
  <tendon><fixed name="y"><joint joint="j" coef="1"/></fixed></tendon>
  <equality><weld name="q" body1="b" body2="d"/></equality>
  <actuator><plugin name="o" plugin="mujoco.pid" instance="p" joint="j"/><motor name="v" joint="j"/></actuator>
  <sensor><jointpos name="z" joint="j"/></sensor>
  <keyframe><key name="r"/></keyframe>
</mujoco>"""
KINDS_THERE = tuple(KINDS)


@pytest.fixture(scope="module")
def every_kind() -> tuple[WrittenElements, dict[str, list[str]]]:
    root = etree.fromstring(EVERY_KIND)
    return WrittenElements.of(root), all_names(mujoco.MjModel.from_xml_string(EVERY_KIND))


def test_a_model_with_every_kind_has_no_fault(every_kind: tuple[WrittenElements, dict[str, list[str]]]) -> None:
    written, names = every_kind
    assert all(names[kind] for kind in KINDS)
    assert list(written.faults(names)) == []


@pytest.mark.parametrize("kind", KINDS_THERE)
def test_an_element_of_any_kind_that_vanishes_is_found(
    every_kind: tuple[WrittenElements, dict[str, list[str]]], kind: str
) -> None:
    written, names = every_kind
    (fault,) = written.faults({**names, kind: names[kind][:-1]})
    assert (fault.kind, fault.names, fault.is_missing) == (kind, (names[kind][-1],), True)
    assert fault.element is not None
    assert fault.element.get("name", "") == names[kind][-1]


@pytest.mark.parametrize("kind", KINDS_THERE)
def test_an_element_of_any_kind_that_multiplies_is_found(
    every_kind: tuple[WrittenElements, dict[str, list[str]]], kind: str
) -> None:
    written, names = every_kind
    name = names[kind][-1]
    (fault,) = written.faults({**names, kind: [*names[kind], f"{name}0"]})
    assert (fault.kind, fault.names, fault.is_missing) == (kind, (f"{name}0",), False)
    assert fault.element is not None
    assert fault.element.get("name", "") == name


@pytest.mark.parametrize(("setting", "gone"), [("discardvisual", {"geom", "material"}), ("fusestatic", {"body"})])
def test_what_a_setting_drops_is_no_fault(setting: str, gone: set[str]) -> None:
    text = f"""<mujoco><compiler {setting}="true"/><asset><material name="m"/></asset><worldbody><body name="b">
      <geom name="g" size=".1" material="m" contype="0" conaffinity="0"/><body name="c"><joint/><geom size=".1"/></body>
      </body></worldbody></mujoco>"""
    names = all_names(mujoco.MjModel.from_xml_string(text))
    written = WrittenElements.of(etree.fromstring(text))
    lost = {
        kind for kind, rows in written.elements.items() if len(rows) > len([n for n in names[kind] if n != "world"])
    }
    assert lost == gone
    assert list(written.faults(names)) == []


GENERATING = {
    "flexcomp": '<body name="b"><flexcomp name="w" type="grid" count="2 2 1" dim="2" radius=".01" mass="1"><edge equality="true"/></flexcomp></body>',
    "flexcomps in a replicate": '<replicate count="2" offset="2 0 0"><body name="b"><flexcomp name="w" type="grid" count="2 2 1" dim="2" radius=".01" mass="1"/></body></replicate>',
}


@pytest.mark.parametrize("world", GENERATING.values(), ids=GENERATING.keys())
def test_what_mujoco_generates_is_no_fault(world: str) -> None:
    if OLDER and "replicate" in world:
        pytest.skip("MuJoCo 3 has no flexes in replicates")
    text = f"<mujoco><worldbody>{world}</worldbody></mujoco>"
    names = all_names(mujoco.MjModel.from_xml_string(text))
    written = WrittenElements.of(etree.fromstring(text))
    assert list(written.faults(names)) == []
    assert [fault.names for fault in written.faults({**names, "flex": []})]


def test_keys_that_size_requests_are_no_fault() -> None:
    text = '<mujoco><size nkey="3"/><worldbody/><keyframe><key name="a"/></keyframe></mujoco>'
    names = all_names(mujoco.MjModel.from_xml_string(text))
    assert len(names["key"]) == 3
    written = WrittenElements.of(etree.fromstring(text))
    assert list(written.faults(names)) == []
    assert [fault.number for fault in written.faults({**names, "key": [*names["key"], ""]})] == [1]


BALL = """<mujoco model="balls"><worldbody><body name="bar" pos="0 0 2"><joint name="swing"/><geom size=".1"/></body>
  <replicate count="3" offset=".5 0 0"><body name="ball"><freejoint/><geom size=".05"/></body></replicate>
</worldbody></mujoco>"""
SNAKE = """<mujoco model="snake"><worldbody><body name="l"><joint name="j1"/><joint name="j10" axis="1 0 0"/>
  <geom size=".1"/></body></worldbody><actuator><motor name="m" joint="j1"/></actuator>
<sensor><jointpos name="s" joint="j1"/></sensor></mujoco>"""
HANG = "base: ./m.xml\nequality:\n  hang: {type: connect, body1: ball, body2: bar, anchor: [0, 0, 0.3]}\n"
MARKS = "base: ./m.xml\nadd:\n  - {to: world, replicate: {count: 2, offset: [0, 1, 0], site: {name: mark}}}\n"


@pytest.mark.parametrize(
    ("mend", "model", "recipe", "places"),
    [("crossings", BALL, HANG, ["recipe.yaml:5:3"]), ("spare_added", SNAKE, MARKS, ["m.xml:2:49", "m.xml:3:9"])],
)
@pytest.mark.parametrize("mended", [True, False])
def test_it_finds_what_a_missing_mend_loses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mend: str, model: str, recipe: str, places: list[str], mended: bool
) -> None:
    if not mended:
        monkeypatch.setattr(compose, mend, lambda linking: None)
    (tmp_path / "m.xml").write_text(model)
    (tmp_path / "recipe.yaml").write_text(f"recipe: 1\nallow: [license-missing]\n{recipe}")
    context = Context(environment={}, folder=tmp_path)
    found = build(ModelRequest(tmp_path / "recipe.yaml"), context)
    assert (found is not None) is mended
    reported = [(str(each.span), each.code) for each in context.sink.sorted()]
    assert reported == ([] if mended else [(place, "not-as-written") for place in places])
