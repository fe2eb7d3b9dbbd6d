"""`--cluster local` is for this command alone."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("distributed", reason="needs `mjcompose[cluster]`")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")]
HOLD = """
import sys, time
from mjcompose.tools.cluster.client import client_of
if __name__ == "__main__":
    with client_of("local", 1) as client:
        print(client.scheduler.address, flush=True)
        sys.stdin.read()
"""


def listening(top: int) -> set[str]:
    """Where the processes below one listen, as /proc/net/tcp writes it."""
    processes = {top}
    more = {top}
    while more:
        found = [
            (int(folder.name), int(text.rpartition(")")[2].split()[1]))
            for folder in Path("/proc").iterdir()
            if folder.name.isdecimal() and (text := read(folder / "stat"))
        ]
        more = {process for process, parent in found if parent in processes} - processes
        processes |= more
    sockets = {
        link.readlink().name.removeprefix("socket:[").rstrip("]")
        for process in processes
        for link in Path(f"/proc/{process}/fd").iterdir()
        if link.is_symlink() and "socket:" in str(link.readlink())
    }
    rows = [line.split() for name in ("tcp", "tcp6") for line in read(Path("/proc/net") / name).splitlines()[1:]]
    return {row[1].partition(":")[0] for row in rows if row[3] == "0A" and row[9] in sockets}


def read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:
        return ""


def test_it_listens_on_this_machine_and_to_nobody_without_its_key(tmp_path: Path) -> None:
    import distributed

    (tmp_path / "hold.py").write_text(HOLD)
    command = [sys.executable, str(tmp_path / "hold.py")]
    (tmp_path / "temporary").mkdir()
    environment = {**os.environ, "TMPDIR": str(tmp_path / "temporary")}
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment, cwd=tmp_path
    ) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        assert address.startswith("tls://127.0.0.1:")
        assert listening(process.pid) == {"0100007F"}  # 127.0.0.1
        with pytest.raises((OSError, TypeError)):
            distributed.Client(address, timeout=5)
        with pytest.raises(OSError):
            distributed.Client(address, timeout=5, security=distributed.security.Security.temporary())
        process.kill()
    left = [*(tmp_path / "temporary").iterdir(), *tmp_path.glob("dask*")]
    assert [each.name.rpartition("-")[0] for each in left] == ["mjcompose-dask"]  # which the next run sweeps
