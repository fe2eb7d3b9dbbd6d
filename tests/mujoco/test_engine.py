from __future__ import annotations

import json
import os
import secrets
import signal
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from typing import Any

import mjcompose
import numpy
import pytest
from mjcompose.base.limits import GIB, allow
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import CompileRequest, RequestLimits, Session
from mjcompose.mujoco.index import CompiledActuator, CompiledSensor


def test_the_defaults() -> None:
    assert RequestLimits() == RequestLimits(seconds=300, memory=8 * GIB)


def test_limits_in_force_count_where_none_are_given() -> None:
    with allow(time=7, memory=GIB):
        assert RequestLimits() == RequestLimits(seconds=7, memory=GIB)
        assert RequestLimits(seconds=3) == RequestLimits(seconds=3, memory=GIB)


@pytest.mark.parametrize("wrong", [{"seconds": 0}, {"seconds": float("nan")}, {"memory": -1}])
def test_limits_are_greater_than_zero(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="greater than zero"):
        RequestLimits(**wrong)  # type: ignore[arg-type]


def test_a_misspelt_want_is_refused() -> None:
    with pytest.raises(ValueError, match=r"unknown needs \['indexx'\]; there are \['forward', 'index', 'names'\]"):
        CompileRequest(Path(), wants=("indexx",))


def test_its_json_is_one_line_with_absolute_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    line = CompileRequest(Path("in"), mjb=Path("out.mjb"), text="<mujoco>\n\u2028</mujoco>").to_json(tmp_path / "a.npz")
    assert "\n" not in line and "\r" not in line
    sent = json.loads(line)
    assert sent["folder"] == str(tmp_path / "in")
    assert sent["mjb"] == str(tmp_path / "out.mjb")
    assert sent["text"] == "<mujoco>\n\u2028</mujoco>"


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
    with engine.Session(engine.RequestLimits(seconds=60)) as session:
        yield session


def put(folder: Path, text: str, name: str = "model.xml") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder


