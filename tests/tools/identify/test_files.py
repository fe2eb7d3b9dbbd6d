"""Parquet, MCAP and data sets of LeRobot, as their own libraries write them, and as nobody should."""

from __future__ import annotations

import json
import random
import struct
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mjcompose.tools.identify.recording import Recording, Signal, read_recording
from mjcompose.tools.identify.tables import RecordingFault, SizeLimits
from tools.identify import robots
from tools.identify.test_recording import GOOD, KEYS, LIMITS, ROBOT, fault, good, read

pa = pytest.importorskip("pyarrow", reason="pyarrow is not installed")
pytest.importorskip("mcap_ros2", reason="mcap-ros2-support is not installed")
COMMANDS: dict[str, Any] = {"command": "/commands", "command_joints": ["shoulder", "elbow"]}
JOINTS = ["shoulder", "elbow"]


def difference(recording: Recording) -> float:
    """Return the largest difference of a recording from the columns of GOOD."""
    assert recording.signals.keys() == {Signal("qpos", joint) for joint in JOINTS}
    assert recording.commands.keys() == set(JOINTS)
    errors = [np.abs(recording.times - GOOD["time"]).max()]
    errors += [np.abs(values - GOOD[signal.word]).max() for signal, values in recording.signals.items()]
    for name, command in recording.commands.items():
        assert len(command.times) == len(GOOD["time"])
        errors.append(np.abs(command.times - GOOD["time"]).max())
        errors.append(np.abs(command.values - GOOD[f"ctrl {name}"]).max())
    return float(max(errors))


def test_formats_are_equal(tmp_path: Path) -> None:
    assert difference(read(robots.write_parquet(tmp_path / "run.parquet", GOOD))) == 0
    assert difference(read(robots.write_mcap(tmp_path / "run.mcap", GOOD), **COMMANDS)) < 1e-9
    assert difference(read(robots.write_lerobot(tmp_path / "set", GOOD), episode=1)) < 1e-7


# ------------------------------------------------------------------------------------------------------------ Parquet


@pytest.mark.parametrize("compression", ["none", "snappy", "gzip", "zstd", "brotli", "lz4"])
def test_parquet_with_any_packing_and_small_groups(compression: str, tmp_path: Path) -> None:
    path = robots.write_parquet(tmp_path / "run.parquet", GOOD, compression=compression, row_group_size=7)
    assert difference(read(path)) == 0


