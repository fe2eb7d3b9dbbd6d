from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy
import pytest

from composer import engine

ARM = """<mujoco model="arm">
  <worldbody>
    <body name="base">
      <freejoint name="root"/>
      <geom name="box" type="box" size=".1 .2 .3"/>
      <body name="link" pos="0 0 1">
        <joint name="swing" type="ball"/>
        <geom size=".1"/>
        <body name="tip" pos="0 0 1">
          <joint name="turn" axis="0 1 0" range="-90 90"/>
          <joint name="push" type="slide"/>
          <geom size=".1"/>
          <site name="tcp"/>
          <camera name="eye"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="torque" joint="turn"/>
    <intvelocity name="servo" joint="push" kp="10" actrange="-1 1"/>
  </actuator>
  <sensor>
    <framepos name="where" objtype="site" objname="tcp"/>
    <jointactuatorfrc name="effort" joint="turn"/>
    <distance name="gap" body1="base" body2="tip" cutoff="1"/>
  </sensor>
  <keyframe><key name="home"/><key/></keyframe>
</mujoco>
"""


@pytest.fixture(scope="module")
def session() -> Iterator[engine.Session]:
    with engine.Session(engine.Limits(seconds=60)) as session:
        yield session


def put(folder: Path, text: str, name: str = "model.xml") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder


def test_a_model_that_compiles_has_its_sizes_and_the_version(tmp_path: Path, session: engine.Session) -> None:
    compiled = engine.compile(put(tmp_path, ARM), session=session)
    assert (compiled.ok, compiled.error, compiled.crash, compiled.forward) == (True, None, None, None)
    expected = {
        "nq": 13,
        "nv": 11,
        "nu": 2,
        "na": 1,
        "nbody": 4,
        "njnt": 4,
        "ngeom": 3,
        "nkey": 2,
        "nactuator": 2,
    }
    assert {name: compiled.sizes[name] for name in expected} == expected
    assert compiled.mujoco_version is not None and compiled.mujoco_version.count(".") >= 2
    assert compiled.index is None
    assert compiled.warnings == ()


def test_the_index_tells_every_address(tmp_path: Path, session: engine.Session) -> None:
    index = engine.compile(put(tmp_path, ARM), wants=("index",), session=session).index
    assert index is not None
    places = [
        (joint.name, joint.type, joint.qpos_address, joint.qpos_size, joint.dof_address, joint.dof_size)
        for joint in index.joints
    ]
    assert places == [
        ("root", "free", 0, 7, 0, 6),
        ("swing", "ball", 7, 4, 6, 3),
        ("turn", "hinge", 11, 1, 9, 1),
        ("push", "slide", 12, 1, 10, 1),
    ]
    turn = index.joints[2]
    assert turn.limited and turn.body == "tip"
    assert turn.range == pytest.approx((-numpy.pi / 2, numpy.pi / 2))
    assert not index.joints[3].limited
    assert index.actuators == (
        engine.Actuator(
            "torque", ctrl_address=0, ctrl_size=1, act_address=-1, act_size=0, unit="N m", ctrl_ranges=(None,)
        ),
        engine.Actuator(
            "servo",
            ctrl_address=1,
            ctrl_size=1,
            act_address=0,
            act_size=1,
            unit="m/s",
            ctrl_ranges=(None,),
            act_range=(-1, 1),
        ),
    )
    assert index.sensors == (
        engine.Sensor("where", "framepos", 0, 3, "m"),
        engine.Sensor("effort", "jointactuatorfrc", 3, 1, "N m"),
        engine.Sensor("gap", "distance", 4, 1, "m", 1),
    )
    assert [each.name for each in index.keyframes] == ["home", ""]
    assert [(each.name, each.unit) for each in index.cameras] == [("eye", "deg")]
    assert index.bodies == ("world", "base", "link", "tip")


def test_the_error_of_a_refused_model_is_the_text_of_mujoco(tmp_path: Path, session: engine.Session) -> None:
    compiled = engine.compile(
        put(tmp_path, '<mujoco><worldbody>\n<geom size="-1"/></worldbody></mujoco>'), session=session
    )
    assert not compiled.ok
    assert compiled.crash is None
    assert compiled.error == "Error: size 0 must be positive in geom\nElement name '', id 0, line 2"
    assert compiled.sizes == {}


