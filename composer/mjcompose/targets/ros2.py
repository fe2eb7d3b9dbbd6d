"""A model as a ROS 2 package: MJCF for `mujoco_ros2_control`, URDF for everything else, controllers and a launch file.

`mujoco_ros2_control` simulates `model.xml`, and ROS reads `model.urdf`; both have the same names, limits, efforts and
home pose. It passes a command as it is to the control of the joint's actuator (0.0.3, `mujoco_system_interface.cpp`),
so every control of `model.xml` is a position, velocity or force at a joint.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from os.path import commonprefix
from typing import Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.targets.plain import text
from mjcompose.targets.target import Draft, FeatureOutcome, write_mjcf
from mjcompose.targets.urdf import description, meshes, package_name, ros_package, semantics, title, write_xml


class _Drive(Struct):
    """An actuator that drives one joint: its length is `offset` + `ratio` times the position of the joint."""

    number: int
    node: Node
    joint: str
    interface: str
    ratio: float
    offset: float


class JointCommand(Struct):
    """The command of a joint. `ends` is the range of the command, in the unit of the joint; None without a limit."""

    joint: str
    interface: str
    ends: tuple[float, float] | None
    effort: float | None = None
    is_gripper: bool = False


class _Sensor(Struct):
    """Sensors of MJCF that ROS knows as one. `suffixes` are the parameters with the ends of their names."""

    name: str
    kind: str
    frame: str
    suffixes: Mapping[str, str]


def name_joints(draft: Draft) -> None:
    """Name hinges and slides without a name as the URDF does: `mujoco_ros2_control` refuses a joint without one."""
    names = {joint.get("name") for _, joint in draft.of("joint")}
    for body, holder in enumerate(draft.elements["body"]):
        for at, (_, joint) in enumerate(draft.of_body("joint", body)):
            if joint.get("name") or joint.get("type") == "free":
                continue
            name = f"{holder.get('name') or f'body{body}'}_joint{at or ''}"
            while name in names:
                name += "_"
            names.add(name)
            joint.set("name", name)
            draft.lose("names", joint, "they get a name after their body", outcome=FeatureOutcome.WRITTEN)


def refuse_actuators(draft: Draft) -> None:
    """Refuse actuators with which `mujoco_ros2_control` does not start, or reads the state of a wrong joint."""
    transmissions = draft.mujoco.mjtTrn
    known = (int(transmissions.mjTRN_JOINT), int(transmissions.mjTRN_TENDON))
    couplings = _Couplings.of(draft)
    for number, node in draft.of("actuator"):
        if int(draft.model.actuator_trntype[number]) not in known:
            why = "mujoco_ros2_control knows actuators of joints and tendons"
        elif couplings.moved(draft, number, node) is None:
            why = "mujoco_ros2_control moves a tendon only if equalities make one joint lead all of its joints"
        else:
            continue
        draft.lose("actuators", node, why, outcome=FeatureOutcome.REFUSED, help="`drop` it in a recipe for ROS")


class _Couplings(Struct):
    """Couplings of joints: fixed tendons by name, and for each follower its leader, the slope, and its place at 0."""

    tendons: Mapping[str, Node]
    leaders: Mapping[str, tuple[str, float, float]]

    @classmethod
    def of(cls, draft: Draft) -> _Couplings:
        model = draft.model
        tendons = {str(node.get("name")): node for _, node in draft.of("tendon") if node.tag == "fixed"}
        zeros = {
            str(joint.get("name")): float(model.qpos0[model.jnt_qposadr[number]]) for number, joint in draft.of("joint")
        }
        leaders: dict[str, tuple[str, float, float]] = {}
        for number, node in draft.of("equality"):
            start, slope, *higher = model.eq_data[number][:5].tolist()
            leader = node.get("joint2")
            follower = str(node.get("joint1"))
            if node.tag == "joint" and leader and model.eq_active0[number] and not any(higher) and slope:
                leaders[follower] = str(leader), slope, zeros[follower] + start - slope * zeros[str(leader)]
        return cls(tendons, leaders)

    def moved(self, draft: Draft, number: int, actuator: Node) -> tuple[str, float, float] | None:
        """Return the joint that an actuator moves, and how its length follows: the ratio and the offset."""
        gear = float(draft.model.actuator_gear[number][0])
        if actuator.get("joint"):
            return str(actuator.get("joint")), gear, 0.0
        tendon = self.tendons.get(str(actuator.get("tendon")))
        if tendon is None:
            return None
        ratio = 0.0
        offset = 0.0
        joints = set()
        for wrap in tendon.iterchildren("joint"):
            joint = str(wrap.get("joint"))
            leader, slope, start = self.leaders.get(joint, (joint, 1.0, 0.0))
            joints.add(leader)
            ratio += gear * float(str(wrap.get("coef"))) * slope
            offset += gear * float(str(wrap.get("coef"))) * start
        return (joints.pop(), ratio, offset) if len(joints) == 1 and ratio else None


def move_controls_to_joints(draft: Draft) -> None:
    """Write each control in the unit of the joint that it moves; the forces stay the same."""
    for drive in _drives(draft, _Couplings.of(draft)):
        _scale(draft, drive)


def _drives(draft: Draft, couplings: _Couplings) -> list[_Drive]:
    """Return the actuators that ROS can command. Others, such as muscles, keep the control zero and are a loss."""
    drives = []
    for number, node in draft.of("actuator"):
        moved = couplings.moved(draft, number, node)
        interface = _interface(draft, number)
        if moved is not None and interface is not None:
            drives.append(_Drive(number, node, moved[0], interface, ratio=moved[1], offset=moved[2]))
    counts = Counter(drive.joint for drive in drives)
    return [drive for drive in drives if counts[drive.joint] == 1]


def _interface(draft: Draft, number: int) -> str | None:
    """Return the quantity of a control: `position`, `velocity`, `effort`, or None for a law that ROS does not know."""
    model = draft.model
    dynamics = draft.mujoco.mjtDyn
    linear = (dynamics.mjDYN_NONE, dynamics.mjDYN_FILTER, dynamics.mjDYN_FILTEREXACT)
    is_linear = int(model.actuator_dyntype[number]) in map(int, linear)
    gain = model.actuator_gainprm[number]
    if not is_linear or model.actuator_gaintype[number] != int(draft.mujoco.mjtGain.mjGAIN_FIXED) or not gain[0]:
        return None
    bias = model.actuator_biasprm[number]
    bias_type = int(model.actuator_biastype[number])
    if bias_type == int(draft.mujoco.mjtBias.mjBIAS_NONE):
        return "effort"
    if bias_type != int(draft.mujoco.mjtBias.mjBIAS_AFFINE) or bias[1] > 0 or bias[2] > 0:
        return None
    if bias[1]:
        return "position"
    return "velocity" if bias[2] else None


def _scale(draft: Draft, drive: _Drive) -> None:
    """Write the control of an actuator as `slope * control + start`, with the gains that give the same force."""
    model = draft.model
    number = drive.number
    gain = float(model.actuator_gainprm[number][0])
    bias = model.actuator_biasprm[number][:3].astype(float)
    if drive.interface == "effort":
        slope = gain * drive.ratio
        start = 0.0
        constant = bias[0]
    else:
        stiffness = float(-bias[1] if drive.interface == "position" else -bias[2])
        length = drive.offset if drive.interface == "position" else 0.0
        slope = gain / (stiffness * drive.ratio)
        start = (bias[0] / stiffness - length) / drive.ratio
        constant = stiffness * length
    if (slope, start) != (1.0, 0.0):
        _as_general(draft, number, drive.node, gain / slope, np.array([constant, *bias[1:]]))
        _move_numbers(draft, drive, slope, start)
        why = "their controls are in the unit of the joint, with the same forces"
        draft.lose("gears", drive.node, why, outcome=FeatureOutcome.WRITTEN)
    if drive.node.get("tendon"):
        _rename(draft, drive)


def _move_numbers(draft: Draft, drive: _Drive, slope: float, start: float) -> None:
    """Write the ranges of a control, and its numbers in keys, in the unit of the joint."""
    for name in ("ctrlrange", "actrange"):
        if drive.node.get(name):
            ends = (slope * float(end) + start for end in str(drive.node.get(name)).split())
            drive.node.set(name, text(sorted(ends)))
    state = int(draft.model.actuator_actadr[drive.number])
    for key in draft.root.iterfind("keyframe/key"):
        _move(key, "ctrl", drive.number, slope, start)
        if state >= 0:
            _move(key, "act", state, slope, start)


def _rename(draft: Draft, drive: _Drive) -> None:
    """Give the actuator of a tendon the name of the joint: so `mujoco_ros2_control` knows which joint it moves."""
    name = drive.node.get("name")
    draft.lose("actuators", drive.node, "they have the name of the joint they move", outcome=FeatureOutcome.WRITTEN)
    drive.node.set("name", drive.joint)
    for sensor in draft.root.iterfind("sensor/*"):
        if sensor.get("actuator") == name:
            sensor.set("actuator", drive.joint)


_SHORTCUTS = ("kp", "kv", "dampratio", "timeconst", "inheritrange")
"""Attributes of `position` and `velocity` that a `general` does not have."""


def _as_general(draft: Draft, number: int, node: Node, gain: float, bias: Any) -> None:
    """Write an actuator in the form that has its gain and its bias apart."""
    model = draft.model
    dynamics = {2: "filter", 3: "filterexact"}.get(int(model.actuator_dyntype[number]))  # mjDYN_FILTER, _FILTEREXACT
    for name in _SHORTCUTS:
        node.attrib.pop(name, "")
    node.tag = "general"
    node.set("gainprm", text([gain]))
    if int(model.actuator_biastype[number]):
        node.set("biastype", "affine")
        node.set("biasprm", text(bias))
    if dynamics:
        node.set("dyntype", dynamics)
        node.set("dynprm", text(model.actuator_dynprm[number][:1]))


def _move(key: Node, name: str, index: int, slope: float, start: float) -> None:
    values = str(key.get(name) or "").split()
    if values:
        values[index] = text([slope * float(values[index]) + start])
        key.set(name, " ".join(values))


def commands(draft: Draft) -> list[JointCommand]:
    """Return the commands of the joints, and record the actuators that ROS cannot command."""
    model = draft.model
    couplings = _Couplings.of(draft)
    drives = _drives(draft, couplings)
    followed = {leader for leader, _, _ in couplings.leaders.values()}
    commandable = {drive.number for drive in drives}
    for number, node in draft.of("actuator"):
        if number not in commandable:
            draft.lose("actuators", node, "their control is 0: it commands one motor or servo for each joint")
    found = []
    for drive in drives:
        limited = bool(model.actuator_ctrllimited[drive.number])
        low, high = map(float, str(drive.node.get("ctrlrange")).split()) if limited else (0.0, 0.0)
        effort = None
        if model.actuator_forcelimited[drive.number]:
            effort = float(np.abs(model.actuator_forcerange[drive.number]).max() * abs(drive.ratio))
        ends = (low, high) if limited else None
        is_gripper = drive.interface == "position" and drive.joint in followed
        found.append(JointCommand(drive.joint, drive.interface, ends, effort=effort, is_gripper=is_gripper))
    return found


_FORCES = {"force": "force_mjcf_suffix", "torque": "torque_mjcf_suffix"}
_INERTIAL = {
    "framequat": "orientation_mjcf_suffix",
    "gyro": "angular_velocity_mjcf_suffix",
    "accelerometer": "linear_acceleration_mjcf_suffix",
}
_KINDS = {"fts": _FORCES, "imu": _INERTIAL}
_INTERFACES = {
    "fts": [f"{quantity}.{axis}" for quantity in ("force", "torque") for axis in "xyz"],
    "imu": [f"orientation.{axis}" for axis in "xyzw"]
    + [f"{quantity}.{axis}" for quantity in ("angular_velocity", "linear_acceleration") for axis in "xyz"],
}


def _sensors(draft: Draft) -> list[_Sensor]:
    """Return the force/torque sensors and IMUs: sensors of one site whose names begin alike."""
    by_site: dict[str, dict[str, Node]] = {}
    for _, node in draft.of("sensor"):
        site = node.get("site") or (node.get("objname") if node.get("objtype") == "site" else None)
        if site and node.get("name"):
            by_site.setdefault(str(site), {}).setdefault(str(node.tag), node)
    found = []
    used: set[Node] = set()
    for site, nodes in by_site.items():
        for kind, parameters in _KINDS.items():
            names = {tag: str(nodes[tag].get("name")) for tag in parameters if tag in nodes}
            base = commonprefix(list(names.values()))
            if len(names) == len(parameters) and base:
                suffixes = {parameters[tag]: name.removeprefix(base) for tag, name in names.items()}
                found.append(_Sensor(base, kind, site, suffixes))
                used.update(nodes[tag] for tag in parameters)
    for _, node in draft.of("sensor"):
        if node not in used:
            draft.lose("sensors", node, "it reads force with torque, or IMUs, at one site, with names that begin alike")
    return found


_SYSTEM = "mujoco_ros2_control/MujocoSystemInterface"


def _system(draft: Draft, package: str, joints: Mapping[str, Node], driven: list[JointCommand]) -> Node:
    """Return `ros2_control`: every joint that moves has its state, and those with an actuator a command."""
    system = etree.Element("ros2_control", name=title(draft), type="system")
    hardware = etree.SubElement(system, "hardware")
    etree.SubElement(hardware, "plugin").text = _SYSTEM
    etree.SubElement(hardware, "param", name="mujoco_model").text = f"$(find {package})/model.xml"
    key = _home(draft)
    if key is not None:
        etree.SubElement(hardware, "param", name="initial_keyframe").text = key
    by_joint = {command.joint: command for command in driven}
    for name, joint in joints.items():
        if joint.get("type") not in ("revolute", "continuous", "prismatic"):
            continue
        element = etree.SubElement(system, "joint", name=name)
        command = by_joint.get(name)
        if command is not None:
            interface = etree.SubElement(element, "command_interface", name=command.interface)
            for side, end in zip(("min", "max"), command.ends or (), strict=False):
                etree.SubElement(interface, "param", name=side).text = text([end])
            limit = joint.find("limit")
            if limit is not None and command.effort is not None:
                limit.set("effort", text([min(command.effort, float(str(limit.get("effort"))))]))
        for state in ("position", "velocity", "effort"):
            etree.SubElement(element, "state_interface", name=state)
    return system


def _home(draft: Draft) -> str | None:
    """Return the key at which the simulation starts: `home`, or else the first one with a name."""
    names = [str(key.get("name")) for _, key in draft.of("key") if key.get("name")]
    return "home" if "home" in names else next(iter(names), None)


def _add_sensors(system: Node, sensors: list[_Sensor]) -> None:
    for sensor in sensors:
        element = etree.SubElement(system, "sensor", name=sensor.name.rstrip("_/"))
        parameters = {"mujoco_type": sensor.kind, "mujoco_sensor_name": sensor.name, **sensor.suffixes}
        for name, value in parameters.items():
            etree.SubElement(element, "param", name=name).text = value
        for interface in _INTERFACES[sensor.kind]:
            etree.SubElement(element, "state_interface", name=interface)


_FASTEST = 500
"""Hz: controllers need not be faster, and the manager of a slower computer cannot be."""


def _controllers(draft: Draft, driven: list[JointCommand], sensors: list[_Sensor]) -> dict[str, dict[str, Any]]:
    """Return the parameters of each controller by its name."""
    found: dict[str, dict[str, Any]] = {
        "joint_state_broadcaster": {"type": "joint_state_broadcaster/JointStateBroadcaster"}
    }
    arm = [command.joint for command in driven if command.interface == "position" and not command.is_gripper]
    if arm:
        found["joint_trajectory_controller"] = {
            "type": "joint_trajectory_controller/JointTrajectoryController",
            "joints": arm,
            "command_interfaces": ["position"],
            "state_interfaces": ["position", "velocity"],
        }
    for command in driven:
        if command.is_gripper:
            found[f"{_identifier(command.joint)}_gripper_controller"] = {
                "type": "parallel_gripper_action_controller/GripperActionController",
                "joint": command.joint,
            }
    for interface in ("velocity", "effort"):
        joints = [command.joint for command in driven if command.interface == interface]
        if joints:
            found[f"{interface}_controller"] = {
                "type": "forward_command_controller/ForwardCommandController",
                "joints": joints,
                "interface_name": interface,
            }
    broadcasters = {
        "fts": "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster",
        "imu": "imu_sensor_broadcaster/IMUSensorBroadcaster",
    }
    for sensor in sensors:
        name = sensor.name.rstrip("_/")
        found[f"{_identifier(name)}_{sensor.kind}_broadcaster"] = {
            "type": broadcasters[sensor.kind],
            "sensor_name": name,
            "frame_id": sensor.frame,
        }
    return found


def _identifier(name: str) -> str:
    """Return a name that a ROS node can have.

    >>> _identifier("gripper/left-driver")
    'gripper_left_driver'
    """
    return re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")


def _parameters(draft: Draft, controllers: Mapping[str, Mapping[str, Any]]) -> bytes:
    from mjcompose.text.dump import to_yaml  # imports yaml

    rate = int(min(_FASTEST, round(1 / draft.model.opt.timestep)))
    documents: dict[str, Any] = {"controller_manager": {"ros__parameters": {"update_rate": rate}}}
    documents |= {name: {"ros__parameters": dict(settings)} for name, settings in controllers.items()}
    return to_yaml(documents).encode()


_DEPENDS = ("controller_manager", "launch", "launch_ros", "mujoco_ros2_control", "robot_state_publisher", "xacro")

_LAUNCH = '''"""Start the simulation and the controllers: `ros2 launch {package} simulate.launch.py`."""

from launch import LaunchDescription
from launch.actions import Shutdown
from launch.substitutions import Command, FindExecutable, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

CONTROLLERS = {controllers}


def generate_launch_description():
    share = FindPackageShare("{package}")
    parameters = PathJoinSubstitution([share, "config", "controllers.yaml"])
    # xacro writes the path of the package for `$(find {package})`.
    urdf = Command([FindExecutable(name="xacro"), " ", PathJoinSubstitution([share, "model.urdf"])])
    settings = {{"robot_description": ParameterValue(urdf, value_type=str), "use_sim_time": True}}
    return LaunchDescription(
        [
            Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[settings]),
            Node(
                package="mujoco_ros2_control",
                executable="ros2_control_node",
                parameters=[{{"use_sim_time": True}}, ParameterFile(parameters)],
                output="both",
                on_exit=Shutdown(),
            ),
            Node(
                package="controller_manager",
                executable="spawner",
                arguments=[*CONTROLLERS, "--param-file", parameters],
                output="both",
            ),
        ]
    )
'''


_IN_SIMULATION = ("armature", "keys")
"""Features that the URDF lacks, to nobody's loss: `model.xml` has them."""