@pytest.mark.parametrize(
    "times",
    [
        lambda ns: pa.array(ns, pa.timestamp("ns")),
        lambda ns: pa.array(ns // 1000, pa.timestamp("us", tz="UTC")),
        lambda ns: pa.array(ns, pa.duration("ns")),
    ],
)
def test_parquet_with_a_type_of_time(times: Callable[[np.ndarray], Any], tmp_path: Path) -> None:
    ns = robots.BEGIN + np.round(GOOD["time"] * 1e9).astype(int)
    path = robots.write_parquet(tmp_path / "run.parquet", {**GOOD, "time": times(ns)})
    assert difference(read(path)) < 1e-12
    found = fault(path, dimensions={"time": "time"})
    assert (found.code, "remove" in str(found.help)) == ("recording-unit", True)


def test_parquet_with_whole_nanoseconds_keeps_their_digits(tmp_path: Path) -> None:
    ns = robots.BEGIN + np.round(GOOD["time"] * 1e9).astype(int)
    path = robots.write_parquet(tmp_path / "run.parquet", {**GOOD, "time": ns})
    factors = {**KEYS["factors"], "time": 1e-9}
    assert difference(read(path, factors=factors, dimensions={"time": "time"})) < 1e-12


def test_parquet_with_other_types(tmp_path: Path) -> None:
    columns = {**good(), "note": pa.array(["text"] * len(GOOD["time"]))}
    path = robots.write_parquet(tmp_path / "run.parquet", columns)
    assert "`note` has values of the type string, not numbers" in fault(path).message
    assert difference(read(path, ignore=["note"])) == 0
    columns["note"] = pa.array([[1.0]] * len(GOOD["time"]))
    assert "one column for each joint" in str(fault(robots.write_parquet(path, columns)).help)
    path = robots.write_parquet(path, {**GOOD, "qpos elbow": pa.array([None, *GOOD["qpos elbow"][1:]])})
    assert "`qpos elbow` has no number in 1 row, first at 0.000 s" in fault(path).message


def test_a_small_parquet_with_many_rows(tmp_path: Path) -> None:
    zeros = pa.array(np.zeros(2_000_000))
    path = robots.write_parquet(tmp_path / "run.parquet", {"time": zeros, "qpos elbow": zeros}, compression="zstd")
    assert path.stat().st_size < 20_000
    tracemalloc.start()
    found = fault(path)
    assert (found.code, found.message) == ("limit-exceeded", "it has 4000000 numbers; 100000 are allowed")
    assert "--limit recording-numbers=4000000" in str(found.help)
    assert tracemalloc.get_traced_memory()[1] < 4_000_000
    tracemalloc.stop()


def test_a_safe_version_of_pyarrow(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = robots.write_parquet(tmp_path / "run.parquet", GOOD)
    monkeypatch.setattr(pa, "__version__", "14.0.0")
    assert (fault(path).code, "too old" in fault(path).message) == ("not-installed", True)


# --------------------------------------------------------------------------------------------------------------- MCAP


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_mcap_with_any_packing_and_small_chunks(compression: str, tmp_path: Path) -> None:
    from mcap.writer import CompressionType

    path = robots.write_mcap(tmp_path / "run.mcap", GOOD, compression=CompressionType[compression], chunk_size=1000)
    assert difference(read(path, **COMMANDS)) < 1e-9


def test_a_bag_in_several_files(tmp_path: Path) -> None:
    (tmp_path / "bag").mkdir()
    for part, rows in enumerate(np.array_split(np.arange(len(GOOD["time"])), 11)):
        robots.write_mcap(tmp_path / f"bag/run_{part}.mcap", {name: values[rows] for name, values in GOOD.items()})
    assert difference(read(tmp_path / "bag", **COMMANDS)) < 1e-9


def logged(path: Path, change: Callable[[robots.Log, int, float], None] | None = None, **options: Any) -> Path:
    """Write GOOD with commands by name; `change` adds messages to each row."""
    log = robots.Log(path)
    for row, time in enumerate(GOOD["time"]):
        log.add_state(time, JOINTS, [float(GOOD[f"ctrl {joint}"][row]) for joint in JOINTS], topic="/told")
        log.add_state(time, JOINTS, [float(GOOD[f"qpos {joint}"][row]) for joint in JOINTS], **options)
        if change is not None:
            change(log, row, time)
    return log.close()


def test_commands_with_names(tmp_path: Path) -> None:
    path = logged(tmp_path / "run.mcap", velocity=[9.0, 9.0])
    assert difference(read(path, command="/told")) < 1e-9


def test_two_publishers_of_joint_states(tmp_path: Path) -> None:
    def add(log: robots.Log, row: int, time: float) -> None:
        log.add_state(time + 0.001, ["gripper"], [0.5])

    path = logged(tmp_path / "run.mcap", add)
    assert difference(read(path, command="/told", ignore=["gripper"])) < 1e-9
    assert "names no joint of the model" in fault(path, command="/told").message


def test_a_joint_that_some_messages_lack(tmp_path: Path) -> None:
    def add(log: robots.Log, row: int, time: float) -> None:
        if row == 100:
            log.add_state(time + 0.001, ["elbow"], [0.5])

    path = logged(tmp_path / "run.mcap", add)
    assert fault(path, command="/told").message == "`qpos shoulder` has no number in 1 row, first at 0.401 s"


def test_messages_without_positions_are_no_samples(tmp_path: Path) -> None:
    path = logged(tmp_path / "run.mcap", lambda log, row, time: log.add_state(time + 0.001, JOINTS, []))
    assert difference(read(path, command="/told")) < 1e-9


def test_the_clock_of_a_message(tmp_path: Path) -> None:
    late = logged(tmp_path / "late.mcap", delay=20_000_000)  # 20 ms from the stamp to the recorder
    assert difference(read(late, command="/told")) < 1e-9
    by_log = read(late, command="/told", clock="log")
    assert by_log.commands["elbow"].times[1] - by_log.commands["elbow"].times[0] == pytest.approx(0.004)
    assert by_log.commands["elbow"].times[5] == pytest.approx(0)  # commands were recorded five steps before
    unstamped = logged(tmp_path / "unstamped.mcap", stamp=None)
    assert difference(read(unstamped, clock="log", command="/told")) < 1e-9


def test_stamps_of_another_clock_than_the_recorder(tmp_path: Path) -> None:
    log = robots.Log(tmp_path / "run.mcap")
    for row, time in enumerate(GOOD["time"]):
        log.add_command(time, [float(GOOD[f"ctrl {joint}"][row]) for joint in JOINTS])
        log.add_state(time, JOINTS, [float(GOOD[f"qpos {joint}"][row]) for joint in JOINTS], stamp=1_000_000_000)
    path = log.close()
    found = fault(path, **COMMANDS)
    assert (found.code, "1.7e+09 s away" in found.message) == ("recording-time", True)
    assert difference(read(path, clock="log", **COMMANDS)) < 1e-9


def test_states_before_the_first_command_are_left_out(tmp_path: Path) -> None:
    log = robots.Log(tmp_path / "run.mcap")
    for row, time in enumerate(GOOD["time"]):
        if row >= 50:
            log.add_command(time, [float(GOOD[f"ctrl {joint}"][row]) for joint in JOINTS])
        log.add_state(time, JOINTS, [float(GOOD[f"qpos {joint}"][row]) for joint in JOINTS])
    found = read(log.close(), **COMMANDS)
    assert len(found.times) == len(GOOD["time"]) - 50
    assert np.array_equal(found.signals[Signal("qpos", "elbow")], GOOD["qpos elbow"][50:])
    assert found.commands["elbow"].times[0] == found.times[0] == 0


@pytest.mark.parametrize(
    ("keys", "message", "help"),
    [
        ({"state": "/joints"}, "it has no topic `/joints`", "/joint_states (sensor_msgs/msg/JointState)"),
        ({"command": "/command"}, "it has no topic `/command`", "write `recording: {command: TOPIC}`"),
        ({}, "it has no commands of actuator `shoulder` and 1 more", "{command: TOPIC}`: it has /commands"),
        ({"command": "/commands"}, "the commands of `/commands` have no names", "`recording: {command_joints: […]}`"),
        ({**COMMANDS, "command_joints": ["elbow"]}, "`/commands` has 1 names and 2 numbers", None),
        ({**COMMANDS, "command_joints": ["elbw", "shoulder"]}, "`ctrl elbw` names no actuator", "did you mean"),
        ({"state": "/commands"}, "are std_msgs/msg/Float64MultiArray, which are no joint states", "it has /commands"),
        ({**COMMANDS, "dimensions": {"time": "time"}}, "have their unit in the file", "remove `units: {time: …}`"),
    ],
)
def test_wrong_topics(keys: dict[str, Any], message: str, help: str | None, tmp_path: Path) -> None:
    found = fault(robots.write_mcap(tmp_path / "run.mcap", GOOD), **keys)
    assert message in found.message
    assert help is None or help in str(found.help)


def test_a_long_log_is_read_in_pieces(tmp_path: Path) -> None:
    """200 MB of pictures and 0.1 MB of joints, in chunks of 1 MB."""
    log = robots.Log(tmp_path / "run.mcap", chunk_size=1 << 20)
    picture = log.writer.register_msgdef("sensor_msgs/msg/CompressedImage", "uint8[] data")
    noise = random.Random(1).randbytes(1 << 20)
    for row, time in enumerate(GOOD["time"]):
        log.add_command(time, [float(GOOD[f"ctrl {joint}"][row]) for joint in JOINTS])
        log.add_state(time, JOINTS, [float(GOOD[f"qpos {joint}"][row]) for joint in JOINTS])
        if row < 200:
            log.writer.write_message("/camera", picture, {"data": noise}, robots.BEGIN, robots.BEGIN)
    path = log.close()
    assert path.stat().st_size > 200 << 20
    limits = SizeLimits(1 << 30, 100_000)
    tracemalloc.start()
    found = read_recording(__import__("mujoco"), ROBOT, path, "run.mcap", {**KEYS, **COMMANDS}, limits)
    assert tracemalloc.get_traced_memory()[1] < 16 << 20
    tracemalloc.stop()
    assert difference(found) < 1e-9
    assert fault(path, **COMMANDS).code == "limit-exceeded"


@pytest.mark.parametrize("compression", ["LZ4", "ZSTD"])
def test_a_chunk_is_unpacked_within_the_limit(compression: str, tmp_path: Path) -> None:
    from mcap.writer import CompressionType

    log = robots.Log(tmp_path / "run.mcap", chunk_size=1 << 26, compression=CompressionType[compression])
    picture = log.writer.register_msgdef("sensor_msgs/msg/CompressedImage", "uint8[] data")
    log.writer.write_message("/camera", picture, {"data": bytes(50_000_000)}, robots.BEGIN, robots.BEGIN)
    path = log.close()
    assert path.stat().st_size < 1_000_000
    tracemalloc.start()
    assert fault(path, **COMMANDS).code == "limit-exceeded"
    contents = bytearray(path.read_bytes())
    size = struct.pack("<Q", 0)
    place = contents.index(b"zstd" if compression == "ZSTD" else b"lz4") - 16  # the size, a checksum, a length
    assert contents[place : place + 8] != size
    contents[place : place + 8] = struct.pack("<Q", 1000)  # a chunk that says it is small
    path.write_bytes(contents)
    assert fault(path, **COMMANDS).code == "recording-kind"
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()


def test_a_log_that_ends_early(tmp_path: Path) -> None:
    path = robots.write_mcap(tmp_path / "run.mcap", GOOD, chunk_size=1000)
    contents = path.read_bytes()
    for length in (0, 4, 8, 100, 1000, len(contents) // 2, len(contents) - 9):
        path.write_bytes(contents[:length])
        assert fault(path, **COMMANDS).code == "recording-kind"


def test_messages_in_another_encoding(tmp_path: Path) -> None:
    from mcap.writer import Writer

    path = tmp_path / "run.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("joints", "jsonschema", b"{}")
        channel = writer.register_channel("/joint_states", "json", schema)
        writer.add_message(channel, log_time=1, data=b"{}", publish_time=1)
        writer.finish()
    found = fault(path)
    assert (
        found.message
        == "the messages of `/joint_states` are in the encoding json with jsonschema definitions, which cannot be read"
    )


# ------------------------------------------------------------------------------------------------------------ LeRobot


def test_an_episode_must_be_chosen(tmp_path: Path) -> None:
    folder = robots.write_lerobot(tmp_path / "set", GOOD)
    assert fault(folder).message == "it has several episodes: 0 to 1"
    assert fault(folder, episode=2).message == "it has no episode 2: 0 to 1"
    first = read(robots.write_lerobot(tmp_path / "one", GOOD, total_episodes=1))
    assert not first.signals[Signal("qpos", "elbow")].any()


def test_degrees_of_a_data_set(tmp_path: Path) -> None:
    columns = {name: values if name == "time" else np.degrees(values) for name, values in GOOD.items()}
    folder = robots.write_lerobot(tmp_path / "set", columns)
    factors = {**KEYS["factors"], "qpos": np.pi / 180, "ctrl": np.pi / 180}
    found = read(folder, episode=1, factors=factors, dimensions={"qpos": "angle", "ctrl": "angle"})
    assert difference(found) < 1e-7
    assert "are these degrees?" in str(fault(folder, episode=1).help)


def test_a_gripper_in_percent_can_be_left_out(tmp_path: Path) -> None:
    columns = {**GOOD, "qpos gripper": GOOD["time"] * 100, "ctrl gripper": GOOD["time"] * 100}
    folder = robots.write_lerobot(tmp_path / "set", columns)
    assert difference(read(folder, episode=1, ignore=["gripper"])) < 1e-7
    found = read(folder, episode=1, ignore=["gripper", "elbow"])
    assert found.signals.keys() == {Signal("qpos", "shoulder")}


@pytest.mark.parametrize(
    ("changes", "code", "message"),
    [
        ({"codebase_version": "v2.1"}, "recording-kind", "LeRobot v2.1; version 3 can be read"),
        ({"codebase_version": 3}, "recording-kind", "LeRobot 3; version 3 can be read"),
        ({"features": {}}, "recording-column", "`meta/info.json` has no names of `observation.state`"),
        ({"features": []}, "recording-column", "`meta/info.json` has no names of `observation.state`"),
        (
            {"features": {name: {"names": ["elbow.pos"]} for name in ("observation.state", "action")}},
            "recording-value",
            "`observation.state` has 2 numbers in a row, and `meta/info.json` has 1 names",
        ),
        (
            {"features": {name: {"names": ["elbow.pos"] * 2} for name in ("observation.state", "action")}},
            "recording-column",
            "`observation.state` has two numbers `elbow.pos`",
        ),
    ],
)
def test_a_wrong_data_set(changes: dict[str, Any], code: str, message: str, tmp_path: Path) -> None:
    found = fault(robots.write_lerobot(tmp_path / "set", GOOD, **changes), episode=1)
    assert (found.code, message in found.message) == (code, True), found.message


def test_folders_that_are_no_recordings(tmp_path: Path) -> None:
    assert "without `meta/info.json`" in fault(tmp_path).message
    folder = robots.write_lerobot(tmp_path / "set", GOOD)
    (folder / "meta/info.json").write_text("[" * 100_000, encoding="utf-8")
    assert fault(folder).message == "`meta/info.json` is not JSON"
    assert "convert the bag to MCAP" in str(fault(robots.write_csv(tmp_path / "run.db3", GOOD)).help)


# ------------------------------------------------------------------------------------------------------------- damage


@pytest.mark.parametrize("suffix", [".parquet", ".mcap", "set"])
def test_damage_is_a_fault_of_the_file(suffix: str, tmp_path: Path) -> None:
    write = {".parquet": robots.write_parquet, ".mcap": robots.write_mcap, "set": robots.write_lerobot}[suffix]
    path = write(tmp_path / f"run{suffix}", GOOD)  # type: ignore[operator]
    damaged = path / "data/chunk-000/file-000.parquet" if suffix == "set" else path
    whole = damaged.read_bytes()
    chance = random.Random(1)
    codes = set()
    for _ in range(60):
        contents = bytearray(whole)
        for _ in range(chance.choice((1, 20))):
            contents[chance.randrange(len(contents))] = chance.randrange(256)
        damaged.write_bytes(contents)
        try:
            read(path, **COMMANDS, episode=1)
        except RecordingFault as raised:
            codes.add(raised.code)
    assert "recording-kind" in codes


@pytest.mark.parametrize(("suffix", "package"), [(".parquet", "pyarrow"), (".mcap", "mcap_ros2"), ("set", "pyarrow")])
def test_a_package_that_is_not_installed(
    suffix: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = {".parquet": robots.write_parquet, ".mcap": robots.write_mcap, "set": robots.write_lerobot}[suffix]
    path = write(tmp_path / f"run{suffix}", GOOD)  # type: ignore[operator]
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    found = fault(path, episode=1)
    assert (found.code, found.help) == ("not-installed", 'run `pip install "mjcompose[identify]"`')
    assert package.replace("mcap_ros2", "mcap-ros2-support") in found.message


def test_a_csv_needs_none_of_these_packages(tmp_path: Path) -> None:
    robots.write_csv(tmp_path / "run.csv", GOOD)
    keys = json.dumps(KEYS)
    program = f"""
import sys, json, mujoco
from pathlib import Path
from mjcompose.tools.identify import check, work
from mjcompose.tools.identify.recording import read_recording
from mjcompose.tools.identify.tables import SizeLimits
robot = mujoco.MjModel.from_xml_string({robots.MODEL.format(**robots.RECIPE)!r})
keys = json.loads({keys!r})
read_recording(mujoco, robot, Path("run.csv"), "run.csv", keys, SizeLimits(10**7, 10**6))
print(sorted({{name.partition(".")[0] for name in sys.modules}} & {{"pyarrow", "mcap", "mcap_ros2", "lz4", "zstandard"}}))
"""
    ran = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"


def test_a_command_may_name_the_joint_of_an_actuator(tmp_path: Path) -> None:
    import mujoco

    text = robots.MODEL.format(**robots.RECIPE).replace('<position name="elbow"', '<position name="motor"')
    robot = mujoco.MjModel.from_xml_string(text)
    path = robots.write_mcap(tmp_path / "run.mcap", GOOD)
    found = read_recording(mujoco, robot, path, "run.mcap", {**KEYS, **COMMANDS}, LIMITS)
    assert found.commands.keys() == {"shoulder", "motor"}
