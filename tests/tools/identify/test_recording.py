"""Recordings are data from anyone: what is wrong with one is said, with its line and what to do."""

from __future__ import annotations

import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.language.identify import RecordingUnits
from mjcompose.tools.identify.recording import Recording, Signal, read_recording
from mjcompose.tools.identify.tables import RecordingFault, SizeLimits, _check_header
from tools.identify import robots

Columns = dict[str, np.ndarray]
KEYS: dict[str, Any] = {
    "factors": dict.fromkeys(("qpos", "qvel", "ctrl", "sensor", "time"), 1.0),
    "dimensions": {},
    "percent": [],
    "sign": {},
    "names": {},
    "ignore": [],
    "hold": False,
    "state": "/joint_states",
    "command": None,
    "command_joints": [],
    "clock": "header",
    "episode": None,
    "prefix": "",
}
LIMITS = SizeLimits(10_000_000, 100_000)
ROBOT = robots.model()
GOOD = robots.recorded(ROBOT, 1.0)


def read(path: Path, **keys: Any) -> Recording:
    return read_recording(mujoco, ROBOT, path, path.name, {**KEYS, **keys}, LIMITS)


def good() -> Columns:
    return {name: values.copy() for name, values in GOOD.items()}


def fault(path: Path, **keys: Any) -> RecordingFault:
    with pytest.raises(RecordingFault) as raised:
        read(path, **keys)
    assert raised.value.file == path.name
    return raised.value


def renamed(old: str, new: str) -> Callable[[Columns], Columns]:
    return lambda columns: {new if name == old else name: values for name, values in columns.items()}


def without(name: str) -> Callable[[Columns], Columns]:
    return lambda columns: {each: values for each, values in columns.items() if each != name}


def changed(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Columns], Columns]:
    return lambda columns: {each: change(values) if each == name else values for each, values in columns.items()}


def with_nan(values: np.ndarray) -> np.ndarray:
    values[17] = np.nan
    return values


def with_infinity(values: np.ndarray) -> np.ndarray:
    values[17] = np.inf
    return values


def going_back(times: np.ndarray) -> np.ndarray:
    times[100] = times[98]
    return times


def with_gap(times: np.ndarray) -> np.ndarray:
    times[150:] += 0.6
    return times


