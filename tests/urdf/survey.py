"""Every URDF of a folder as mjcompose reads it, beside MuJoCo's own reader and Pinocchio.

`python tests/urdf/survey.py --write` measures the robots of the package `example-robot-data`, which `make test-targets`
fetches, and writes the table of `docs/contributing/fidelity.md`.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from mjcompose.base.access import Door  # noqa: E402
from mjcompose.base.sink import Sink  # noqa: E402
from mjcompose.link.measure import folder_of  # noqa: E402
from mjcompose.mujoco.engine import Session  # noqa: E402
from mjcompose.sources.kinds import PATH  # noqa: E402
from mjcompose.sources.reference import Source  # noqa: E402
from mjcompose.sources.ros import UrdfChoices  # noqa: E402
from mjcompose.targets.read_back import READERS, read_back  # noqa: E402
from mjcompose.tree.xml_text import write  # noqa: E402
from mjcompose.urdf.inertia import reads_turned  # noqa: E402
from mjcompose.urdf.read import UrdfReader  # noqa: E402
from targets.environments import FOLDER, is_ready, python_of  # noqa: E402

POSES = 50
TOLERANCE = 1e-6
"""Of meters, kilograms, and the largest moment of a body. Pinocchio adds up what is fixed together in another order."""
READS_TURNED = reads_turned(mujoco, None)
"""Not MuJoCo 3.12 and 3.13, whose own reader cannot judge inertias."""
PAGE = ROOT / "docs" / "contributing" / "fidelity.md"
BEGIN = "<!-- robots -->\n"
END = "<!-- end -->"
SHOWN = tuple(
    f"/{name}.urdf"
    for name in (
        "a1 alex_sake_hands alexander_v1.lowerBodyOnly allegro_left_hand anymal TwoDofs b1-z1 baxter bolt borinot_flying_arm_2"
        " centauro double_pendulum finger_edu g1_29dof_with_hand_rev_1_0 go1 go2 quadrotor_base hextilt_flying_arm_5 human"
        " hyq_no_sensors icub_reduced iris kinova laikago panda pr2 quadruped romeo_small simple_humanoid so100 so101 solo12"
        " talos_reduced tiago tiago_pro ur5_robot ur10_robot xarm7 z1"
    ).split()
)
QUICK = ("panda_description/urdf/panda", "tiago_pro", "ur5_gripper", "baxter", "hyq")


@dataclass
class Found:
    """One robot: the model and how far it is from the other readers, or why it does not come in."""

    name: str
    errors: list[str] = field(default_factory=list)
    model: mujoco.MjModel | None = None
    alone: str = ""
    pinocchio: str = ""
    worst: float = 0.0


def robots() -> Path | None:
    """The folder of the robots, if they were fetched."""
    found = [
        Path(at)
        for at, _, _ in os.walk(FOLDER / "robots", followlinks=True)
        if at.endswith("example-robot-data/robots")
    ]
    return found[0] if found else None


def read(path: Path, root: Path, session: Session, **choices: str) -> tuple[UrdfReader, mujoco.MjModel | None]:
    packages = (("example-robot-data", root.parent), *((each.name, each) for each in sorted(root.iterdir())))
    choices = {"visuals": "keep", "inertia": "repair", **choices}
    source = Source(path, PATH, path.name, packages=packages, door=Door.of([root]), urdf=UrdfChoices(**choices))  # type: ignore[arg-type]
    reader = UrdfReader(source, Sink(), session, lambda each: each.name)
    unit = reader.unit()
    if unit is None:
        return reader, None
    with folder_of(unit) as folder:
        file = str(folder / "model.xml")
        return reader, mujoco.MjSpec.from_file(file, include={file: write(unit.root)}).compile()


def by_mujoco(path: Path, root: Path) -> mujoco.MjModel:
    """The model of MuJoCo's own reader, with its packages found. Raises ValueError."""
    spec = mujoco.MjSpec.from_file(str(path))
    for mesh in spec.meshes:
        package, _, inside = mesh.file.removeprefix("package://").lstrip("/").partition("/")
        if mesh.file.startswith("package://"):
            mesh.file = str((root.parent if package == "example-robot-data" else root / package) / inside)
    return spec.compile()


def looked_at(path: Path, root: Path, session: Session) -> Found:
    found = Found(path.relative_to(root).as_posix())
    reader, found.model = read(path, root, session)
    for each in reader.sink.sorted():
        if each.severity == "error":
            found.errors.append(f"{each.code}: {each.message}")
    if found.model is None or reader.robot is None:
        return found
    try:
        alone = by_mujoco(path, root)
    except (ValueError, mujoco.FatalError):
        found.alone = "refuses it"
    else:
        _, same = read(path, root, session, visuals="drop")
        assert same is not None
        found.worst = difference(alone, same)
        found.alone = f"{found.worst:.0e}" if found.worst else "same"
    if is_ready("pinocchio"):
        is_repaired = any(each.code == "urdf-inertia" for each in reader.sink.sorted())
        found.pinocchio, worst = beside_pinocchio(path, found.model, is_repaired)
        found.worst = max(found.worst, worst)
    return found


