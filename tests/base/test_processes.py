"""Nothing outlives the process that started it, however that ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mjcompose.base import limits
from mjcompose.base.processes import Process

posix = pytest.mark.skipif(os.name != "posix", reason="processes are looked at by their numbers and signals")
BUSY = '<mujoco><worldbody><replicate count="2000000000"><geom size=".1"/></replicate></worldbody></mujoco>'
COMPILES = """
import sys
from pathlib import Path
from mjcompose.mujoco import engine

session = engine.Session()
session._start()
print(session._process.pid, flush=True)
engine.compile(Path(sys.argv[1]), session=session)
"""
SLEEPS = """
import time
from mjcompose.base import limits
from mjcompose.base.processes import Process

process = Process(["sh", "-c", "sleep 300 & echo $!; exec sleep 300"], stdout=-1)
print(process.pid, int(process.stdout.readline()), flush=True)
time.sleep(300)
"""
FORKS = SLEEPS.replace("time.sleep(300)", "os.fork()\ntime.sleep(300)").replace("import time", "import os\nimport time")


def is_alive(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        if Path("/proc/self/stat").exists():
            return False
        return subprocess.run(["ps", "-p", str(process)], capture_output=True, check=False).returncode == 0
    return state != "Z"


def end_of(processes: list[int]) -> float:
    """How many seconds it takes until none of them is alive; 15 where one stays."""
    begun = time.monotonic()
    while any(map(is_alive, processes)) and time.monotonic() - begun < 15:
        time.sleep(0.01)
    return time.monotonic() - begun


@posix
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV])
def test_mujoco_ends_with_its_parent_while_it_is_busy(tmp_path: Path, number: int) -> None:
    (tmp_path / "model.xml").write_text(BUSY)
    with subprocess.Popen([sys.executable, "-c", COMPILES, str(tmp_path)], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        time.sleep(0.5)  # MuJoCo reads the model, and holds Python's lock
        assert is_alive(child)
        parent.send_signal(number)
        parent.wait()
        assert end_of([child]) < 10


@posix
@pytest.mark.parametrize("program", [SLEEPS, FORKS], ids=["alone", "forked"])
def test_a_program_and_what_it_started_end_with_their_parent(program: str) -> None:
    if program is FORKS and not hasattr(os, "pidfd_open"):
        pytest.skip("here a fork of the parent keeps the pipe open")
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, start_new_session=True) as parent:
        assert parent.stdout is not None
        processes = list(map(int, parent.stdout.readline().split()))
        time.sleep(0.2)
        assert all(map(is_alive, processes))
        os.kill(parent.pid, signal.SIGKILL)
        assert end_of(processes) < 10
        os.killpg(parent.pid, signal.SIGKILL)  # the fork


@posix
def test_end_takes_what_the_program_started(tmp_path: Path) -> None:
    process = Process(["sh", "-c", "sleep 300 & echo $!; exec sleep 300"], stdout=subprocess.PIPE)
    assert process.stdout is not None
    started = int(process.stdout.readline())
    process.end()
    assert end_of([started, process.pid]) < 10
    process.stdout.close()


@posix
def test_a_program_that_ends_leaves_nobody_watching() -> None:
    with Process([sys.executable, "-c", "import os; print(os.getpgid(0))"], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stdout.read().strip() == str(process.pid).encode()
    begun = time.monotonic()
    while time.monotonic() - begun < 20:
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.02)
    pytest.fail("somebody of its group is left")


@posix
def test_a_program_that_does_not_exist_is_told_by_its_status() -> None:
    with Process(["/no/such/program"], stderr=subprocess.DEVNULL) as process:
        assert process.wait() != 0


@posix
def test_limits_of_data_and_of_files(tmp_path: Path) -> None:
    greedy = [sys.executable, "-c", "bytearray(1 << 30)"]
    with Process(greedy, memory=1 << 28, stderr=subprocess.PIPE) as process:
        assert process.stderr is not None and b"MemoryError" in process.stderr.read()
    with limits.allow(memory=1 << 28), Process(greedy, stderr=subprocess.PIPE) as process:
        assert process.stderr is not None and b"MemoryError" in process.stderr.read()
    large = [sys.executable, "-c", f"open({str(tmp_path / 'f')!r}, 'wb').write(bytes(1 << 20))"]
    with Process(large, size=1 << 16, stderr=subprocess.DEVNULL) as process:
        assert process.wait() != 0
    assert (tmp_path / "f").stat().st_size <= 1 << 16


@posix
def test_the_guard_imports_nothing_from_the_users_module_path(tmp_path: Path) -> None:
    for name in ("contextlib", "select", "signal"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    with Process(["true"], env={**os.environ, "PYTHONPATH": str(tmp_path)}) as process:
        assert process.wait() == 0
    assert not (tmp_path / "ran").exists()
