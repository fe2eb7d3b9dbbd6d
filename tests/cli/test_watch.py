from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from cli.shell import RECIPE, WRONG, environment, run
from mjcompose.cli import run as runner
from mjcompose.mujoco.engine import Session
from mjcompose.tools.view.builder import FileWatch, marks

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="interrupts with a POSIX signal")]


class Watching:
    """The command while it watches."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "mjcompose", *arguments, "--watch"],
            cwd=folder,
            env=environment(),
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )

    def until_it_watches(self) -> str:
        """What it says before it waits."""
        assert self.process.stdout is not None
        found = ""
        for line in self.process.stdout:
            if line.startswith("watching "):
                return found
            found += line
        raise AssertionError(f"it ended: {found}")

    def interrupt(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(30)


@pytest.fixture
def watch(folder: Path) -> Iterator[Callable[..., Watching]]:
    started: list[Watching] = []

    def start(*arguments: str) -> Watching:
        started.append(Watching(folder, *arguments))
        return started[-1]

    yield start
    for each in started:
        each.process.kill()
        each.process.communicate()


def test_it_builds_again_what_is_saved(folder: Path, watch: Callable[..., Watching]) -> None:
    command = watch("build", "cell.yaml", "-o", "out.xml")
    assert "wrote out.xml" in command.until_it_watches()
    arm = folder / "models" / "arm.xml"
    arm.write_text(arm.read_text().replace("0.02", "0.03"))
    assert "wrote out.xml" in command.until_it_watches() and "0.03" in (folder / "out.xml").read_text()
    good = (folder / "out.xml").read_bytes()
    (folder / "cell.yaml").write_text(WRONG)
    assert "error[attach-place]" in command.until_it_watches()
    assert (folder / "out.xml").read_bytes() == good
    (folder / "new.yaml").write_text(RECIPE + "option: {timestep: 0.001}\n")
    os.replace(folder / "new.yaml", folder / "cell.yaml")
    assert "wrote out.xml" in command.until_it_watches() and "0.001" in (folder / "out.xml").read_text()
    (folder / "cell.yaml").unlink()
    assert "error[file-not-found]" in command.until_it_watches()
    (folder / "cell.yaml").write_text(RECIPE)
    assert "wrote out.xml" in command.until_it_watches()
    assert command.interrupt() == 0


def test_it_builds_again_when_an_included_file_is_saved(folder: Path, watch: Callable[..., Watching]) -> None:
    floor = folder / "floor.xml"
    floor.write_text('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>')
    (folder / "scene.xml").write_text('<mujoco><include file="floor.xml"/></mujoco>')
    (folder / "scene.yaml").write_text("recipe: 1\nname: scene\nbase: ./scene.xml\n")
    command = watch("build", "scene.yaml", "-o", "out.xml")
    assert "wrote out.xml" in command.until_it_watches()
    floor.write_text(floor.read_text().replace('"1"', '"2"'))
    assert "wrote out.xml" in command.until_it_watches()
    assert 'size="2"' in (folder / "out.xml").read_text()


def test_it_checks_again_from_a_recipe_that_fails_at_first(folder: Path, watch: Callable[..., Watching]) -> None:
    (folder / "bad.yaml").write_text("recipe: 1\nbase: ./models/arm.xml\nattach: [\n")
    command = watch("check", "cell.yaml", "bad.yaml")
    assert "bad.yaml:4" in (said := command.until_it_watches()) and "cell.yaml: ok" in said
    (folder / "bad.yaml").write_text(RECIPE)
    assert "bad.yaml: ok" in command.until_it_watches()
    tool = folder / "models" / "tool.xml"
    tool.write_text(tool.read_text().replace("box", "bocks"))
    assert "models/tool.xml:4" in command.until_it_watches()
    assert command.interrupt() == 0


@pytest.mark.own_children
def test_all_runs_have_one_process_for_mujoco(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[Session] = []
    spawn = Session._spawn
    monkeypatch.setattr(Session, "_spawn", lambda self: (started.append(self), spawn(self)))
    saves = iter((RECIPE + "option: {timestep: 0.001}\n", RECIPE + "option: {timestep: 0.002}\n", WRONG, RECIPE))

    def save(before: object) -> None:
        assert all(each._process is not None for each in started)  # none yet, if a test before has had this answer
        if (text := next(saves, None)) is None:
            raise KeyboardInterrupt
        (folder / "cell.yaml").write_text(text)

    monkeypatch.setattr(runner, "_wait", save)
    result = run("build", str(folder / "cell.yaml"), "--no-cache", "-o", str(folder / "out.xml"), "--watch")
    assert result.stdout.count("wrote") == 4 and "error[attach-place]" in result.stderr
    assert len(started) == 1 and started[0]._process is None
    assert "timestep" not in (folder / "out.xml").read_text()


def test_a_file_that_never_was_ends_it(folder: Path) -> None:
    result = run("build", "nothing.yaml", "--watch")
    assert result.exit_code == 2 and "error[file-not-found]" in result.stderr


def test_an_interrupt_that_comes_with_the_start_of_the_watch_ends_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rescued = threading.Event()
    plain_submit = ThreadPoolExecutor.submit

    def rescue(watch: FileWatch) -> None:
        rescued.set()
        watch.stop.set()

    def submit(executor: ThreadPoolExecutor, wait: Callable[..., object], *arguments: object) -> None:
        plain_submit(executor, wait, *arguments)
        late = threading.Timer(5, rescue, [wait.__self__])  # type: ignore[attr-defined]
        late.daemon = True
        late.start()
        raise KeyboardInterrupt

    monkeypatch.setattr(ThreadPoolExecutor, "submit", submit)
    with pytest.raises(KeyboardInterrupt):
        runner._wait(marks([tmp_path]))
    assert not rescued.is_set()
