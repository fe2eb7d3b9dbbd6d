"""`python -m mjcompose` is `mjcompose`."""

from __future__ import annotations

if __name__ == "__main__":
    from mjcompose.cli.entry import main

    main()
