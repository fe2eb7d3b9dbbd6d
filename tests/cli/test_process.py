"""A signal that comes while a module is imported is not lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cli.shell import environment

PROGRAM = """
import os, signal, sys
from abc import ABCMeta
from mjcompose.cli.entry import end_in_order

end_in_order()
plain = ABCMeta.register

def register(*arguments):  # which lxml.etree calls while it is imported
    if not sent:
        sent.append(1)
        os.kill(os.getpid(), signal.{sent})
    return plain(*arguments)

sent = []
ABCMeta.register = register
import lxml.etree
import time
assert sent
time.sleep(20)
"""


DEAF = """
import signal, sys, threading, time
from mjcompose.cli.entry import end_in_a_second, end_in_order
from mjcompose.base.processes import Process

end_in_order()
end_in_a_second()
signal.signal(signal.{sent}, lambda number, frame: None)  # as where the handler's exception is lost
child = Process([sys.executable, "-c", "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(60)"])
threading.Thread(target=time.sleep, args=(60,)).start()  # for which Python would wait
print(child.pid, flush=True)
while True:
    try:
        time.sleep(60)
    finally:
        time.sleep(60)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals to send")
@pytest.mark.parametrize(("sent", "ended"), [("SIGTERM", 143), ("SIGINT", 130)])
def test_whatever_a_process_does_it_ends_within_a_second(sent: str, ended: int) -> None:
    words = [sys.executable, "-c", DEAF.format(sent=sent)]
    with subprocess.Popen(words, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None and process.stderr is not None
            child = int(process.stdout.readline())
            begun = time.monotonic()
            process.send_signal(getattr(signal, sent))
            assert process.wait(20) == ended and time.monotonic() - begun < 3  # on a busy machine
            assert b"interrupted" in process.stderr.read()
        finally:
            process.kill()
    for _ in range(200):
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    pytest.fail("its child is left")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals to send")
@pytest.mark.parametrize(("sent", "ended"), [("SIGTERM", 143), ("SIGINT", -signal.SIGINT)])
def test_a_signal_during_an_import_is_not_lost(sent: str, ended: int) -> None:
    program = [sys.executable, "-c", PROGRAM.format(sent=sent)]
    made = subprocess.run(program, env=environment(), capture_output=True, timeout=15, check=False)
    assert made.returncode == ended, made.stderr.decode()


resource = pytest.importorskip("resource")
MODEL = '<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>'


def check(folder: Path, kilobytes: int, *options: str, model: str = MODEL) -> subprocess.CompletedProcess[str]:
    """The command in a process that may have so much memory."""
    (folder / "m.xml").write_text(model)
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    command = f'ulimit -d {kilobytes}; exec "$0" -m mjcompose check r.yaml --no-cache "$@"'
    return subprocess.run(["bash", "-c", command, sys.executable, *options], cwd=folder, capture_output=True, text=True)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts data as Linux does")
@pytest.mark.parametrize("kilobytes", [30_000, 60_000, 100_000, 160_000])
def test_too_little_memory_is_one_clear_line(tmp_path: Path, kilobytes: int) -> None:
    done = check(tmp_path, kilobytes)
    assert done.returncode == 1
    assert done.stderr == (
        f"not enough memory: this process may have {kilobytes >> 10} MiB (`ulimit -d`), and needs at least 160\n"
    )


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts data as Linux does")
def test_the_least_memory_is_enough(tmp_path: Path) -> None:
    done = check(tmp_path, 200_000)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts data as Linux does")
def test_the_limit_binds_the_command_itself(tmp_path: Path) -> None:
    numbers = " ".join(["1.5"] * 3_000_000)
    texts = "".join(f'<numeric name="n{each}" data="{numbers}"/>' for each in range(3))
    model = MODEL.replace("<worldbody>", f"<custom>{texts}</custom><worldbody>", 1)
    assert model != MODEL
    done = check(tmp_path, 8_000_000, "--limit", "memory=170M", model=model)
    assert done.returncode == 1 and done.stderr.startswith("not enough memory"), done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="the shell is bash")
def test_a_limit_below_what_any_build_needs_is_wrong_usage(tmp_path: Path) -> None:
    done = check(tmp_path, 8_000_000, "--limit", "memory=30M")
    assert done.returncode == 2 and "a build needs at least 160M" in done.stderr, done.stderr
