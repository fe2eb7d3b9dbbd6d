"""ROS 2: the simulation moves as the model does, and both descriptions of the robot agree."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml
from lxml import etree
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.staging import write_folder
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from targets.writing import losses, written

ROBOT = """<mujoco model="Lab arm"><compiler angle="radian"/>
  <option integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="base"><geom size=".1"/>
      <body name="upper" pos="0 0 .2"><joint name="shoulder" axis="0 1 0" damping="1"/>
        <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
        <body name="fore" pos=".3 0 0"><joint axis="0 1 0" range="-2 2" damping="1"/>
          <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
          <site name="wrist" pos=".3 0 0"/>
          <body name="left" pos=".3 .02 0"><joint name="left" type="slide" axis="0 1 0" damping="5"/>
            <geom size=".01" mass=".1"/></body>
          <body name="right" pos=".3 -.02 0"><joint name="right" type="slide" axis="0 -1 0" damping="5"/>
            <geom size=".01" mass=".1"/></body>
          <body name="wheel" pos=".35 0 0"><joint name="wheel" axis="0 0 1" damping=".1"/>
            <geom type="cylinder" size=".02 .01"/></body>
        </body></body></body>
  </worldbody>
  <tendon><fixed name="grip"><joint joint="left" coef="1"/><joint joint="right" coef="1"/></fixed></tendon>
  <equality><joint joint1="right" joint2="left" polycoef="0 1 0 0 0"/></equality>
  <actuator>
    <motor name="torque" joint="shoulder" gear="5" ctrlrange="-2 3"/>
    <position name="grip" tendon="grip" kp="200" kv="4" gear="2" ctrlrange="0 .2"/>
    <general name="spin" joint="wheel" gear="-3" gainprm="4" biastype="affine" biasprm="0 0 -2"
             dyntype="filterexact" dynprm=".1" ctrlrange="-1 1"/>
  </actuator>
  <sensor><force name="wrist_force" site="wrist"/><torque name="wrist_torque" site="wrist"/>
    <gyro name="wrist_gyro" site="wrist"/><actuatorfrc name="pull" actuator="grip"/></sensor>
  <keyframe><key name="open" ctrl="0.5 0.1 0.2" act="0.2"/><key name="home" ctrl="0 0.04 0" act="0"/></keyframe>