@pytest.mark.parametrize(
    ("change", "code", "message", "help"),
    [
        (renamed("qpos elbow", "qpos elbw"), "recording-column", "`qpos elbw` names no joint", "did you mean `elbow`?"),
        (renamed("qpos elbow", "elbow"), "recording-column", "column `elbow` begins with none of", "`qpos arm/elbow`"),
        (renamed("time", "clock"), "recording-column", "it has no column `time`", "name the column"),
        (
            changed("qpos elbow", with_nan),
            "recording-value",
            "has no number in 1 row, first at 0.068 s",
            "remove these",
        ),
        (changed("time", going_back), "recording-time", "the time goes back or does not pass", "sort the rows"),
        (
            changed("time", lambda t: t * 1e6),
            "recording-time",
            "4000 s pass between",
            "`recording: {units: {time: ms}}`",
        ),
        (
            changed("time", with_gap),
            "recording-time",
            "nothing for 0.60 s from 0.596 s on, 151 usual",
            "cut the recording",
        ),
        (changed("time", lambda t: t * 250), "recording-time", "1 s pass between", "or `time: s` if it is right"),
        (changed("time", lambda t: t / 1e3), "recording-time", "it is 1 ms long", "record some seconds"),
        (changed("qpos elbow", lambda q: np.degrees(q) + 150), "recording-unit", "reaches", "units: {qpos: deg}"),
        (changed("ctrl elbow", lambda q: np.degrees(q) + 150), "recording-unit", "reaches", "units: {ctrl: deg}"),
        (
            changed("qpos elbow", lambda q: -q),
            "recording-sign",
            "moves against its command",
            'sign: {"qpos elbow": -1}',
        ),
        (changed("ctrl elbow", with_infinity), "recording-value", "has no number in 1 row", "remove these"),
        (
            renamed("qpos elbow", "qpos elbow[3]"),
            "recording-column",
            "`qpos elbow[3]` does not exist: `elbow` has 1 number",
            "leave out the index",
        ),
        (
            lambda columns: {**columns, "ctrl elbow[0]": columns["ctrl elbow"] * 2},
            "recording-column",
            "`ctrl elbow` and `ctrl elbow[0]` are both `ctrl elbow`",
            "remove one of them",
        ),
        (
            without("ctrl elbow"),
            "recording-column",
            "it has no commands of actuator `elbow`",
            "`recording: {hold: true}`",
        ),
        (
            lambda columns: {name: each for name, each in columns.items() if not name.startswith("qpos")},
            "recording-column",
            "it has no column that the model could be compared with",
            "record `qpos JOINT`",
        ),
    ],
)
@pytest.mark.parametrize("write", [robots.write_csv, robots.write_npz])
def test_a_wrong_recording(
    change: Callable[[Columns], Columns], code: str, message: str, help: str, write: Any, tmp_path: Path
) -> None:
    suffix = ".csv" if write is robots.write_csv else ".npz"
    found = fault(write(tmp_path / f"bad{suffix}", change(good())))
    assert (found.code, found.field) == (code, None)
    assert message in found.message
    assert help in str(found.help)


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("", "recording-column", None),
        ("time,qpos elbow\n", "recording-time", None),
        ("time,qpos elbow,qpos elbow\n0,1,2\n", "recording-column", 1),
        ("time,qpos elbow\n0,1\n0.1,1,2\n", "recording-value", 3),
        ("time,qpos elbow\n0,1\n\n0.1,up\n", "recording-value", 4),
        ("time,qpos elbow\n0,1\n0.1,2\n0.05,3\n", "recording-time", 4),
        ('time,qpos elbow\n0,"1\n', "recording-time", None),
        ("\0\0\0", "recording-column", None),
        ("time;qpos elbow\n0;1\n", "recording-column", 1),
        ("time,qpos elbow\n0,1\n0.1,1_000\n", "recording-value", 3),
        ("time,qpos elbow\n0,1\n0.1,١\n", "recording-value", 3),
    ],
)
def test_a_text_that_is_no_table(text: str, code: str, line: int | None, tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    found = fault(path)
    assert (found.code, found.line) == (code, line)


def test_percent_of_the_range_is_the_same_motion(tmp_path: Path) -> None:
    low, high = ROBOT.joint("elbow").range
    columns = good()
    for name in ("qpos elbow", "ctrl elbow"):
        columns[name] = 100 * (columns[name] - low) / (high - low)
    columns["qvel elbow"] = np.full_like(columns["time"], 25.0)
    found = read(robots.write_csv(tmp_path / "run.csv", columns), percent=["elbow"])
    assert found.signals[Signal("qpos", "elbow")] == pytest.approx(GOOD["qpos elbow"], abs=1e-6)
    assert found.commands["elbow"].values == pytest.approx(GOOD["ctrl elbow"], abs=1e-6)
    assert found.signals[Signal("qvel", "elbow")] == pytest.approx(0.25 * (high - low))
    assert found.signals[Signal("qpos", "shoulder")] == pytest.approx(GOOD["qpos shoulder"], abs=1e-6)


def test_percent_that_counts_down(tmp_path: Path) -> None:
    low, high = ROBOT.joint("elbow").range
    columns = good()
    for name in ("qpos elbow", "ctrl elbow"):
        columns[name] = 100 * (high - columns[name]) / (high - low)
    found = read(robots.write_csv(tmp_path / "run.csv", columns), percent=["elbow"], sign={"elbow": -1})
    assert found.signals[Signal("qpos", "elbow")] == pytest.approx(GOOD["qpos elbow"], abs=1e-6)


def test_percent_of_a_joint_that_has_no_percent(tmp_path: Path) -> None:
    path = robots.write_csv(tmp_path / "run.csv", good())
    unknown = fault(path, percent=["elbw"])
    assert (unknown.code, unknown.help) == ("unknown-name", "did you mean `elbow`?")
    assert unknown.at == ("recording", "percent")
    endless = mujoco.MjModel.from_xml_string(robots.MODEL.format(**robots.RECIPE).replace(' range="-2 2"', ""))
    with pytest.raises(RecordingFault, match="`elbow` has no range") as raised:
        read_recording(mujoco, endless, path, path.name, {**KEYS, "percent": ["elbow"]}, LIMITS)
    assert raised.value.code == "recording-unit"


def test_files_that_are_no_recordings(tmp_path: Path) -> None:
    assert fault(tmp_path / "none.csv").code == "file-not-found"
    (tmp_path / "run.bag").write_text("")
    assert fault(tmp_path / "run.bag").code == "recording-kind"
    (tmp_path / "run.npz").write_text("not a zip")
    assert fault(tmp_path / "run.npz").code == "recording-kind"
    (tmp_path / "folder.csv").mkdir()
    assert fault(tmp_path / "folder.csv").code == "recording-kind"


def test_an_npz_runs_no_code_and_unpacks_no_bomb(tmp_path: Path) -> None:
    path = tmp_path / "pickled.npz"
    np.savez(path, time=np.array([object()], dtype=object))
    assert (fault(path).code, "not numbers" in fault(path).message) == ("recording-value", True)
    bomb = tmp_path / "bomb.npz"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("time.npy", "w") as file:
        np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": (10_000_000_000,)})
        file.write(bytes(1_000_000))
    assert fault(bomb).code == "limit-exceeded"


def test_a_header_of_an_npz_is_read_within_bounds(tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.npz"
    length = 100 << 20
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("time.npy", "w") as file:
        file.write(b"\x93NUMPY\x02\x00" + length.to_bytes(4, "little"))
        file.write(bytes(length))
    tracemalloc.start()
    assert fault(bomb).code == "recording-kind"
    assert tracemalloc.get_traced_memory()[1] < length / 10
    tracemalloc.stop()


def test_an_npz_with_two_arrays_of_one_name(tmp_path: Path) -> None:
    path = robots.write_npz(tmp_path / "run.npz", GOOD)
    with zipfile.ZipFile(path, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("qpos elbow.npy", archive.read("ctrl elbow.npy"))
    assert "two columns `qpos elbow`" in fault(path).message


def test_a_damaged_npz(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    np.savez_compressed(path, **GOOD)  # type: ignore[arg-type]
    damaged = bytearray(path.read_bytes())
    for place in range(400, 1600, 7):
        damaged[place] ^= 0xFF
    path.write_bytes(damaged)
    assert fault(path).code == "recording-kind"


def test_text_in_another_encoding(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,qpos elbow\n0,1\n", encoding="utf-16")
    assert (fault(path).code, fault(path).help) == ("recording-kind", "save it as UTF-8")


class Name(str):
    """A name that counts how often it is compared."""

    compared = 0

    def __eq__(self, other: object) -> bool:
        Name.compared += 1
        return super().__eq__(other)

    __hash__ = str.__hash__


def test_each_column_is_compared_with_few_others() -> None:
    Name.compared = 0
    _check_header([Name(f"c{index}") for index in range(3000)])
    assert Name.compared < 3000


def test_a_fault_of_an_npz_has_no_line(tmp_path: Path) -> None:
    columns = renamed("qpos elbow", "qpos elbw")(good())
    assert fault(robots.write_npz(tmp_path / "run.npz", columns)).line is None
    assert fault(robots.write_csv(tmp_path / "run.csv", columns)).line == 1


MIXED = mujoco.MjModel.from_xml_string(
    """<mujoco><worldbody>
      <body><joint name="hinge"/><geom size=".1"/>
        <body><joint name="rail" type="slide"/><geom size=".1"/></body>
        <body><joint name="ball" type="ball"/><geom size=".1"/></body></body>
      <body><freejoint name="free"/><geom size=".1"/></body></worldbody>
    <actuator><position name="hinge" joint="hinge"/><position name="rail" joint="rail"/>
      <motor name="motor" joint="hinge"/></actuator>
    <sensor><framepos name="tip" objtype="body" objname="world"/></sensor></mujoco>"""
)
MIXED_COLUMNS = {
    "time": np.linspace(0, 1, 50),
    **{name: np.linspace(0, 0.9, 50) for name in ("qpos hinge", "qpos rail", "ctrl hinge", "ctrl rail", "ctrl motor")},
}


def read_mixed(path: Path, extra: str | None = None, **keys: Any) -> Recording:
    columns = MIXED_COLUMNS if extra is None else {**MIXED_COLUMNS, extra: MIXED_COLUMNS["time"]}
    robots.write_csv(path, columns)
    return read_recording(mujoco, MIXED, path, path.name, {**KEYS, **keys}, LIMITS)


def test_an_angle_is_the_unit_of_hinges_only(tmp_path: Path) -> None:
    units = RecordingUnits(qpos="deg", ctrl="deg")
    found = read_mixed(tmp_path / "run.csv", factors=units.factors, dimensions=units.dimensions)
    assert found.signals[Signal("qpos", "hinge")][-1] == pytest.approx(np.radians(0.9))
    assert found.signals[Signal("qpos", "rail")][-1] == pytest.approx(0.9)
    commands = {name: float(command.values[-1]) for name, command in found.commands.items()}
    assert commands == pytest.approx({"hinge": np.radians(0.9), "rail": 0.9, "motor": 0.9})


def test_a_unit_of_no_column(tmp_path: Path) -> None:
    units = RecordingUnits(qpos="mm")
    path = robots.write_csv(tmp_path / "run.csv", GOOD)
    found = fault(path, factors=units.factors, dimensions=units.dimensions)
    assert (found.code, found.message) == (
        "recording-unit",
        "the unit of `qpos` is a length, and no column `qpos` has one",
    )


@pytest.mark.parametrize("column", ["qpos ball", "qvel free", "sensor tip[3]"])
def test_columns_that_no_single_number_of_the_model_has(column: str, tmp_path: Path) -> None:
    with pytest.raises(RecordingFault) as raised:
        read_mixed(tmp_path / "run.csv", column)
    assert raised.value.code == "recording-column"
    assert f"`{column}`" in raised.value.message
    assert read_mixed(tmp_path / "run.csv", "sensor tip[2]").seconds == 1


@pytest.mark.parametrize("name", ["elbw", "qpos elbw", "elbow ctrl"])
def test_a_sign_of_no_element(name: str, tmp_path: Path) -> None:
    found = fault(robots.write_csv(tmp_path / "run.csv", GOOD), sign={name: -1})
    assert (found.code, f"`{name}`" in found.message) == ("unknown-name", True)


def test_signs_have_the_names_of_the_nested_recipe(tmp_path: Path) -> None:
    robot = mujoco.MjModel.from_xml_string(
        robots.MODEL.format(**robots.RECIPE).replace('"elbow"', '"left/elbow"').replace('"shoulder"', '"left/shoulder"')
    )
    columns = good()
    columns["qpos elbow"] *= -1
    path = robots.write_csv(tmp_path / "run.csv", columns)
    keys = {**KEYS, "prefix": "left/", "sign": {"qpos elbow": -1}}
    found = read_recording(mujoco, robot, path, "run.csv", keys, LIMITS)
    assert np.abs(found.signals[Signal("qpos", "left/elbow")] - GOOD["qpos elbow"]).max() < 1e-8


def test_a_recording_within_the_limits(tmp_path: Path) -> None:
    path = robots.write_csv(tmp_path / "run.csv", GOOD)
    with pytest.raises(RecordingFault, match="numbers; 100 are allowed"):
        read_recording(mujoco, ROBOT, path, "run.csv", KEYS, SizeLimits(10_000_000, 100))
    with pytest.raises(RecordingFault, match="bytes; 100 are allowed"):
        read_recording(mujoco, ROBOT, path, "run.csv", KEYS, SizeLimits(100, 100_000))


def test_formats_are_equal(tmp_path: Path) -> None:
    from_csv = read(robots.write_csv(tmp_path / "run.csv", GOOD))
    from_npz = read(robots.write_npz(tmp_path / "run.npz", GOOD))
    assert from_csv.signals.keys() == from_npz.signals.keys() == {Signal("qpos", "shoulder"), Signal("qpos", "elbow")}
    for signal, values in from_csv.signals.items():
        assert np.abs(values - from_npz.signals[signal]).max() < 1e-8
    for name, command in from_csv.commands.items():
        assert np.abs(command.values - from_npz.commands[name].values).max() < 1e-8


def test_units_signs_and_names(tmp_path: Path) -> None:
    columns = good()
    columns = {
        "t": columns["time"] * 1e3,
        "qpos j2": -np.degrees(columns["qpos elbow"]),
        "qpos shoulder": np.degrees(columns["qpos shoulder"]),
        "qpos gripper": columns["time"],
        "ctrl elbow": columns["ctrl elbow"],
        "ctrl shoulder": columns["ctrl shoulder"],
    }
    path = robots.write_csv(tmp_path / "run.csv", columns)
    factors = {**KEYS["factors"], "qpos": np.pi / 180, "time": 1e-3}
    signs = {"qpos elbow": -1, "shoulder": 1}
    found = read(path, factors=factors, names={"j2": "elbow"}, ignore=["grip*"], sign=signs)
    assert np.abs(found.signals[Signal("qpos", "elbow")] - GOOD["qpos elbow"]).max() < 1e-8
    assert np.abs(found.commands["elbow"].values - GOOD["ctrl elbow"]).max() < 1e-8
    assert found.seconds == pytest.approx(0.996)


def test_a_name_alone_turns_positions_and_commands(tmp_path: Path) -> None:
    columns = good()
    columns["qpos elbow"] *= -1
    columns["ctrl elbow"] *= -1
    found = read(robots.write_csv(tmp_path / "run.csv", columns), sign={"elbow": -1})
    assert np.abs(found.signals[Signal("qpos", "elbow")] - GOOD["qpos elbow"]).max() < 1e-8
    assert np.abs(found.commands["elbow"].values - GOOD["ctrl elbow"]).max() < 1e-8


def test_a_sign_can_be_right_although_it_looks_wrong(tmp_path: Path) -> None:
    columns = good()
    columns["qpos elbow"] *= -1
    path = robots.write_csv(tmp_path / "run.csv", columns)
    assert fault(path).code == "recording-sign"
    assert read(path, sign={"elbow": 1}).seconds > 0.9
