from __future__ import annotations

import mujoco
import pytest
from mjcompose import mjcf

TEXT = """
<mujoco model="cell/arm">
  <default><default class="arm/"><geom size="0.1"/></default></default>
  <worldbody>
    <body name="arm/link" childclass="arm/"><joint name="arm/j"/><geom name="plain"/><site name="arm/s"/></body>
  </worldbody>
  <actuator><motor name="arm/m" joint="arm/j"/></actuator>
  <sensor><framepos objtype="site" objname="arm/s"/></sensor>
</mujoco>
"""


def test_names_with_a_separator_are_names() -> None:
    model = mjcf.from_xml_string(TEXT)
    assert model.find("joint", "arm/j").full_identifier == "arm/j"  # type: ignore[union-attr]


def test_separators_are_escaped_in_names_and_references() -> None:
    model = mjcf.from_xml_string(TEXT, escape_separators=True)
    assert model.model == "cell\\arm" and model.find("body", "arm/link") is None
    joint = model.find("joint", "arm\\j")
    assert joint is not None and model.find("motor").joint is joint  # type: ignore[union-attr]
    assert model.find("default", "arm\\") is joint.parent.childclass  # type: ignore[union-attr]
    written = model.to_xml_string()
    assert "/" not in written.replace("/>", "").replace("</", "").replace(" /", "")
    assert mujoco.MjModel.from_xml_string(written).joint("arm\\j").id == 0
    assert model.find("geom", "plain") is not None


def test_two_names_that_would_be_one_are_told() -> None:
    text = '<mujoco>\n<worldbody><body name="a/b"/>\n<body name="a\\b"/></worldbody></mujoco>'
    with pytest.raises(mjcf.MjcfError, match=r"would be called `a\\b`, as another body is") as caught:
        mjcf.from_xml_string(text, escape_separators=True)
    (fault,) = caught.value.diagnostics
    assert fault.span is not None and fault.span.line == 2
    assert fault.notes[0].span is not None and fault.notes[0].span.line == 3


def test_an_element_prints_as_mjcf_with_what_is_in_it(arm: mjcf.RootElement) -> None:
    fore = arm.find("body", "fore")
    assert str(fore) == "\n".join(
        [
            '<body name="fore" pos="0 0 0.4">',
            '  <joint name="elbow_joint" axis="0 1 0" range="-2 2"/>',
            '  <geom name="fore" type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/>',
            '  <site name="flange" pos="0 0 0.35" quat="0.7071 0 0 0.7071"/>',
            '  <site pos="0.1 0 0.1"/>',
            "</body>",
        ]
    )
    assert fore is not None and fore.parent is arm.find("body", "upper"), "it was a copy that was written"


def test_comments_say_where_models_are_attached(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    frame = arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    assert str(arm).count("<!-- gripper/ is attached here -->") == 1
    assert "gripper" not in str(arm.find("body", "base").geom[0])  # type: ignore[union-attr]
    assert mjcf.from_xml_string(str(arm)).find("site", "flange") is not None
    frame.add("joint", name="turn")
    assert str(frame) == '<body name="gripper/">\n  <joint name="turn"/>\n</body>'
    frame.mocap = False
    assert repr(frame) == '<body name="gripper/" mocap="false">…</body>'
