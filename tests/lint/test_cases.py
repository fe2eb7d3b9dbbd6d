"""For each rule a model that it finds, and nearly the same model that it does not."""

from __future__ import annotations

from pathlib import Path

import pytest
from lint.workshop import linted, mended
from mjcompose.lint.rule import rules
from mjcompose.mujoco.engine import Session

FAMILIES = ("dead", "ranges", "order", "names")


def _arm(
    actuator: str = "", key: str = "", joint: str = 'range="-1 1"', more: str = "", model: str = ' model="m"'
) -> str:
    return f"""\
<mujoco{model}>
  <compiler angle="radian"/>
  {more}
  <worldbody>
    <body name="arm">
      <joint name="a" axis="0 1 0" {joint}/>
      <geom name="g" size="0.1"/>
      <body name="hand" pos="0.5 0 0">
        <joint name="b" axis="0 1 0" range="0 2"/>
        <geom size="0.1"/>
        <site name="left_tip"/>
      </body>
    </body>
  </worldbody>
  {f"<actuator>{actuator}</actuator>" if actuator else ""}
  {f"<keyframe>{key}</keyframe>" if key else ""}
</mujoco>
"""


def _sides(left: str, right: str, left_motor: str = "", right_motor: str = "") -> str:
    """A model with a joint and a motor on each side."""
    sides = (("left", left), ("right", right))
    bodies = "".join(f'<body><joint name="{side}_hip" {text}/><geom size="1"/></body>' for side, text in sides)
    pairs = (("left", left_motor), ("right", right_motor))
    motors = "".join(f'<motor name="{side}_hip" joint="{side}_hip" {text}/>' for side, text in pairs)
    return f"<mujoco><worldbody>{bodies}</worldbody><actuator>{motors}</actuator></mujoco>"


