from __future__ import annotations

from composer import mjcf


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
