"""`python -m composer` is `mjcompose`."""

from __future__ import annotations

if __name__ == "__main__":
    from composer.cli.entry import main

    main()
