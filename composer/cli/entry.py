"""Where a process that is `mjcompose` begins: what was told before is told again, anything else is run."""

from __future__ import annotations

import errno
import os
import signal
import sys

_FAILED, _INTERRUPTED, _TERMINATED = 1, 130, 143


def main() -> None:
    """The command, with the words of this process."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        if sys.argv[1:2] in (["build"], ["check"]) and _is_told(sys.argv[1:]):
            return
        from composer.cli.main import main as command

        command()
    except KeyboardInterrupt:  # before the command itself could take care of it
        sys.exit(_INTERRUPTED)


def _terminate(signum: int, frame: object) -> None:
    """End in order: what was begun is taken away again."""
    sys.exit(_TERMINATED)


def _is_told(arguments: list[str]) -> bool:
    from composer.cache.again import told_again

    try:
        return told_again(arguments, os.environ)
    except OSError as error:
        if error.errno != errno.EPIPE:  # else the reader of the output has gone
            sys.stderr.write(f"cannot go on: {(error.strerror or str(error)).lower()}\n")
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115  (what it holds is not tried again)
        sys.exit(_FAILED)
