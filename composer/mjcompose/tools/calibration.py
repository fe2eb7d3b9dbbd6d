"""Turn the maker's calibration of one robot into a file of measurements for a model of it.

A model may have other frames than the maker: MuJoCo Menagerie turns the links of a UR5e by right angles and moves them
along the axes of their joints. The new poses keep these frames, and put the axes of all joints and the flange exactly
where the calibration has them.
"""

from __future__ import annotations

import datetime
import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean
from mjcompose.language.calibration import CalibratedPose, UrCalibration
from mjcompose.language.measured import FORMAT
from mjcompose.language.variation import read
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.sides.operand import read_operand
from mjcompose.sides.side import load as load_model
from mjcompose.sources.context import Context
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, to_python

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Matrix = npt.NDArray[np.float64]
_KEPT = "calibrated"
_CODE = "measured-format"
_TURNED = 0.05
"""The largest difference of a turned frame from right angles: real arms differ by some milliradians."""
_MOVED = 0.02
"""The largest distance in meters of an axis from its place in the calibration."""
_SAME = 0.005
"""Meters along an axis below which a frame of the model is the maker's own frame."""


class ImportedCalibration(Struct):
    """The text of a file of measurements, the number of its bodies, and the site that is the flange."""

    text: str
    bodies: int
    flange: str | None


def import_calibration(file: Path, model: str, name: str, context: Context) -> ImportedCalibration | None:
    """Return the measurements of a calibration for a model, or None after reported errors."""
    shown = context.shown(file)
    tree = _tree(file, shown, context.sink)
    if tree is None:
        return None
    if _is_of_lerobot(tree):
        message = f"`{shown}` is a calibration of LeRobot, which does not say where the zeros of the model are"
        help = (
            "its `homing_offset` says how somebody held the arm, and its ranges count from there: fit the zeros"
            ' instead, `identify: {fields: {zero: {select: {joint: "*"}, zero: [-10deg, 10deg]}}}`'
        )
        context.sink.error(_CODE, message, tree.span, help=help)
        return None
    calibration = read(UrCalibration, to_python(tree), tree, at=(), sink=context.sink)
    if calibration is None:
        return None
    links = [*calibration.kinematics.poses]
    data = _of_model(model, [link for link, _ in links], context)
    if data is None:
        return None
    return _imported(data, links, name, shown, context.sink)


def _tree(file: Path, shown: str, sink: Sink) -> Node | None:
    try:
        content = read_regular(file, in_force().recipe_size)
    except FileNotFoundError:
        sink.error("file-not-found", f"the calibration `{shown}` does not exist", None)
        return None
    except OSError as error:
        sink.error("file-unreadable", f"`{shown}` cannot be read: {error.strerror or error}", None)
        return None
    tree = load(content, shown, sink)
    if tree is not None and not isinstance(tree, Mapping):
        sink.error("wrong-type", f"`{shown}` is not a calibration", tree.span, help="it begins with `kinematics:`")
        return None
    return tree


def _is_of_lerobot(tree: Node) -> bool:
    values = [node for _, node in tree.entries.values()] if isinstance(tree, Mapping) else []
    return any(isinstance(node, Mapping) and "homing_offset" in node.entries for node in values)


# ------------------------------------------------------------------------------------------------------------ model


def _of_model(model: str, links: Sequence[str], context: Context) -> dict[str, Any] | None:
    """Return the poses of the links of a model at the zero of its joints, or None after reported errors."""
    with ExitStack() as opened, Session() as session:
        operand = read_operand(model, context, opened)
        side = None if operand is None else load_model(operand, _KEPT, session)
        if operand is not None:
            operand.report(context.sink)
        if side is None or context.sink.has_errors:
            return None
        answer = engine.call(session, poses_of_links, [_KEPT], argument=list(links))
    if not answer.ok:
        context.sink.error("mujoco-crash", f"the model cannot be read: {answer.error or answer.crash}", None)
        return None
    data: dict[str, Any] = answer.value
    if "missing" in data:
        message = f"`{model}` has {data['count']} bodies `{data['missing']}`; a calibration needs one"
        help = did_you_mean(data["missing"], data["bodies"]) or "name a model of this robot"
        context.sink.error("unknown-name", message, None, help=help)
        return None
    return data


def poses_of_links(mujoco: Any, model: MjModel, links: list[str]) -> dict[str, Any]:
    """Return the poses of links with one joint each, and of the base; runs under `engine.call`."""
    names = [model.body(index).name for index in range(model.nbody)]
    data = mujoco.MjData(model)
    data.qpos[:] = 0
    mujoco.mj_kinematics(model, data)
    found = []
    indices: list[int] = []
    for link in links:
        bodies = [
            index
            for index, name in enumerate(names)
            if name.endswith(link) and not name.removesuffix(link)[-1:].isalnum() and model.body_jntnum[index] == 1
        ]
        if len(bodies) != 1:
            return {"missing": link, "count": len(bodies), "bodies": names}
        body = bodies[0]
        indices.append(body)
        joint = model.body_jntadr[body]
        found.append(
            {
                "name": names[body],
                "pose": _pose(data.xpos[body], data.xmat[body]).tolist(),
                "axis": model.jnt_axis[joint].tolist(),
                "anchor": model.jnt_pos[joint].tolist(),
            }
        )
    base = model.body_parentid[indices[0]]
    sites = [
        {"name": model.site(site).name, "pos": model.site_pos[site].tolist()}
        for site in range(model.nsite)
        if model.site_bodyid[site] == indices[-1]
    ]
    return {"links": found, "base": _pose(data.xpos[base], data.xmat[base]).tolist(), "sites": sites}


