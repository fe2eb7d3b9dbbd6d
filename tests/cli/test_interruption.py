"""A signal that comes while a module is imported is not lost."""

from __future__ import annotations

import signal
import subprocess
import sys

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


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals to send")
@pytest.mark.parametrize(("sent", "ended"), [("SIGTERM", 143), ("SIGINT", -signal.SIGINT)])
def test_a_signal_during_an_import_is_not_lost(sent: str, ended: int) -> None:
    program = [sys.executable, "-c", PROGRAM.format(sent=sent)]
    made = subprocess.run(program, env=environment(), capture_output=True, timeout=15, check=False)
    assert made.returncode == ended, made.stderr.decode()
