"""The gains of motors and servos, and their place in `mjModel`.

MuJoCo computes force = gainprm[0] * input + biasprm[0] + biasprm[1] * length + biasprm[2] * velocity if the gain is
fixed and the bias affine. The tags `motor`, `position` and `velocity` are special cases of that.
"""

from __future__ import annotations

from collections.abc import Mapping

from composer.compiled.kinds import Model

FIXED, NO_BIAS, AFFINE = 0, 0, 1
"""The first is a value of `actuator_gaintype`, the others are values of `actuator_biastype`."""

GAINS: Mapping[tuple[str, str], tuple[tuple[str, int, int], ...]] = {
    ("position", "kp"): (("actuator_gainprm", 0, 1), ("actuator_biasprm", 1, -1)),
    ("position", "kv"): (("actuator_biasprm", 2, -1),),
    ("velocity", "kv"): (("actuator_gainprm", 0, 1), ("actuator_biasprm", 2, -1)),
}
"""By tag and attribute: the arrays that store it, with column and sign."""


def is_by_plugin(model: Model, actuator: int) -> bool:
    """Return whether a plugin computes the force. MuJoCo 4.0 then stores the gain 1 and no bias, which mean nothing."""
    return len(model.actuator_plugin) > 0 and int(model.actuator_plugin[actuator]) >= 0


def servo(model: Model, actuator: int) -> dict[str, float] | None:
    """Return the gains by name: `gain` of a motor, `kp` and `kv` of a position servo, `kv` of a velocity servo.

    Return None for any other actuator. `kp` is in N/m or N·m/rad, `kv` in N·s/m or N·m·s/rad if the gear is 1.
    """
    if is_by_plugin(model, actuator):
        return None
    gain, bias = float(model.actuator_gainprm[actuator, 0]), model.actuator_biasprm[actuator, :3].tolist()
    kinds = int(model.actuator_gaintype[actuator]), int(model.actuator_biastype[actuator])
    if kinds == (FIXED, NO_BIAS):
        return {"gain": gain}
    if kinds != (FIXED, AFFINE) or bias[0]:
        return None
    if bias[1] == -gain and gain:
        return {"kp": gain, "kv": -bias[2]}
    if bias[1] == 0 and bias[2] == -gain:
        return {"kv": gain}
    return None
