"""All targets and features, and the tables in docs/how-to/simulators.md."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

from mjcompose.base.extensions import Table, check_rows
from mjcompose.targets.consumers import ALL
from mjcompose.targets.names import MUJOCO, NAMES
from mjcompose.targets.target import Outcome, Target

FEATURES: Mapping[str, str] = {
    "roots": "several bodies in the world",
    "joints": "several joints of one body",
    "ball": "ball joints",
    "references": "joints that are not at zero in the model as it is written",
    "massless": "bodies without mass",
    "damping": "damping of joints",
    "polynomials": "damping and stiffness that are not linear",
    "springs": "stiffness of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "no armature": "joints without armature",
    "effort": "limits of forces: `forcerange`, `actuatorfrcrange`",
    "shapes": "planes, ellipsoids, height fields",
    "textures": "textures",
    "sites": "sites",
    "cameras": "cameras",
    "lights": "lights",
    "collisions": "contacts between shapes of all kinds",
    "margins": "margins of contacts with meshes and height fields",
    "pairs": "contact pairs",
    "excludes": "excluded contacts",
    "equality": "equality constraints",
    "tendons": "tendons",
    "actuators": "actuators",
    "gears": "gears of actuators",
    "gains": "damping of position servos: `kv`",
    "control ranges": "ranges of the controls of position servos",
    "sensors": "sensors",
    "contact sensors": "contact sensors of all kinds",
    "keys": "keyframes",
    "soft": "flexes and skins",
    "sleep": "`sleep` of bodies",
    "plugins": "plugins",
    "gravity": "gravity that is not 0 0 -9.81",
    "gravcomp": "gravity compensation of bodies",
    "contacts": "softness, margins and friction of contacts",
    "bits": "collision filters: `contype` and `conaffinity`",
    "softness": "softness and margins of joint limits",
    "computing": "time step, integrator, friction cone, medium, flags",
    "options": "all integrators and solvers",
    "custom": "custom numbers, texts and tuples",
}
"""By name: words for people."""

COMPARED: Mapping[str, str] = {
    "inertia": "masses, centers of mass, inertias",
    "poses": "poses of all bodies in 50 configurations",
    "limits": "limits of joints",
    "damping": "damping of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "springs": "stiffness of joints",
    "effort": "greatest forces of joints and actuators",
    "actuators": "joint of each actuator",
    "gains": "gains of servos",
    "shapes": "number of geoms of each type",
    "motion": "0.2 s of motion from the key `home`",
}
"""The words for quantities that are compared when a model is read back, by name."""


TARGETS: Table[Target] = Table("targets", {each.name: each for each in ALL}, "TARGET", kind=Target)

check_rows("the targets of composer/mjcompose/targets/table.py", [MUJOCO, *TARGETS.own], NAMES)
check_rows(
    "the features of composer/mjcompose/targets/table.py",
    FEATURES,
    dict.fromkeys(limit.feature for target in TARGETS.values() for limit in target.limits),
)


_ROOT = Path(__file__).resolve().parents[3]
PAGE = _ROOT / "docs" / "how-to" / "simulators.md"
READ_BACK = _ROOT / "tests" / "targets" / "read_back.json"
"""The features that the programs have read, by `tests/targets/read_back.py`."""


_CELLS: Mapping[Outcome, str] = {
    Outcome.KEPT: "", Outcome.WRITTEN: "rewritten", Outcome.PARTLY: "partly", Outcome.LEFT_OUT: "no",
    Outcome.SOME_REFUSED: "some", Outcome.REFUSED: "error",
}  # fmt: skip


def features() -> str:
    """Return the table with a row for each feature that some target does not support. Other cells are empty."""
    lines = [f"| feature | {' | '.join(TARGETS)} |", f"|---|{'---|' * len(TARGETS)}"]
    outcomes = {name: {limit.feature: limit.outcome for limit in target.limits} for name, target in TARGETS.items()}
    for feature, words in FEATURES.items():
        cells = [outcomes[name].get(feature, Outcome.KEPT) for name in TARGETS]
        if set(cells) != {Outcome.KEPT}:
            lines.append(f"| {words} | {' | '.join(_CELLS[each] for each in cells)} |")
    return "\n".join(lines) + "\n"


def read_back() -> str:
    """Return the table of comparisons."""
    found = json.loads(READ_BACK.read_text(encoding="utf-8"))
    lines = [f"| compared | {' | '.join(found)} |", f"|---|{'---|' * len(found)}"]
    lines.append(f"| version | {' | '.join(each['version'] for each in found.values())} |")
    for feature, words in COMPARED.items():
        lines.append(f"| {words} | {' | '.join(each.get(feature, '') for each in found.values())} |")
    return "\n".join(lines) + "\n"


def with_tables(page: str) -> str:
    for name, table in (("features", features()), ("read back", read_back())):
        inside = re.compile(rf"(?<=<!-- {name} -->\n).*?(?=<!-- end of {name} -->)", re.DOTALL)
        page = inside.sub(table.replace("\\", r"\\"), page)
    return page


if __name__ == "__main__":
    PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