def _pose(position: Any, rotation: Any) -> Matrix:
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(rotation, (3, 3))
    pose[:3, 3] = position
    return pose


# ------------------------------------------------------------------------------------------------------- kinematics


def pose_matrix(pose: CalibratedPose) -> Matrix:
    """Return the pose of a link as a matrix."""
    sines = np.sin([pose.roll, pose.pitch, pose.yaw])
    cosines = np.cos([pose.roll, pose.pitch, pose.yaw])
    about_x = np.array([[1, 0, 0], [0, cosines[0], -sines[0]], [0, sines[0], cosines[0]]])
    about_y = np.array([[cosines[1], 0, sines[1]], [0, 1, 0], [-sines[1], 0, cosines[1]]])
    about_z = np.array([[cosines[2], -sines[2], 0], [sines[2], cosines[2], 0], [0, 0, 1]])
    return _pose([pose.x, pose.y, pose.z], about_z @ about_y @ about_x)


def _imported(
    data: dict[str, Any], links: Sequence[tuple[str, CalibratedPose]], name: str, shown: str, sink: Sink
) -> ImportedCalibration | None:
    placed = next(filter(None, (_placed(turn, data, links) for turn in range(4))), None)
    if placed is None:
        message = f"the bodies of the model are elsewhere than the links of `{shown}`: it is a model of another robot"
        sink.error(_CODE, message, None, help="name a model of the same type of robot, with the same zeros")
        return None
    lines: list[str] = []
    for found, pose in zip(data["links"], placed.poses, strict=True):
        lines += _lines(found["name"], pose)
    head = [
        f"measured: {FORMAT}                 # the version of this format",
        f"name: {json.dumps(name)}",
        f"date: {datetime.date.today()}",
        "values:                     # the maker's calibration: poses of the links, in the frames of the model",
    ]
    return ImportedCalibration("\n".join([*head, *lines]) + "\n", len(links), placed.flange)


class _Placed(Struct):
    """The pose of each body in the body before it, and the site at the flange."""

    poses: list[Matrix]
    flange: str | None


def _placed(turn: int, data: dict[str, Any], links: Sequence[tuple[str, CalibratedPose]]) -> _Placed | None:
    """Return the bodies if the base of the model is turned by `turn` right angles, or None if they do not fit."""
    before = np.eye(4)
    before[:2, :2] = np.linalg.matrix_power(np.array([[0, -1], [1, 0]]), turn)
    made = np.array(data["base"]) @ np.linalg.inv(before)
    poses = []
    flange = None
    for (link, pose), found in zip(links, data["links"], strict=True):
        made = made @ pose_matrix(pose)
        own = _own_frame(np.linalg.inv(made) @ np.array(found["pose"]), found)
        if own is None:
            return None
        if link == links[-1][0]:
            flange = _to_flange(own, data["sites"])
        poses.append(np.linalg.inv(before) @ pose_matrix(pose) @ own)
        before = own
    return _Placed(poses, flange)


def _own_frame(nominal: Matrix, found: dict[str, Any]) -> Matrix | None:
    """Return the frame of a body in the maker's frame of the link, with exact angles and its joint on the maker's axis.

    None if it is another frame than the maker's, turned by right angles and moved along the axis.
    """
    turned = np.round(nominal[:3, :3])
    is_turn = np.array_equal(turned @ turned.T, np.eye(3)) and np.linalg.det(turned) > 0
    is_near = np.abs(turned - nominal[:3, :3]).max() < _TURNED
    is_same_axis = np.allclose(turned @ found["axis"], [0, 0, 1], atol=1e-6)
    anchor = turned @ found["anchor"]
    lateral = nominal[:2, 3] + anchor[:2]
    if not (is_turn and is_near and is_same_axis) or np.linalg.norm(lateral) > _MOVED:
        return None
    along = nominal[2, 3] if abs(nominal[2, 3]) > _SAME else 0.0
    return _pose([-anchor[0], -anchor[1], along], turned)


def _to_flange(own: Matrix, sites: Sequence[dict[str, Any]]) -> str | None:
    """Move the last frame along its axis until its site is at the flange; return the name of the site."""
    for site in sites:
        place = own[:3, :3] @ site["pos"] + own[:3, 3]
        if np.linalg.norm(place) < _MOVED:
            own[2, 3] -= place[2]
            return str(site["name"])
    return None


def _lines(body: str, pose: Matrix) -> Iterator[str]:
    yield f"  {json.dumps(f'body {body}', ensure_ascii=False)}:"
    for index, value in enumerate(pose[:3, 3]):
        yield f'    "pos[{index}]": {{value: {_number(value)}}}'
    for index, value in enumerate(_quaternion(pose[:3, :3])):
        yield f'    "quat[{index}]": {{value: {_number(value)}}}'


def _number(value: float) -> str:
    return repr(float(f"{value:.12g}") if abs(value) > 1e-15 else 0.0)


def _quaternion(rotation: Matrix) -> Matrix:
    """Return the quaternion of a rotation, `w` first and not negative."""
    x, y, z = (rotation[:, index] for index in range(3))
    symmetric = np.array(
        [
            [x[0] + y[1] + z[2], y[2] - z[1], z[0] - x[2], x[1] - y[0]],
            [y[2] - z[1], x[0] - y[1] - z[2], y[0] + x[1], z[0] + x[2]],
            [z[0] - x[2], y[0] + x[1], y[1] - x[0] - z[2], z[1] + y[2]],
            [x[1] - y[0], z[0] + x[2], z[1] + y[2], z[2] - x[0] - y[1]],
        ]
    )
    found: Matrix = np.linalg.eigh(symmetric)[1][:, -1]
    return found if found[np.argmax(np.abs(found))] > 0 and found[0] >= 0 else -found
