"""The arrays of `mjModel` whose numbers stand for words, and these words in MJCF."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

ENUMS: Mapping[str, tuple[str, str]] = {
    "jnt_type": ("mjtJoint", "mjJNT_"),
    "geom_type": ("mjtGeom", "mjGEOM_"),
    "site_type": ("mjtGeom", "mjGEOM_"),
    "cam_mode": ("mjtCamLight", "mjCAMLIGHT_"),
    "light_mode": ("mjtCamLight", "mjCAMLIGHT_"),
    "light_type": ("mjtLightType", "mjLIGHT_"),
    "tex_type": ("mjtTexture", "mjTEXTURE_"),
    "eq_type": ("mjtEq", "mjEQ_"),
    "sensor_type": ("mjtSensor", "mjSENS_"),
    "actuator_dyntype": ("mjtDyn", "mjDYN_"),
    "actuator_gaintype": ("mjtGain", "mjGAIN_"),
    "actuator_biastype": ("mjtBias", "mjBIAS_"),
    "actuator_trntype": ("mjtTrn", "mjTRN_"),
}
"""By array: MuJoCo's enumeration, and the prefix of its members."""

SWITCHES = frozenset(
    "limited actgravcomp actlimited ctrllimited forcelimited actfrclimited active0 actearly castshadow active"
    " texuniform mocapid".split()
)
"""The suffixes of arrays that are booleans; `body_mocapid` is -1 for no."""

# Sensors whose tag differs from the name in MuJoCo's enumeration.
_TAGS = {
    "geomdist": "distance",
    "geomnormal": "normal",
    "geomfromto": "fromto",
    "jointactfrc": "jointactuatorfrc",
    "tendonactfrc": "tendonactuatorfrc",
}


@cache
def words(mujoco: Any, array: str) -> Mapping[int, str]:
    """Return the words of an array by their numbers; for `sensor_type` these are the tags of sensors."""
    enumeration, prefix = ENUMS[array]
    members: Mapping[str, Any] = getattr(mujoco, enumeration).__members__
    found = {
        int(value): name.removeprefix(prefix).lower()
        for name, value in members.items()
        if name.startswith(prefix)
    }
    return {
        number: _TAGS.get(name, name) if array == "sensor_type" else name for number, name in found.items()
    }