def test_a_model_that_compiles_has_its_sizes_and_the_version(tmp_path: Path, session: engine.Session) -> None:
    compiled = engine.compile(put(tmp_path, ARM), session=session)
    assert (compiled.ok, compiled.error, compiled.crash, compiled.forward) == (True, None, None, None)
    expected = {"nq": 13, "nv": 11, "nu": 2, "na": 1, "nbody": 4, "njnt": 4, "ngeom": 3, "nkey": 2, "nactuator": 2}
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
        CompiledActuator(
            "torque",
            ctrl_address=0,
            ctrl_size=1,
            act_address=-1,
            act_size=0,
            unit="N m",
            ctrl_ranges=(None,),
            joint="turn",
        ),
        CompiledActuator(
            "servo",
            ctrl_address=1,
            ctrl_size=1,
            act_address=0,
            act_size=1,
            unit="m/s",
            ctrl_ranges=(None,),
            act_range=(-1, 1),
            joint="push",
        ),
    )
    assert index.sensors == (
        CompiledSensor("where", "framepos", 0, 3, "m"),
        CompiledSensor("effort", "jointactuatorfrc", 3, 1, "N m"),
        CompiledSensor("gap", "distance", 4, 1, "m", 1),
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


def test_a_model_file_that_is_not_there_is_an_error_of_mujoco(tmp_path: Path, session: engine.Session) -> None:
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
    put(tmp_path, '<mujoco><option timestep="0.02"/><worldbody><body name="b"/></worldbody></mujoco>', "child.xml")
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
    put(tmp_path / "meshes", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "t.obj")
    text = """<mujoco><compiler meshdir="meshes"/><asset><mesh file="t.obj"/></asset>
      <worldbody><geom type="mesh" mesh="t"/></worldbody></mujoco>"""
    compiled = engine.compile(tmp_path, "not_there.xml", text=text, session=session)
    assert compiled.error is None
    assert compiled.sizes["nmesh"] == 1
    put(tmp_path, "<mujoco/>")
    assert engine.compile(tmp_path, text=text, session=session).sizes["nmesh"] == 1


def test_a_file_that_changed_between_two_requests_is_read_anew(tmp_path: Path, session: engine.Session) -> None:
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
    measured = engine.measure(put(tmp_path, "<mujoco><oops/></mujoco>"), arrays=("geom_size",), session=session)
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


def test_a_crash_takes_no_other_model_with_it(tmp_path: Path) -> None:
    good = '<mujoco><worldbody><body name="{}"/></worldbody></mujoco>'
    circle = """<mujoco><asset><model name="m" file="model.xml"/></asset>
<worldbody><attach model="m"/></worldbody></mujoco>"""
    folders = []
    for name, text in (("a", good.format("a")), ("b", circle), ("c", good.format("c"))):
        (tmp_path / name).mkdir()
        folders.append(put(tmp_path / name, text))
    with engine.Session() as session:
        answers = [engine.measure(folder, session=session) for folder in folders]
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

    code = "import sys, mjcompose.mujoco; print(sorted({'mujoco', 'numpy'} & set(sys.modules)))"
    environment = {"PYTHONPATH": str(Path(mjcompose.__file__).parents[1])}
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
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
    monkeypatch.setattr(engine.RequestLimits, "step", 0.3)  # MuJoCo 3.12 takes a second to compile them
    bodies = '<body><freejoint/><geom size=".1"/></body>' * 1500
    (tmp_path / "model.xml").write_text(f'<mujoco><size memory="2G"/><worldbody>{bodies}</worldbody></mujoco>')
    with engine.Session(engine.RequestLimits(seconds=60)) as session:
        compiled = engine.compile(tmp_path, session=session)
    assert compiled.crash == "timeout"
    assert compiled.error == "MuJoCo needs more than 0.3 s for the first step of the model"


GOOD = "<mujoco/>"
CIRCLE = """<mujoco><asset><model name="m" file="model.xml"/></asset>
<worldbody><attach model="m"/></worldbody></mujoco>"""
FORMAT = '<mujoco><worldbody><geom class="%s%s%s%s%s%s%s%s"/></worldbody></mujoco>'
ENDLESS = """<mujoco><worldbody><replicate count="100000000" offset="1 0 0"><geom size="1"/></replicate>
</worldbody></mujoco>"""
HUGE = """<mujoco><asset><hfield name="h" nrow="20000" ncol="20000" size="1 1 1 1"/></asset>
<worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>"""

posix = pytest.mark.skipif(os.name != "posix", reason="only POSIX has signals and limits for a process")


def put_session(folder: Path, text: str) -> Path:
    (folder / "model.xml").write_text(text)
    return folder


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Any]:
    """Makes a module that this process and, by its sys.path, the child can import."""
    folder = tmp_path / "modules"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)

    def make(code: str) -> Any:
        name = f"made_for_a_test_{secrets.token_hex(8)}"
        (folder / f"{name}.py").write_text(code)
        return import_module(name)

    return make


@posix
def test_a_circle_of_models_kills_only_the_child(tmp_path: Path) -> None:
    compiled = engine.compile(put_session(tmp_path, CIRCLE))
    assert not compiled.ok
    if compiled.crash is None:
        assert compiled.error, "a MuJoCo that no longer crashes says why it refuses"
    else:
        assert compiled.crash.startswith("signal ")
        assert compiled.error is not None and compiled.error.startswith("MuJoCo crashed with signal ")


@posix
def test_a_class_with_printf_directives_kills_only_the_child(tmp_path: Path) -> None:
    compiled = engine.compile(put_session(tmp_path, FORMAT))
    assert not compiled.ok
    assert compiled.error
    assert compiled.crash is None or compiled.crash.startswith("signal ")


def test_what_takes_too_long_is_ended(tmp_path: Path) -> None:
    put_session(tmp_path, ENDLESS)
    start = time.monotonic()
    compiled = engine.compile(tmp_path, limits=engine.RequestLimits(seconds=1))
    assert compiled.crash == "timeout"
    assert compiled.error == "MuJoCo did not finish within 1 s"
    assert time.monotonic() - start < 60


@posix
@pytest.mark.skipif(sys.platform == "darwin", reason="macOS does not keep the limit")
def test_what_takes_too_much_memory_is_refused(tmp_path: Path) -> None:
    compiled = engine.compile(put_session(tmp_path, HUGE), limits=engine.RequestLimits(memory=1 << 30))
    assert compiled.crash == "memory"
    assert compiled.error is not None
    assert compiled.error.startswith("MuJoCo needs more than the 1 GiB of memory that it may use")


@posix
def test_a_session_goes_on_after_a_crash(tmp_path: Path) -> None:
    with Session(engine.RequestLimits(seconds=2)) as session:
        assert engine.compile(put_session(tmp_path, GOOD), session=session).ok
        assert engine.compile(put_session(tmp_path, ENDLESS), session=session).crash == "timeout"
        assert engine.compile(put_session(tmp_path, GOOD), session=session).ok


