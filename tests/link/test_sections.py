from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop

PARTS = """
<mujoco>
  <!-- a comment -->
  <contact><exclude name="e" body1="world" body2="b"/></contact>
  <worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="m1" joint="j"/></actuator>
  <sensor><clock name="s1"/></sensor>
  <actuator><!-- another --><motor name="m2" joint="j"/></actuator>
  <custom><text name="t" data="x"/></custom>
  <sensor><jointpos name="s2" joint="j"/></sensor>
</mujoco>
"""
PID = """<mujoco><extension><plugin plugin="mujoco.pid"><instance name="{name}"><config key="kp" value="{kp}"/></instance>
  </plugin></extension><worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><plugin joint="j" instance="{name}"/></actuator></mujoco>"""


def test_elements_follow_those_of_the_base_in_their_order(workshop: Workshop) -> None:
    model = workshop.link(PARTS, Piece(PARTS, "a/"), Piece(PARTS, "b/")).check()
    actuators = [model.actuator(at).name for at in range(model.nu)]
    assert actuators == ["m1", "m2", "a/m1", "a/m2", "b/m1", "b/m2"]
    assert [model.sensor(at).name for at in range(3)] == ["s1", "s2", "a/s1"]


def test_sections_that_the_base_lacks_are_made(workshop: Workshop) -> None:
    workshop.link("<mujoco/>", PARTS).check()


def test_of_several_sections_of_the_base_the_last_is_added_to(workshop: Workshop) -> None:
    linked = workshop.link(PARTS, PARTS.replace("m2", "m3"))
    first, last = linked.linking.base.root.findall("actuator")
    assert [element.get("name") for element in first] == ["m1"]
    assert [element.get("name") for element in last.iterchildren("*")] == ["m2", "part/m1", "part/m3"]


def test_a_plugin_is_declared_once(workshop: Workshop) -> None:
    linked = workshop.link(
        PID.format(name="one", kp=1),
        Piece(PID.format(name="one", kp=2), "a/"),
        Piece(PID.format(name="two", kp=3), "b/"),
    )
    linked.check()
    assert linked.xml.count('<plugin plugin="mujoco.pid">') == 1
    instances = [instance.get("name") for instance in linked.linking.base.root.iter("instance")]
    assert instances == ["one", "a/one", "b/two"]


def test_a_plugin_that_the_base_lacks_is_declared(workshop: Workshop) -> None:
    workshop.link(
        BASE, Piece(PID.format(name="one", kp=2), "a/"), Piece(PID.format(name="one", kp=3), "b/")
    ).check()


@pytest.mark.parametrize("tag", ["motor", "jointpos", "text", "exclude", "instance"])
def test_what_moved_is_told_from_its_own_file(workshop: Workshop, tag: str) -> None:
    included = PARTS.replace("<mujoco>", "<mujocoinclude>").replace("</mujoco>", "</mujocoinclude>")
    plugin = PID.format(name="p", kp=1).split("<worldbody>")[0].removeprefix("<mujoco>")
    part = f'<mujoco>{plugin}\n<include file="sub/i.xml"/></mujoco>'
    linked = workshop.link(PID.format(name="q", kp=1), Piece(part, files={"sub/i.xml": included}))
    base = linked.linking.base
    found = [element for element in base.root.iter(tag) if str(element.get("name")).startswith("part/")]
    assert found
    folder = linked.paths[1].parent
    for element in found:
        expected = linked.paths[1] if tag == "instance" else folder / "sub" / "i.xml"
        span = linked.linking.span(base, element)
        assert span.file == str(expected)
        line = expected.read_text().splitlines()[span.line - 1]
        assert line[span.column - 1 :].startswith(f"<{tag}")
