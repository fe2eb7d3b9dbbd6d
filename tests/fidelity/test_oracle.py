"""Random compositions, judged by an oracle that shares no code with `verify`. 1,000 cases, of which 60 are quick."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from fidelity.oracle import composed, differences_in
from fidelity.random_parts import random_case
from lxml import etree
from mjcompose.mujoco.engine import Session

QUICK = 60
ALL = int(os.environ.get("MJCOMPOSE_EXAMPLES", "1000"))
CHUNK = 100


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as found:
        yield found


def differences(seed: int, folder: Path, session: Session) -> list[str]:
    """Build a case, and return how its parts differ from themselves alone."""
    case = random_case(seed)
    text = composed(case, folder, session)
    return [f"is not built: {text}"] if isinstance(text, str) else differences_in(case, text, seed)


def judge(seeds: range, folder: Path, session: Session) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        wrong = {seed: found[:3] for seed in seeds if (found := differences(seed, folder, session))}
    assert not wrong


def test_parts_do_what_they_do_alone(tmp_path: Path, session: Session) -> None:
    judge(range(QUICK), tmp_path, session)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, ALL, CHUNK))
def test_many_parts_do_what_they_do_alone(tmp_path: Path, session: Session, start: int) -> None:
    judge(range(start, min(ALL, start + CHUNK)), tmp_path, session)


FEATURES = (
    "<flexcomp",
    "<skin",
    "<hfield",
    "<mesh",
    "<plugin",
    "<exclude",
    "<pair",
    "contype=",
    "<tuple",
    "<numeric",
    "<spatial",
    "<connect",
    "<weld",
    'refname="world"',
    "freejoint",
    "mocap=",
    'class="own"',
    "settotalmass",
    "boundinertia",
    "gravcomp",
    "matrix:",
    "replicate:",
    "base: ./p.xml",
    "joint: {axis",
    "keys: prefix",
)


def test_the_quick_cases_have_everything() -> None:
    texts = "".join(text for seed in range(QUICK) for text in random_case(seed).files.values())
    missing = [feature for feature in FEATURES if feature not in texts]
    assert missing == []


DAMAGES = {
    "body pos": ("worldbody//body", "pos", "0.01 0.02 0.03"),
    "body quat": ("worldbody//body", "quat", "0.8 0 0.6 0"),
    "mass": ("worldbody//inertial", "mass", "7"),
    "inertia": ("worldbody//inertial", "diaginertia", "0.09 0.08 0.07"),
    "joint axis": ("worldbody//joint", "axis", "0.3 0.4 0.5"),
    "joint damping": ("worldbody//joint", "damping", "11"),
    "joint stiffness": ("worldbody//joint", "stiffness", "17"),
    "gravity compensation": ("worldbody//body", "gravcomp", "0.77"),
    "contact filter": ("worldbody//geom", "contype", "9"),
    "friction": ("worldbody//geom", "friction", "0.33 0.01 0.001"),
    "site": ("worldbody//site", "pos", "0.5 0.6 0.7"),
    "coefficient of a tendon": ("tendon/fixed/joint", "coef", "5.5"),
    "spring of a tendon": ("tendon/spatial", "stiffness", "8"),
    "gear": ("actuator/motor", "gear", "3.3"),
    "gain": ("actuator/position", "kp", "71"),
    "polynomial of an equality": ("equality/joint", "polycoef", "0.9 0.1 0 0 0"),
    "anchor": ("equality/connect", "anchor", "3 3 3"),
    "object of a sensor": ("sensor/framepos", "objtype", "xbody"),
    "reference of a sensor": ("sensor/framepos", "refname", "column"),
    "key": ("keyframe/key", "qpos", None),
    "control in a key": ("keyframe/key", "ctrl", None),
    "skin": ("deformable/skin/bone", "bindpos", "4 4 4"),
    "height field": ("asset/hfield", "elevation", "1 2 3 4 5 6 7 8 1"),
    "mesh": ("asset/mesh", "vertex", "0 0 0 1 0 0 0 1 0 0 0 1"),
    "flex": ("worldbody//flexcomp", "radius", "0.02"),
    "vertices of a flex": ("worldbody//flexcomp", "spacing", ".2 .1 .1"),
    "plugin": ("extension//config", "value", "31"),
    "number": ("custom/numeric", "data", "9 9 9"),
    "tuple": ("custom/tuple/element", "objname", "column"),
    "exclude": ("contact/exclude", "body1", "column"),
}
"""Changes of one attribute of a part in a composition; without a value, each number grows by 0.01."""


TRIALS = 6
"""The number of damaged cases of which one must be found: some damages change nothing, such as a pose of a free body."""


@pytest.mark.parametrize(("path", "attribute", "value"), DAMAGES.values(), ids=DAMAGES.keys())
def test_a_damage_is_found(tmp_path: Path, session: Session, path: str, attribute: str, value: str | None) -> None:
    """Change an attribute of such an element in the first cases that have one, and judge."""
    trials = 0
    for seed in range(400):
        case = random_case(seed)
        parts = "".join(text for name, text in case.files.items() if name != "arm.xml")
        if f"<{path.rpartition('/')[2]} " not in parts:
            continue
        text = composed(case, tmp_path, session)
        assert isinstance(text, bytes)
        damaged = _damaged(text, path, attribute, value)
        if damaged is None:
            continue
        trials += 1
        try:
            found = differences_in(case, damaged, seed)
        except ValueError:  # MuJoCo does not take it
            continue
        if found:
            return
        if trials == TRIALS:
            break
    pytest.fail("the damage is not found")


def _damaged(text: bytes, path: str, attribute: str, value: str | None) -> bytes | None:
    root = etree.fromstring(text)
    for element in reversed(root.findall(path)):
        around = [element, *element.iterancestors()]
        of_part = element.tag in ("key", "config") or any("/" in str(each.get("name")) for each in around)
        written = element.get(attribute)
        if not of_part or (
            written is None and attribute not in ("damping", "stiffness", "contype", "gravcomp", "friction")
        ):
            continue
        element.set(attribute, value or " ".join(str(float(number) + 0.01) for number in str(written).split()))
        return etree.tostring(root)
    return None
