from __future__ import annotations

import os
import secrets
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from composer import engine
from composer.engine.session import Session

GOOD = "<mujoco/>"
CIRCLE = """<mujoco><asset><model name="m" file="model.xml"/></asset>
<worldbody><attach model="m"/></worldbody></mujoco>"""
FORMAT = '<mujoco><worldbody><geom class="%s%s%s%s%s%s%s%s"/></worldbody></mujoco>'
ENDLESS = """<mujoco><worldbody><replicate count="100000000" offset="1 0 0"><geom size="1"/></replicate>
</worldbody></mujoco>"""
HUGE = """<mujoco><asset><hfield name="h" nrow="20000" ncol="20000" size="1 1 1 1"/></asset>
<worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>"""

posix = pytest.mark.skipif(os.name != "posix", reason="only POSIX has signals and limits for a process")


def put(folder: Path, text: str) -> Path:
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
    compiled = engine.compile(put(tmp_path, CIRCLE))
    assert not compiled.ok
    if compiled.crash is None:
        assert compiled.error, "a MuJoCo that no longer crashes says why it refuses"
    else:
        assert compiled.crash.startswith("signal ")
        assert compiled.error is not None and compiled.error.startswith("MuJoCo crashed with signal ")


@posix
def test_a_class_with_printf_directives_kills_only_the_child(tmp_path: Path) -> None:
    compiled = engine.compile(put(tmp_path, FORMAT))
    assert not compiled.ok
    assert compiled.error
    assert compiled.crash is None or compiled.crash.startswith("signal ")


def test_what_takes_too_long_is_ended(tmp_path: Path) -> None:
    put(tmp_path, ENDLESS)
    start = time.monotonic()
    compiled = engine.compile(tmp_path, limits=engine.Limits(seconds=1))
    assert compiled.crash == "timeout"
    assert compiled.error == "MuJoCo did not finish within 1 s"
    assert time.monotonic() - start < 60


@posix
@pytest.mark.skipif(sys.platform == "darwin", reason="macOS does not keep the limit")
def test_what_takes_too_much_memory_is_refused(tmp_path: Path) -> None:
    compiled = engine.compile(put(tmp_path, HUGE), limits=engine.Limits(memory=1 << 30))
    assert compiled.crash == "memory"
    assert compiled.error is not None
    assert compiled.error.startswith("MuJoCo ran out of the 1 GiB of memory it was given")


@posix
def test_a_session_goes_on_after_a_crash(tmp_path: Path) -> None:
    with Session(engine.Limits(seconds=2)) as session:
        assert engine.compile(put(tmp_path, GOOD), session=session).ok
        assert engine.compile(put(tmp_path, ENDLESS), session=session).crash == "timeout"
        assert engine.compile(put(tmp_path, GOOD), session=session).ok


def test_one_process_answers_all_requests_of_a_session(tmp_path: Path) -> None:
    put(tmp_path, GOOD)
    with Session() as session:
        engine.compile(tmp_path, session=session)
        first = session._process
        engine.compile(tmp_path, session=session)
        assert first is not None
        assert session._process is first
    assert first.poll() is not None, "closing ends the process"


def test_a_process_that_was_begun_answers_the_first_request(tmp_path: Path) -> None:
    put(tmp_path, GOOD)
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
        assert engine.compile(put(tmp_path, GOOD), session=session).crash == "start"


def test_nothing_is_left_in_the_folder_for_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import tempfile

    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    put(tmp_path, '<mujoco><keyframe><key time="nan"/></keyframe></mujoco>')
    assert engine.measure(tmp_path, arrays=("body_mass",)).arrays["body_mass"].shape == (1,)
    assert list(scratch.iterdir()) == []


def test_a_missing_mujoco_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mujoco.py").write_text("raise ModuleNotFoundError(\"No module named 'mujoco'\")")
    monkeypatch.syspath_prepend(tmp_path)
    compiled = engine.compile(put(tmp_path, GOOD))
    assert compiled.crash == "missing"
    assert compiled.error is not None
    assert compiled.error.endswith("ModuleNotFoundError: No module named 'mujoco'")
    assert "Traceback" not in compiled.error


@pytest.mark.own_children
def test_a_mujoco_that_is_too_old_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("composer.engine.session.OLDEST", "99.1")
    compiled = engine.compile(put(tmp_path, GOOD))
    assert compiled.crash == "missing" and compiled.error is not None
    assert compiled.error.endswith("builds no models here, it only loads them: 99.1 or newer does")


def test_a_python_that_cannot_be_started_is_an_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "executable", str(tmp_path / "no_python"))
    compiled = engine.compile(put(tmp_path, GOOD))
    assert compiled.crash == "start"
    assert compiled.error is not None and compiled.error.startswith("cannot start a process for MuJoCo: ")


def test_a_child_that_ends_by_itself_is_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import sys, os\nsys.stderr.write('last words\\n'); sys.stderr.flush(); os._exit(3)"
    (tmp_path / "mujoco.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    compiled = engine.compile(put(tmp_path, GOOD))
    assert compiled.crash == "exit 3"
    assert compiled.error == "MuJoCo's process ended with status 3: last words"


def test_python_variables_of_the_environment_do_not_reach_the_child(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONHOME", str(tmp_path))
    monkeypatch.setenv("MUJOCO_GL", "no such renderer")
    assert engine.compile(put(tmp_path, GOOD)).ok


class TestCall:
    def test_a_function_gets_the_kept_models(self, tmp_path: Path, module: Callable[[str], Any]) -> None:
        made = module(
            "def count(mujoco, a, b, argument):\n    return [a.nbody, b.nbody, argument, mujoco.__name__]\n"
        )
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
            assert engine.compile(put(tmp_path, GOOD), session=session).ok
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
    put(tmp_path / "ü", GOOD)
    with Session() as session:
        answer, _ = session.ask(engine.Request(tmp_path / "\udcc3\udcbc"))
    assert answer["ok"], answer


@posix
def test_each_answer_has_the_index_of_its_own_model(tmp_path: Path) -> None:
    """What crosses from MuJoCo's process only once: the same index again, also after another one and a crash."""

    def bodies(session: Session, text: str) -> tuple[str, ...] | None:
        compiled = engine.compile(put(tmp_path, text), wants=("index",), session=session)
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
        failed = engine.compile(put(tmp_path, named("c")), wants=("index",), mjb=mjb, session=session)
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
    put(tmp_path, GOOD)
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