def difference(one: mujoco.MjModel, other: mujoco.MjModel) -> float:
    """The largest difference of masses, inertias and, at random poses, places and orientations of bodies."""
    if (one.nbody, one.nq) != (other.nbody, other.nq):
        return float("inf")
    compared = ("body_mass", "body_inertia") if READS_TURNED else ("body_mass",)
    worst = max(float(abs(getattr(one, each) - getattr(other, each)).max()) for each in compared)
    datas = mujoco.MjData(one), mujoco.MjData(other)
    for qpos in poses(one):
        for model, data in zip((one, other), datas, strict=True):
            data.qpos[:] = qpos
            mujoco.mj_kinematics(model, data)
        worst = max(worst, *(float(abs(getattr(datas[0], n) - getattr(datas[1], n)).max()) for n in ("xpos", "xmat")))
    return worst


def poses(model: mujoco.MjModel) -> Iterator[np.ndarray]:
    random = np.random.default_rng(0)
    for _ in range(POSES):
        qpos = model.qpos0.copy()
        mujoco.mj_integratePos(model, qpos, random.uniform(-1.5, 1.5, model.nv), 1.0)
        yield qpos


def beside_pinocchio(path: Path, model: mujoco.MjModel, is_repaired: bool) -> tuple[str, float]:
    """What differs from Pinocchio: places, masses, centers and inertias of the bodies that move, by their names.

    Pinocchio takes impossible inertias, which are not compared if some are repaired.
    """
    kinds = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))  # no number is `in` enumerations
    simple = [j for j in range(model.njnt) if model.jnt_type[j] in kinds]
    drawn = list(poses(model))
    given = [
        {"joints": {model.joint(j).name: [float(q[model.jnt_qposadr[j]])] for j in simple}, "free": {}} for q in drawn
    ]
    questions = {"poses": given, "home": given[0], "seconds": 0, "gravity": [0, 0, 0]}
    with TemporaryDirectory() as folder:
        alone = Path(folder, "robot", path.name)  # files are written beside its folder
        alone.parent.mkdir()
        alone.write_bytes(path.read_bytes())
        facts = read_back(READERS["pinocchio"], str(python_of("pinocchio")), alone, questions)
    if isinstance(facts, str):
        return f"refuses it: {facts}", 0.0
    moved = {model.body(model.jnt_bodyid[j]).name for j in simple}
    worst = {"masses": 0.0, "centers": 0.0, "inertias": 0.0, "places": 0.0}
    for name in moved & facts["bodies"].keys():
        body = model.body(name)
        read = facts["bodies"][name]
        axes = np.zeros(9)
        mujoco.mju_quat2Mat(axes, body.iquat)
        moments = axes.reshape(3, 3) @ np.diag(body.inertia) @ axes.reshape(3, 3).T
        worst["masses"] = max(worst["masses"], abs(float(body.mass[0]) - read["mass"]))
        if read["mass"] and not is_repaired:
            worst["centers"] = max(worst["centers"], float(np.abs(body.ipos - read["com"]).max()))
            scale = max(float(np.abs(moments).max()), 1e-9)
            worst["inertias"] = max(worst["inertias"], float(np.abs(moments - read["inertia"]).max()) / scale)
    data = mujoco.MjData(model)
    for qpos, row in zip(drawn, facts["poses"], strict=True):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        for name in moved & row.keys():
            worst["places"] = max(worst["places"], float(abs(data.body(name).xpos - np.array(row[name][0])).max()))
    said = [f"{words} {value:.0e}" for words, value in worst.items() if value > TOLERANCE]
    return ", ".join(said) or "same", max(worst.values())


def row(found: Found) -> str:
    model = found.model
    name = Path(found.name).stem
    if model is None:
        return f"| {name} | none: {'; '.join(found.errors)[:160].replace('|', '/')} | | |"
    sizes = f"{model.nbody - 1}/{model.njnt}/{model.nu}/{model.neq}/{model.nmesh}"
    return f"| {name} | {sizes} | {found.alone} | {found.pinocchio} |"


def survey(root: Path, only: tuple[str, ...] = ("",)) -> Iterator[Found]:
    with Session() as session:
        for path in sorted(root.rglob("*.urdf")):
            if any(each in path.as_posix() for each in only):
                yield looked_at(path, root, session)


def main() -> None:
    root = robots()
    if root is None or not is_ready("pinocchio"):
        sys.exit("run `python tests/targets/environments.py robots pinocchio` first")
    found: list[Found] = []
    for each in survey(root, SHOWN):
        found.append(each)
        print(row(each), flush=True)  # noqa: T201
        if "--write" in sys.argv:
            put_down(found)


def commas(names: list[str]) -> str:
    return ", ".join(names)


def put_down(found: list[Found]) -> None:
    """Write the numbers of the page."""
    inside = [each for each in found if each.model is not None]
    refused = [Path(each.name).stem for each in inside if each.alone == "refuses it"]
    others = [f"{Path(each.name).stem} ({each.alone})" for each in inside if each.alone not in ("same", "refuses it")]
    different = [f"{Path(each.name).stem} ({each.pinocchio})" for each in inside if each.pinocchio != "same"]
    text = (
        f"{len(inside)} of {len(found)} robots come in. MuJoCo's own reader takes {len(inside) - len(refused)}, all of them the same"
        f"{f', except {commas(others)}' if others else ''}; it refuses {commas(refused)}."
        f" Pinocchio: the same{f', except {commas(different)}' if different else ''}."
    )
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}\n{text}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