def write_ros2(draft: Draft) -> dict[str, bytes]:
    """Return `model.xml`, `model.urdf`, `model.srdf`, the controllers, a launch file and the package, by path."""
    package = package_name(title(draft))
    simulated = write_mjcf(draft)
    driven = commands(draft)
    sensors = _sensors(draft)
    for _, camera in draft.of("camera"):
        draft.lose("cameras", camera, "add the plugin `CameraPlugin` of mujoco_ros2_control")
    described = description(draft, package)
    system = _system(draft, package, described.joints, driven)
    _add_sensors(system, sensors)
    described.robot.append(system)
    semantic = semantics(draft, title(draft), described.links, joints=described.joints)
    draft.losses[:] = [loss for loss in draft.losses if loss.feature not in _IN_SIMULATION]
    controllers = _controllers(draft, driven, sensors)
    plugins = {str(settings["type"]).partition("/")[0] for settings in controllers.values()}
    depends = [("buildtool_depend", "ament_cmake"), *(("exec_depend", name) for name in sorted({*_DEPENDS, *plugins}))]
    launch = _LAUNCH.format(package=package, controllers=list(controllers))
    return {
        **simulated,
        **meshes(draft),
        "model.urdf": write_xml(described.robot),
        "model.srdf": semantic,
        "config/controllers.yaml": _parameters(draft, controllers),
        "launch/simulate.launch.py": launch.encode(),
        **ros_package(draft, ["model.xml", "model.urdf", "model.srdf"], folders=["config", "launch"], depends=depends),
    }
