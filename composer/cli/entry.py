"""Where a process that is `mjcompose` begins."""

from __future__ import annotations

import signal
import sys

_INTERRUPTED, _TERMINATED = 130, 143


def main() -> None:
    """The command, with the words of this process."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        from composer.cli.main import main as command

        command()
    except KeyboardInterrupt:  # before the command itself could take care of it
        sys.exit(_INTERRUPTED)


def _terminate(signum: int, frame: object) -> None:
    """End in order: what was begun is removed again."""
    sys.exit(_TERMINATED)