def test_one_process_answers_all_requests_of_a_session(tmp_path: Path) -> None:
    put_session(tmp_path, GOOD)
    with Session() as session:
        engine.compile(tmp_path, session=session)
        first = session._process
        engine.compile(tmp_path, session=session)
        assert first is not None
        assert session._process is first
    assert first.poll() is not None, "closing ends the process"


def test_a_process_that_was_begun_answers_the_first_request(tmp_path: Path) -> None:
    put_session(tmp_path, GOOD)
    with Session() as session:
        session.begin()
        begun = session._process
        session.begin()
        assert begun is not None and session.mujoco_version is None, "nobody has waited for it"
        assert engine.compile(tmp_path, session=session).ok
        assert session._process is begun and session.mujoco_version is not None


def test_what_prevents_a_beginning_is_the_answer_to_the_first_request(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "executable", str(tmp_path / "no-python"))
    with Session() as session:
        session.begin()
        assert engine.compile(put_session(tmp_path, GOOD), session=session).crash == "start"


def test_nothing_is_left_in_the_folder_for_temporary_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import tempfile

    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    put_session(tmp_path, '<mujoco><keyframe><key time="nan"/></keyframe></mujoco>')
    assert engine.measure(tmp_path, arrays=("body_mass",)).arrays["body_mass"].shape == (1,)
    assert list(scratch.iterdir()) == []


def test_a_missing_mujoco_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mujoco.py").write_text("raise ModuleNotFoundError(\"No module named 'mujoco'\")")
    monkeypatch.syspath_prepend(tmp_path)
    compiled = engine.compile(put_session(tmp_path, GOOD))
    assert compiled.crash == "missing"
    assert compiled.error is not None
    assert compiled.error.endswith("ModuleNotFoundError: No module named 'mujoco'")
    assert "Traceback" not in compiled.error


@pytest.mark.own_children
def test_a_mujoco_that_is_too_old_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.mujoco.engine.OLDEST", "99.1")
    compiled = engine.compile(put_session(tmp_path, GOOD))
    assert compiled.crash == "missing" and compiled.error is not None
    assert compiled.error.startswith("mjcompose builds with MuJoCo 99.1 or newer; MuJoCo")