_SERVO = '<position name="b" joint="b" kp="10" ctrlrange="{}"/>'
_ASSET = "<asset>{}</asset>"
CASES = {
    "unused-mesh": (_arm(more=_ASSET.format('<mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>')), _arm()),
    "unused-material": (_arm(more=_ASSET.format('<material name="m"/>')), _arm()),
    "unused-texture": (
        _arm(more=_ASSET.format('<texture name="t" type="2d" builtin="flat" width="8" height="8"/>')),
        _arm(more=_ASSET.format('<texture name="t" type="skybox" builtin="flat" width="8" height="8"/>')),
    ),
    "unused-hfield": (_arm(more=_ASSET.format('<hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/>')), _arm()),
    "unused-tendon": (
        _arm(more='<tendon><fixed name="t"><joint joint="a" coef="1"/></fixed></tendon>'),
        _arm(more='<tendon><fixed name="t" damping="1"><joint joint="a" coef="1"/></fixed></tendon>'),
    ),
    "dead-actuator": (
        _arm('<general name="m" joint="a" gainprm="0"/>'), _arm('<general name="m" joint="a" gainprm="1"/>'),
    ),
    "range-ignored": (
        _arm(joint='limited="false" range="-1 1"'),
        _arm(joint='limited="false"', more='<default><joint range="-1 1"/></default>'),
    ),
    "range-inverted": (_arm(joint='limited="false" range="1 -1"'), _arm(joint='limited="false" range="-1 1"')),
    "key-out-of-range": (_arm(key='<key name="k" qpos="1.2 0"/>'), _arm(key='<key name="k" qpos="1 0"/>')),
    "reference-out-of-range": (
        _arm(joint='range="0.5 1"').replace("<worldbody>", "<worldbody><light/>"),
        _arm(joint='range="0 1"').replace("<worldbody>", "<worldbody><light/>"),
    ),
    "control-misses-range": (_arm(_SERVO.format("0 1.5")), _arm(_SERVO.format("0 1.7"))),
    "solref-below-timestep": (
        _arm(joint='solreflimit="0.003 1"'), _arm(joint='solreflimit="0.003 1"', more='<option timestep="0.001"/>'),
    ),
    "quat-not-unit": (
        _arm(joint='type="ball"', key='<key name="k" qpos="0 0 0 0 1"/>'),
        _arm(joint='type="ball"', key='<key name="k" qpos="0 1 0 0 1"/>'),
    ),
    "actuator-order": (
        _arm('<motor name="b" joint="b"/><motor name="a" joint="a"/>'),
        _arm('<motor name="a" joint="a"/><motor name="b" joint="b"/>'),
    ),
    "key-does-not-hold": (
        _arm(_SERVO.format("0 2"), '<key name="k" qpos="0 1"/>'),
        _arm(_SERVO.format("0 2"), '<key name="k" qpos="0 1" ctrl="1"/>'),
    ),
    "key-breaks-equality": (
        _arm(key='<key name="k" qpos="0.5 0"/>', more='<equality><joint joint1="a" joint2="b"/></equality>'),
        _arm(key='<key name="k" qpos="0.5 0.5"/>', more='<equality><joint joint1="a" joint2="b"/></equality>'),
    ),
    "unnamed-joint": (_arm().replace('name="a" ', ""), _arm()),
    "unnamed-actuator": (_arm('<motor joint="a"/>'), _arm('<motor name="m" joint="a"/>')),
    "unnamed-sensor": (
        _arm(more='<sensor><force site="left_tip"/></sensor>'),
        _arm(more='<sensor><force name="f" site="left_tip"/></sensor>'),
    ),
    "unnamed-key": (_arm(key='<key name="k"/><key time="1"/>'), _arm(key='<key time="1"/>')),
    "unnamed-model": (_arm(model=""), _arm()),
    "awkward-name": (_arm().replace('"hand"', '"my hand"'), _arm().replace('"hand"', '"r/my-hand_1.x"')),
    "names-differ-by-case": (_arm().replace('name="b"', 'name="A"'), _arm()),
    "side-mismatch": (
        _arm(more='<sensor><force name="right_force" site="left_tip"/></sensor>'),
        _arm(more='<sensor><force name="tip_force_left" site="left_tip"/></sensor>'),
    ),
    "sides-differ": (
        _sides('range="-30 90" damping="1"', 'range="-90 25" damping="1"', 'gear="-50"', 'gear="50"'),
        _sides('range="-30 90" damping="1"', 'range="-90 30" damping="1.005"', 'gear="-50"', 'gear="50"'),
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    ("left", "right", "count"),
    [
        ('armature="0.1"', 'armature="0.2"', 1),
        ('class="soft"', 'damping="1"', 0),
        ('class="soft"', 'damping="3"', 1),
        ('type="slide" range="0 0.1"', 'type="slide" range="0 0.2"', 1),
        ('frictionloss="0.1" stiffness="3"', "", 2),
    ],
)
def test_sides_by_the_value_in_effect(left: str, right: str, count: int, tmp_path: Path, session: Session) -> None:
    soft = '<default><default class="soft"><joint damping="1"/></default></default><worldbody>'
    text = _sides(left, right).replace("<worldbody>", soft)
    assert len(linted(text, "sides-differ", tmp_path, session)) == count


def test_sides_that_are_meant_to_differ(tmp_path: Path, session: Session) -> None:
    arms = "".join(
        f'<body><joint name="{side}_{n}" damping="{damping}"/><geom size="1"/></body>'
        for side, damping in (("left", 1), ("right", 2))
        for n in range(3)
    )
    text = f"<mujoco><worldbody>{arms}</worldbody></mujoco>"
    assert not linted(text, "sides-differ", tmp_path, session)
    assert (
        len(linted(text.replace('right_1" damping="2"', 'right_1" damping="1"'), "sides-differ", tmp_path, session))
        == 0
    )
    one = text.replace('damping="2"', 'damping="1"').replace('right_1" damping="1"', 'right_1" damping="2"')
    assert len(linted(one, "sides-differ", tmp_path, session)) == 1


@pytest.mark.parametrize("code", CASES)
def test_what_a_rule_finds(code: str, tmp_path: Path, session: Session) -> None:
    wrong, right = CASES[code]
    found = linted(wrong, code, tmp_path, session)
    assert found and all(each.code == code and each.span is not None for each in found)
    assert not linted(right, code, tmp_path, session)
    if all(each.fix for each in found):
        assert not linted(mended(wrong, found), code, tmp_path, session)


def test_every_rule_of_these_families_has_a_case() -> None:
    expected = {code for code, each in rules().items() if each.family in FAMILIES}
    assert expected == {*CASES, "unused-class"}


def test_empty_keyframes_of_nkey_are_reported_once(tmp_path: Path, session: Session) -> None:
    (found,) = linted(_arm(joint='range="0.5 1"', more='<size nkey="5"/>'), "key-out-of-range", tmp_path, session)
    assert found.message.startswith("`nkey` makes empty keyframes: `qpos` of joint `a`")
