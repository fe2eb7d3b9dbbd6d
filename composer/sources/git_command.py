"""The command `git`: run without a terminal, with a time limit, and tried again where the network failed."""

from __future__ import annotations

import math
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from composer.sources.error import SourceError
from composer.sources.timeout import patience

_TRIES = 3
_PAUSE = 0.5
_PASSING = re.compile(
    r"temporary failure|timed out|timeout|connection (refused|reset|closed)|early eof"
    r"|rpc failed|unexpected disconnect|hung up unexpectedly|couldn't connect|failed to connect|error: 5\d\d"
    r"|operation too slow",
    re.IGNORECASE,
)
"""What another try may get past."""
_NO_NAME = re.compile("could not resolve host", re.IGNORECASE)
"""There is no network, or no such name: another try a second later finds the same."""
_ADVICE = re.compile(
    r"(hint|warning): |Please make sure you have the correct access|and the repository exists", re.I
)


class GitFailure(Exception):
    """The command failed; `said` is what it wrote to standard error."""

    def __init__(self, said: str) -> None:
        super().__init__(said)
        self.said = said


@dataclass(frozen=True, slots=True)
class Git:
    """Runs git in one repository (or in none); `limit` is the seconds that one command may take."""

    environment: Mapping[str, str]
    progress: Callable[[str], None]
    limit: float = 1800.0

    def run(
        self, *arguments: str, folder: Path | None = None, tries: int = 1, stdin: bytes | None = None
    ) -> bytes:
        """Standard output. Raises GitFailure, and SourceError where there is no git."""
        for attempt in range(tries):
            try:
                return self._once(arguments, folder, stdin)
            except GitFailure as failure:
                passing = _PASSING.search(failure.said) and not _NO_NAME.search(failure.said)
                if attempt + 1 == tries or not passing:
                    raise
                self.progress(f"{_last_line(failure.said)}; trying again")
                time.sleep(_PAUSE * 2**attempt)
        raise AssertionError("there is at least one try")

    def fetch(self, *arguments: str, folder: Path | None = None) -> bytes:
        """The same for what asks another machine: tried again where the network failed."""
        return self.run(*arguments, folder=folder, tries=_TRIES)

    def _once(self, arguments: tuple[str, ...], folder: Path | None, stdin: bytes | None) -> bytes:
        silence = str(math.ceil(patience(self.environment)))  # git takes whole seconds
        settings = {
            "core.hooksPath": os.devnull,  # nothing of a repository is ever run
            "protocol.ext.allow": "never",
            "http.lowSpeedLimit": "1",
            "http.lowSpeedTime": silence,
            "gc.auto": "0",
            "fetch.fsckObjects": "false",
        }
        command = ["git", *(word for name, value in settings.items() for word in ("-c", f"{name}={value}"))]
        if folder is not None:
            command.append(f"--git-dir={folder}")
        # A repository that the user stands in is none of ours, nor what a hook says of it.
        own = {name: value for name, value in self.environment.items() if name not in _OF_A_REPOSITORY}
        own = {**os.environ, "GIT_ASKPASS": "", **own, "GIT_TERMINAL_PROMPT": "0", "LC_ALL": "C"}
        for name in _OF_A_REPOSITORY:
            own.pop(name, None)
        if any(each.startswith("ssh://") for each in arguments):
            own |= _impatient_ssh(own, silence)
        try:
            with subprocess.Popen(
                [*command, *arguments],
                stdin=subprocess.DEVNULL if stdin is None else subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=own,
                start_new_session=True,
            ) as process:
                try:
                    out, err = process.communicate(stdin, timeout=self.limit)
                except subprocess.TimeoutExpired:
                    _kill(process)
                    raise GitFailure(f"git took longer than {self.limit:g} seconds") from None
                except BaseException:
                    _kill(process)
                    raise
        except FileNotFoundError:
            raise SourceError(
                "source-fetch", "models in git repositories need the command `git`, which is not installed",
                help="install git",
            ) from None  # fmt: skip
        if process.returncode:
            raise GitFailure(err.decode("utf-8", "replace").strip())
        return out


_OF_A_REPOSITORY = (
    "GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_OBJECT_DIRECTORY", "GIT_ALTERNATE_OBJECT_DIRECTORIES",
    "GIT_COMMON_DIR", "GIT_NAMESPACE", "GIT_PREFIX",
)  # fmt: skip


def _impatient_ssh(own: Mapping[str, str], seconds: str) -> dict[str, str]:
    """What has ssh give up on a machine that says nothing for so long; another program than ssh is left as it is."""
    written = own.get("GIT_SSH_COMMAND", "")
    if not written:
        try:
            done = subprocess.run(
                ["git", "config", "--get", "core.sshCommand"], env=dict(own), stdin=subprocess.DEVNULL,
                capture_output=True, check=False, timeout=30,
            )  # fmt: skip
        except (OSError, subprocess.TimeoutExpired):
            return {}  # git itself is asked next, and its failure is told
        written = done.stdout.decode("utf-8", "surrogateescape").strip()
    if not written and own.get("GIT_SSH"):
        return {}
    command = written or "ssh"
    if not _OPENSSH.match(command):
        return {}
    limits = {"ConnectTimeout": seconds, "ServerAliveInterval": seconds, "ServerAliveCountMax": "1"}
    return {"GIT_SSH_COMMAND": " ".join([command, *(f"-o {name}={value}" for name, value in limits.items())])}


_OPENSSH = re.compile(r"(\S*/)?ssh(\s|$)")
"""The first option that ssh is given counts: what the user's command says itself stays in force."""


def _kill(process: subprocess.Popen[bytes]) -> None:
    """With the helpers that git started."""
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()


def _last_line(said: str) -> str:
    return said.strip().splitlines()[-1] if said.strip() else "git failed"


def words_of(failure: GitFailure) -> tuple[str, ...]:
    """What git said, as notes: its errors, without the advice."""
    lines = [line.strip() for line in failure.said.splitlines() if line.strip()]
    told = [line for line in lines if not _ADVICE.match(line)] or lines
    return tuple(f"git said: {line}" for line in told[:3])