@pytest.mark.own_children
def test_a_mujoco_that_another_package_pins_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "trainer-1.6.0.dist-info").mkdir()
    words = (
        "Metadata-Version: 2.1\nName: trainer\nVersion: 1.6.0\nRequires-Dist: mujoco~=3.9.0\nRequires-Dist: numpy<3\n"
    )
    (tmp_path / "trainer-1.6.0.dist-info/METADATA").write_text(words + "Requires-Dist: mujoco-mjx==3.9\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("mjcompose.mujoco.engine.OLDEST", "99.1")
    error = engine.compile(put_session(tmp_path, GOOD)).error
    assert error is not None and "; `trainer 1.6.0` requires `mujoco~=3.9.0`" in error
    assert "mujoco-mjx" not in error and "numpy" not in error


def test_a_python_that_cannot_be_started_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", str(tmp_path / "no_python"))
    compiled = engine.compile(put_session(tmp_path, GOOD))
    assert compiled.crash == "start"
    assert compiled.error is not None and compiled.error.startswith("cannot start a process for MuJoCo: ")


def test_a_child_that_ends_by_itself_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import sys, os\nsys.stderr.write('last words\\n'); sys.stderr.flush(); os._exit(3)"
    (tmp_path / "mujoco.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    compiled = engine.compile(put_session(tmp_path, GOOD))
    assert compiled.crash == "exit 3"
    assert compiled.error == "MuJoCo's process ended with status 3: last words"


def test_python_variables_of_the_environment_do_not_reach_the_child(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONHOME", str(tmp_path))
    monkeypatch.setenv("MUJOCO_GL", "no such renderer")
    assert engine.compile(put_session(tmp_path, GOOD)).ok


class TestCall:
    def test_a_function_gets_the_kept_models(self, tmp_path: Path, module: Callable[[str], Any]) -> None:
        made = module("def count(mujoco, a, b, argument):\n    return [a.nbody, b.nbody, argument, mujoco.__name__]\n")
        bodies = "<mujoco><worldbody>{}</worldbody></mujoco>"
        with Session() as session:
            engine.compile(tmp_path, text=bodies.format("<body/>"), keep="one", session=session)
            engine.compile(tmp_path, text=bodies.format("<body/><body/>"), keep="two", session=session)
            called = engine.call(session, made.count, ["one", "two"], {"x": 1})
        assert (called.ok, called.error) == (True, None)
        assert called.value == [2, 3, {"x": 1}, "mujoco"]

    def test_prints_of_the_child_do_not_reach_the_answers(
        self, tmp_path: Path, module: Callable[[str], Any], capfd: pytest.CaptureFixture[str]
    ) -> None:
        code = "import os\ndef noise(mujoco, argument):\n    os.write(1, b'{}\\n'); print('x' * 99999)\n"
        made = module(code)
        with Session() as session:
            called = engine.call(session, made.noise, [], None)
            assert called.ok
            assert engine.compile(put_session(tmp_path, GOOD), session=session).ok
        assert capfd.readouterr() == ("", "")

    def test_an_exception_is_an_error(self, module: Callable[[str], Any]) -> None:
        made = module("def fail(mujoco, argument):\n    raise KeyError(argument)\n")
        with Session() as session:
            called = engine.call(session, made.fail, [], "elbow")
        assert not called.ok
        assert called.error == "KeyError: 'elbow'"

    def test_a_model_that_was_not_kept_is_an_error(self, module: Callable[[str], Any]) -> None:
        made = module("def fail(mujoco, model, argument):\n    return 1\n")
        with Session() as session:
            called = engine.call(session, made.fail, ["part"], None)
        assert called.error == "no model is kept as `part`"


@posix
def test_names_that_this_process_cannot_read_are_bytes(tmp_path: Path) -> None:
    """In a locale without UTF-8 the bytes of a letter are two characters that stand for bytes."""
    (tmp_path / "ü").mkdir()
    put_session(tmp_path / "ü", GOOD)
    with Session() as session:
        answer, _ = session.ask(engine.CompileRequest(tmp_path / "\udcc3\udcbc"))
    assert answer["ok"], answer


@posix
def test_each_answer_has_the_index_of_its_own_model(tmp_path: Path) -> None:
    """What crosses from MuJoCo's process only once: the same index again, also after another one and a crash."""

    def bodies(session: Session, text: str) -> tuple[str, ...] | None:
        compiled = engine.compile(put_session(tmp_path, text), wants=("index",), session=session)
        return None if compiled.index is None else compiled.index.bodies

    def named(name: str, size: int = 1) -> str:
        return f'<mujoco><worldbody><body name="{name}"><geom size="{size}"/></body></worldbody></mujoco>'

    with engine.Session() as session:
        assert bodies(session, named("a")) == ("world", "a")
        assert bodies(session, named("a", 2)) == ("world", "a")
        assert bodies(session, named("b")) == ("world", "b")
        assert bodies(session, "<mujoco><worldbody>") is None
        assert bodies(session, named("b", 2)) == ("world", "b")
        mjb = tmp_path / "none" / "a.mjb"
        failed = engine.compile(put_session(tmp_path, named("c")), wants=("index",), mjb=mjb, session=session)
        assert not failed.ok
        assert bodies(session, named("c")) == ("world", "c")
        session._stop()
        assert bodies(session, named("c", 2)) == ("world", "c")


@posix
def test_a_name_that_is_no_text_is_a_sentence(tmp_path: Path) -> None:
    try:
        (tmp_path / "a\udcff.xml").write_text(GOOD)
    except OSError:
        pytest.skip("this file system takes only text")
    compiled = engine.compile(tmp_path, "a\udcff.xml")
    assert not compiled.ok and "UTF-8: rename it" in str(compiled.error) and compiled.crash is None


@posix
def test_another_thread_ends_who_waits_and_who_asks_later(tmp_path: Path) -> None:
    put_session(tmp_path, GOOD)
    session = Session()
    with session, ThreadPoolExecutor(1) as executor:
        assert engine.compile(tmp_path, session=session).ok
        assert session._process is not None
        os.kill(session._process.pid, signal.SIGSTOP)
        waits = executor.submit(engine.compile, tmp_path, session=session)
        time.sleep(0.2)
        begun = time.monotonic()
        session.end()
        assert waits.result(20).crash == "stopped" and time.monotonic() - begun < 5
        assert engine.compile(tmp_path, session=session).crash == "stopped"