</mujoco>"""
AT_THE_JOINT = {  # what 1 of the control of ROBOT is in the unit of the joint
    "torque": 5.0,  # gear
    "left": 1 / (2 * 2),  # gear, and both fingers are in the tendon
    "spin": 4 / 2 / -3,  # gain over damping, gear
}


def made(tmp_path: Path, text: str = ROBOT) -> tuple[Bundle, Path]:
    bundle, context = written(text, "ros2", tmp_path)
    assert bundle is not None, context.sink.diagnostics
    write_folder(bundle, tmp_path / "package")
    return bundle, tmp_path / "package"


def motion(model: mujoco.MjModel, controls: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(model)
    positions = []
    for control in controls:
        data.ctrl[:] = control
        for _ in range(20):
            mujoco.mj_step(model, data)
        positions.append(data.qpos.copy())
    return np.array(positions)


def test_the_simulation_moves_as_the_model_does(tmp_path: Path) -> None:
    _, package = made(tmp_path)
    model = mujoco.MjModel.from_xml_string(ROBOT)
    simulated = mujoco.MjModel.from_xml_path(str(package / "model.xml"))
    names = [simulated.actuator(number).name for number in range(simulated.nu)]
    assert names == ["torque", "left", "spin"]
    factors = np.array([AT_THE_JOINT[name] for name in names])
    controls = np.random.default_rng(5).uniform(-1, 1, (10, 3)) * [2, 0.1, 1] + [0, 0.1, 0]
    expected = motion(model, controls)
    assert np.ptp(expected, axis=0).min() > 1e-3
    np.testing.assert_allclose(motion(simulated, controls * factors), expected, atol=1e-9)
    np.testing.assert_allclose(simulated.actuator_ctrlrange, [[-10, 15], [0, 0.05], [-2 / 3, 2 / 3]])
    np.testing.assert_allclose(simulated.key_ctrl, [[2.5, 0.025, -0.4 / 3], [0, 0.01, 0]], atol=1e-12)
    np.testing.assert_allclose(simulated.key_act, [[-0.4 / 3], [0]])
    assert simulated.sensor("pull").objid == 1


def test_a_servo_rests_where_its_control_says(tmp_path: Path) -> None:
    """What the command of a joint trajectory means: the position of the joint."""
    _, package = made(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(package / "model.xml"))
    data = mujoco.MjData(model)
    model.opt.gravity[:] = 0
    data.ctrl[1] = 0.03
    mujoco.mj_step(model, data, 5000)
    assert data.joint("left").qpos[0] == pytest.approx(0.03, abs=1e-4)


def test_both_descriptions_have_the_same_joints(tmp_path: Path) -> None:
    _, package = made(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(package / "model.xml"))
    urdf = etree.parse(package / "model.urdf")
    joints = {joint.get("name"): joint for joint in urdf.iterfind("joint") if joint.get("type") != "fixed"}
    assert set(joints) == {model.joint(number).name for number in range(model.njnt)}
    for number in range(model.njnt):
        limit = joints[model.joint(number).name].find("limit")
        if model.jnt_limited[number]:
            assert [float(limit.get("lower")), float(limit.get("upper"))] == pytest.approx(model.jnt_range[number])
    system = urdf.find("ros2_control")
    commands = {joint.get("name"): joint.find("command_interface") for joint in system.iterfind("joint")}
    assert set(commands) == set(joints)
    interfaces = {name: command.get("name") for name, command in commands.items() if command is not None}
    assert interfaces == {"shoulder": "effort", "left": "position", "wheel": "velocity"}
    ends = [float(each.text) for each in commands["left"].iterfind("param")]
    assert ends == pytest.approx(model.actuator("left").ctrlrange)
    mimic = joints["right"].find("mimic")
    assert (mimic.get("joint"), float(mimic.get("multiplier"))) == ("left", 1)
    assert joints["shoulder"].find("limit").get("effort") == "15"


def test_the_simulation_starts_at_home(tmp_path: Path) -> None:
    _, package = made(tmp_path)
    hardware = etree.parse(package / "model.urdf").find("ros2_control/hardware")
    assert hardware.findtext("plugin") == "mujoco_ros2_control/MujocoSystemInterface"
    params = {each.get("name"): each.text for each in hardware.iterfind("param")}
    assert params == {"mujoco_model": "$(find recipe)/model.xml", "initial_keyframe": "home"}


def test_controllers_use_what_the_hardware_has(tmp_path: Path) -> None:
    _, package = made(tmp_path)
    parameters: dict[str, Any] = yaml.safe_load((package / "config/controllers.yaml").read_text())
    system = etree.parse(package / "model.urdf").find("ros2_control")
    offered = {(each.getparent().get("name"), each.get("name")) for each in system.iter("command_interface")}
    used = set()
    for name, holder in parameters.items():
        settings = holder["ros__parameters"]
        joints = settings.get("joints", [settings["joint"]] if "joint" in settings else [])
        interface = settings.get("interface_name", "position")
        used |= {(joint, interface) for joint in joints}
        if "sensor_name" in settings:
            sensor = system.find(f"sensor[@name='{settings['sensor_name']}']")
            assert {each.get("name") for each in sensor.iterfind("state_interface")} >= {"force.x", "torque.z"}, name
            assert settings["frame_id"] == "wrist"
    assert used == offered
    assert parameters["controller_manager"]["ros__parameters"]["update_rate"] == 500
    launched = (package / "launch/simulate.launch.py").read_text()
    compile(launched, "simulate.launch.py", "exec")
    assert all(repr(name) in launched for name in parameters if name != "controller_manager")
    sensor = system.find("sensor[@name='wrist']")
    params = {each.get("name"): each.text for each in sensor.iterfind("param")}
    assert params["mujoco_sensor_name"] + params["force_mjcf_suffix"] == "wrist_force"


def test_what_ros_does_not_get_is_told(tmp_path: Path) -> None:
    _, context = written(ROBOT, "ros2", tmp_path)
    told = "\n".join(losses(context))
    assert "ROS 2 ignores 2 sensors: `wrist_gyro`, `pull`" in told
    assert "`fore_joint` in another form: they get a name after their body" in told
    assert "`torque`, `grip`, `spin` in another form: their controls are in the unit of the joint" in told


@pytest.mark.parametrize(
    ("actuator", "words"),
    [
        ('<general name="thrust" site="wrist" gear="0 0 1"/>', "knows actuators of joints and tendons"),
        ('<position name="pull" tendon="loose" kp="2"/>', "only if equalities make one joint lead"),
    ],
)
def test_actuators_that_would_stop_the_simulation_are_refused(actuator: str, words: str, tmp_path: Path) -> None:
    text = ROBOT.replace("</actuator>", f"{actuator}</actuator>").replace(
        "</tendon>",
        '<fixed name="loose"><joint joint="left" coef="1"/><joint joint="wheel" coef="1"/></fixed></tendon>',
    )
    text = text.replace("<keyframe>", "<!--").replace("</keyframe>", "-->")
    bundle, context = written(text, "ros2", tmp_path)
    assert bundle is None
    (refused,) = [each for each in context.sink.diagnostics if each.code == "target-cannot"]
    assert words in refused.message


def test_two_actuators_of_a_joint_are_not_commanded(tmp_path: Path) -> None:
    text = ROBOT.replace("</actuator>", '<velocity name="brake" joint="shoulder" kv="1"/></actuator>')
    text = text.replace('ctrl="0.5 0.1 0.2"', 'ctrl="0.5 0.1 0.2 0"').replace('ctrl="0 0.04 0"', 'ctrl="0 0.04 0 0"')
    bundle, context = written(text, "ros2", tmp_path)
    assert bundle is not None
    assert any("`torque`, `brake`; their control is 0" in words for words in losses(context))
    system = etree.fromstring(bundle.files["model.urdf"]).find("ros2_control")
    assert system.find("joint[@name='shoulder']/command_interface") is None


@pytest.mark.slow
def test_the_launch_file_gets_the_path_of_the_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only ROS has `ament_index_python`, which knows where a package is installed."""
    xacro = pytest.importorskip("xacro")
    packages = ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = lambda name: f"/share/{name}"  # type: ignore[attr-defined]
    packages.PackageNotFoundError = KeyError  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ament_index_python", ModuleType("ament_index_python"))
    monkeypatch.setitem(sys.modules, "ament_index_python.packages", packages)
    _, package = made(tmp_path)
    expanded = etree.fromstring(xacro.process_file(str(package / "model.urdf")).toxml())
    assert expanded.findtext("ros2_control/hardware/param") == "/share/recipe/model.xml"


