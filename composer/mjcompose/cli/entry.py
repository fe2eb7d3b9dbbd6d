"""The entry point of the `mjcompose` process."""

from __future__ import annotations

import sys

from mjcompose.base.runtime import rarely_collecting
from mjcompose.cli.process import INTERRUPTED, end_in_a_second, end_in_order

NO_MEMORY = "not enough memory; `--limit memory=16G` allows more than 8 GiB, where the machine has it"


def main() -> None:
    """Run the command with the arguments of this process."""
    end_in_order()
    end_in_a_second()
    rarely_collecting()
    try:
        from mjcompose.base.limits import in_force
        from mjcompose.cli.process import bound, too_little

        if (said := too_little()) is not None:
            sys.exit(said)
        bound(in_force().memory)
        from mjcompose.cli.main import main as command

        command()
    except MemoryError:
        sys.exit(NO_MEMORY)
    except KeyboardInterrupt:  # before the command itself could handle it
        sys.exit(INTERRUPTED)