def test_paths_in_errors_are_relative_to_the_folder(tmp_path: Path, session: engine.Session) -> None:
    text = '<mujoco><asset><mesh name="m" file="meshes/gone.stl"/></asset></mujoco>'
    error = engine.compile(put(tmp_path, text), session=session).error
    assert error is not None
    assert "'meshes/gone.stl'" in error
    assert str(tmp_path) not in error


def test_a_model_file_that_is_not_there_is_an_error_of_mujoco(
    tmp_path: Path, session: engine.Session
) -> None:
    compiled = engine.compile(tmp_path, "gone.xml", session=session)
    assert not compiled.ok
    assert compiled.error is not None and "gone.xml" in compiled.error


def test_a_warning_of_the_reader_arrives_once_and_writes_no_log_here(
    tmp_path: Path, session: engine.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    text = '<mujoco><worldbody/><keyframe><key ctrl="nan"/><key time="nan"/></keyframe></mujoco>'
    compiled = engine.compile(put(tmp_path, text), session=session)
    assert compiled.warnings == ("XML contains a 'NaN'. Please check it carefully.",)
    assert list(here.iterdir()) == []
    assert [file.name for file in tmp_path.iterdir() if file.is_file()] == ["model.xml"]
    assert engine.compile(put(tmp_path, "<mujoco/>"), session=session).warnings == ()


def test_a_warning_told_in_full_is_not_repeated_in_short(tmp_path: Path, session: engine.Session) -> None:
    put(
        tmp_path,
        '<mujoco><option timestep="0.02"/><worldbody><body name="b"/></worldbody></mujoco>',
        "child.xml",
    )
    text = """<mujoco><option timestep="0.01"/><asset><model name="c" file="child.xml"/></asset>
      <worldbody><attach model="c" body="b" prefix="x"/></worldbody></mujoco>"""
    warnings = engine.compile(put(tmp_path, text), session=session).warnings
    assert len(warnings) == 1
    assert "timestep: parent has 0.01, child has 0.02" in warnings[0]


def test_a_forward_step_that_is_not_finite_is_told(tmp_path: Path, session: engine.Session) -> None:
    text = """<mujoco><worldbody><body><joint name="j" stiffness="1" springref="0"/>
      <geom size=".1"/></body></worldbody><option gravity="nan 0 0"/></mujoco>"""
    compiled = engine.compile(put(tmp_path, text), session=session)
    assert compiled.ok
    assert compiled.forward == "`qacc` is not finite"


def test_text_stands_in_for_the_file_and_keeps_its_folder(tmp_path: Path, session: engine.Session) -> None:
    (tmp_path / "meshes").mkdir()
    put(
        tmp_path / "meshes",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n",
        "t.obj",
    )
    text = """<mujoco><compiler meshdir="meshes"/><asset><mesh file="t.obj"/></asset>
      <worldbody><geom type="mesh" mesh="t"/></worldbody></mujoco>"""
    compiled = engine.compile(tmp_path, "not_there.xml", text=text, session=session)
    assert compiled.error is None
    assert compiled.sizes["nmesh"] == 1
    put(tmp_path, "<mujoco/>")
    assert engine.compile(tmp_path, text=text, session=session).sizes["nmesh"] == 1


def test_a_file_that_changed_between_two_requests_is_read_anew(
    tmp_path: Path, session: engine.Session
) -> None:
    import os

    shape = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    text = """<mujoco><asset><mesh file="t.obj"/></asset>
      <worldbody><geom type="mesh" mesh="t"/></worldbody></mujoco>"""
    put(tmp_path, text)
    masses = []
    for size in (1, 2):
        put(tmp_path, shape.format(size), "t.obj")
        os.utime(tmp_path / "t.obj", (1e9, 1e9))
        measured = engine.measure(tmp_path, arrays=("body_mass",), session=session)
        masses.append(measured.arrays["body_mass"][0])
    assert masses[1] == pytest.approx(8 * masses[0])


def test_measure_brings_arrays_sizes_and_names(tmp_path: Path, session: engine.Session) -> None:
    wanted = ("geom_size", "nq", "data.xpos", "no_such_array", "names")
    measured = engine.measure(put(tmp_path, ARM), arrays=wanted, session=session)
    assert set(measured.arrays) == {"geom_size", "nq", "data.xpos", "names"}
    assert b"\0base\0link\0tip\0" in measured.arrays["names"].tobytes()
    assert measured.arrays["geom_size"][0].tolist() == [0.1, 0.2, 0.3]
    assert measured.arrays["nq"].tolist() == [13]
    assert measured.arrays["data.xpos"][3].tolist() == [0, 0, 2]
    assert measured.names["body"] == ("world", "base", "link", "tip")
    assert measured.names["geom"] == ("box", "", "")
    assert measured.names["mesh"] == ()


def test_measure_of_a_refused_model_has_no_arrays(tmp_path: Path, session: engine.Session) -> None:
    measured = engine.measure(
        put(tmp_path, "<mujoco><oops/></mujoco>"), arrays=("geom_size",), session=session
    )
    assert not measured.compiled.ok
    assert measured.arrays == {}
    assert measured.names == {}


def test_an_mjb_is_written_and_loads(tmp_path: Path, session: engine.Session) -> None:
    mujoco = pytest.importorskip("mujoco")
    assert engine.compile(put(tmp_path, ARM), mjb=tmp_path / "arm.mjb", session=session).ok
    assert mujoco.MjModel.from_binary_path(str(tmp_path / "arm.mjb")).nq == 13


def test_an_mjb_that_cannot_be_written_is_an_error(tmp_path: Path, session: engine.Session) -> None:
    compiled = engine.compile(put(tmp_path, ARM), mjb=tmp_path / "no" / "arm.mjb", session=session)
    assert not compiled.ok
    assert compiled.error


def test_names_that_are_not_ascii_come_back_as_written(tmp_path: Path, session: engine.Session) -> None:
    text = '<mujoco><worldbody><body name="größe/🦾 %s"/></worldbody></mujoco>'
    measured = engine.measure(put(tmp_path, text), session=session)
    assert measured.names["body"] == ("world", "größe/🦾 %s")


def test_run_many_answers_in_order_and_a_crash_takes_no_other_with_it(tmp_path: Path) -> None:
    good = '<mujoco><worldbody><body name="{}"/></worldbody></mujoco>'
    circle = """<mujoco><asset><model name="m" file="model.xml"/></asset>
<worldbody><attach model="m"/></worldbody></mujoco>"""
    folders = []
    for name, text in (("a", good.format("a")), ("b", circle), ("c", good.format("c"))):
        (tmp_path / name).mkdir()
        folders.append(put(tmp_path / name, text))
    answers = engine.run_many(engine.Request(folder, wants=("names",)) for folder in folders)
    assert [answer.compiled.ok for answer in answers] == [True, False, True]
    assert answers[0].names["body"] == ("world", "a")
    assert answers[2].names["body"] == ("world", "c")


def test_a_relative_folder_is_that_of_the_caller(
    tmp_path: Path, session: engine.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(tmp_path, ARM)
    monkeypatch.chdir(tmp_path)
    assert engine.compile(Path(), session=session).ok


def test_importing_the_engine_imports_neither_mujoco_nor_numpy() -> None:
    import subprocess
    import sys

    code = "import sys, composer.engine; print(sorted({'mujoco', 'numpy'} & set(sys.modules)))"
    environment = {"PYTHONPATH": str(Path(engine.__file__).parents[2])}
    shown = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert shown.stdout.strip() == "[]"


@pytest.mark.slow
def test_real_robots_compile_with_finite_forward_steps(corpus: Path, session: engine.Session) -> None:
    for path in ("universal_robots_ur5e/ur5e.xml", "robotiq_2f85/2f85.xml", "wonik_allegro/left_hand.xml"):
        file = corpus / "models" / path
        compiled = engine.compile(file.parent, file.name, wants=("index",), session=session)
        assert (compiled.error, compiled.forward, compiled.warnings) == (None, None, ())
        assert compiled.index is not None
        assert sum(joint.qpos_size for joint in compiled.index.joints) == compiled.sizes["nq"]


@pytest.mark.skipif(sys.platform == "win32", reason="timers of computing are those of POSIX")
def test_a_first_step_that_has_no_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Thousands of bodies in one place, each of which touches all others."""
    monkeypatch.setattr(engine.Limits, "step", 0.3)  # MuJoCo 3.12 takes a second to compile them
    bodies = '<body><freejoint/><geom size=".1"/></body>' * 1500
    (tmp_path / "model.xml").write_text(
        f'<mujoco><size memory="2G"/><worldbody>{bodies}</worldbody></mujoco>'
    )
    with engine.Session(engine.Limits(seconds=60)) as session:
        compiled = engine.compile(tmp_path, session=session)
    assert compiled.crash == "timeout"
    assert compiled.error == "MuJoCo's first step of the model takes longer than 0.3 s to compute"
