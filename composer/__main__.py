"""`python -m composer` is `mjcompose`."""

from __future__ import annotations

import sys

if __name__ == "__main__":
    try:
        from composer.cli.main import main

        main()
    except KeyboardInterrupt:  # before the command itself could take care of it
        sys.exit(130)