@pytest.mark.slow
def test_catkin_reads_the_package(tmp_path: Path) -> None:
    catkin_pkg = pytest.importorskip("catkin_pkg.package")
    _, package = made(tmp_path)
    parsed = catkin_pkg.parse_package(str(package))
    assert parsed.name == "recipe" and parsed.get_build_type() == "ament_cmake"
    needed = {dependency.name for dependency in parsed.exec_depends}
    assert {"forward_command_controller", "mujoco_ros2_control", "xacro"} <= needed


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is missing")
def test_cmake_installs_all_files(tmp_path: Path) -> None:
    """A stand-in of `ament_cmake` lets CMake run the file; the installed package has what the launch file opens."""
    _, package = made(tmp_path)
    modules = tmp_path / "modules"
    modules.mkdir()
    (modules / "Findament_cmake.cmake").write_text("macro(ament_package)\nendmacro()\n")
    built = tmp_path / "build"
    configure = ["cmake", "-S", str(package), "-B", str(built), f"-DCMAKE_MODULE_PATH={modules}", "-DLANGUAGES=NONE"]
    subprocess.run([*configure, f"-DCMAKE_INSTALL_PREFIX={tmp_path / 'install'}"], check=True, capture_output=True)
    subprocess.run(["cmake", "--install", str(built)], check=True, capture_output=True)
    share = tmp_path / "install/share/recipe"
    assert {"model.xml", "model.urdf", "model.srdf", "config", "launch"} <= {each.name for each in share.iterdir()}
    assert (share / "config/controllers.yaml").is_file() and (share / "launch/simulate.launch.py").is_file()


def test_the_arm_of_the_demo(repository: Path, tmp_path: Path) -> None:
    """Both fingers follow the pinion, which therefore is the joint of the gripper."""
    context = Context(folder=repository)
    result = build(ModelRequest(repository / "recipes/demo.yaml", target="ros2"), context)
    assert result is not None and result.bundle is not None
    parameters = yaml.safe_load(result.bundle.files["config/controllers.yaml"])
    gripper = parameters["gripper_pinion_gripper_controller"]["ros__parameters"]
    assert gripper == {"type": "parallel_gripper_action_controller/GripperActionController", "joint": "gripper/pinion"}
    assert len(parameters["joint_trajectory_controller"]["ros__parameters"]["joints"]) == 6
