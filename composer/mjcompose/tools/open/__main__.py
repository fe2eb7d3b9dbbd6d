"""Prints the MJCF of a recipe for MuJoCo's decoder in C: `python -m mjcompose.tools.open RECIPE`.

Standard output has the model, or the reason why there is none; the exit code says which.
"""

from __future__ import annotations

import sys

from mjcompose.base.report import MjcomposeError
from mjcompose.tools.open.recipe import text_of


def main(recipe: str) -> int:
    try:
        text, code = text_of(recipe), 0
    except MjcomposeError as error:
        text, code = str(error), 1
    sys.stdout.buffer.write(text.encode(errors="replace"))
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
