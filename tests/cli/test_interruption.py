"""A signal that comes while a module is imported is not lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest
from cli.shell import environment

PROGRAM = """
import os, signal, sys
from abc import ABCMeta
from composer.cli.interruption import end_in_order

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
from composer.cli.interruption import end_in_a_second, end_in_order
from composer.processes.process import Process

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
    with subprocess.Popen(
        words, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
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
