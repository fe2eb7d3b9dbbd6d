"""Pass: give an actuator the tag `motor`, `position` or `velocity` if it does what one of these does."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.grammar import GRAMMAR

_DYNAMICS = ("dyntype", "dynprm", "actrange", "actlimited", "actdim", "actearly")
_MOTOR = {
    *GRAMMAR.element("actuator/motor").attributes,
    "gaintype",
    "gainprm",
    "biastype",
    "biasprm",
    "input",
}
_GAIN = ("gaintype", "gainprm", "biastype", "biasprm", "input")


def simple_actuators(root: Node, *, any_input: bool = False) -> None:
    """Rename each `general` actuator that has a simpler form.

    MuJoCo 4 records what the control of an actuator means. With `any_input`, its gains alone decide whether it is a
    servo.

    >>> from lxml import etree
    >>> servo = '<general joint="j" biastype="affine" gainprm="5" biasprm="0 -5 -1"/>'
    >>> root = etree.fromstring(f"<mujoco><actuator>{servo}</actuator></mujoco>")
    >>> simple_actuators(root, any_input=True)
    >>> etree.tostring(root[0][0])
    b'<position joint="j" kp="5" kv="1"/>'
    """
    unsaid = "" if any_input else "pos"
    for actuator in list(root.iterfind("actuator/general")):
        if any(actuator.get(name) for name in _DYNAMICS) or actuator.get("gaintype", "fixed") != "fixed":
            continue
        gain, bias = _numbers(actuator, "gainprm", 1.0), _numbers(actuator, "biasprm", 0.0)
        affine = actuator.get("biastype", "none") == "affine"
        said = actuator.get("input", "")
        if any(gain[1:]) or any(bias[3:]) or not _MOTOR.issuperset(map(str, actuator.keys())):
            continue
        if not affine and gain[0] == 1 and actuator.get("biastype", "none") == "none" and not said:
            _rename(actuator, "motor", {})
        elif affine and said in ("pos", unsaid) and _is_position(gain[0], bias):
            kv = {"kv": -bias[2]} if bias[2] else {}
            _rename(actuator, "position", {"kp": gain[0], **kv})
        elif (
            affine
            and not bias[0]
            and not bias[1]
            and bias[2] == -gain[0]
            and said in ("vel", unsaid and "vel")
        ):
            _rename(actuator, "velocity", {"kv": gain[0]})


def _is_position(gain: float, bias: list[float]) -> bool:
    return not bias[0] and bias[1] == -gain and gain > 0 and bias[2] <= 0


def _rename(actuator: Node, tag: str, values: dict[str, float]) -> None:
    actuator.tag = tag
    for name in _GAIN:
        actuator.attrib.pop(name, "")
    for name, value in values.items():
        actuator.set(name, f"{value!r}".removesuffix(".0"))


def _numbers(actuator: Node, name: str, first: float) -> list[float]:
    written = [float(each) for each in (actuator.get(name) or "").split()]
    return [*written, *([first, 0.0, 0.0])[len(written) :]]
