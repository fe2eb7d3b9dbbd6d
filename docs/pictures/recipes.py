"""Renders the pictures of recipes/README.md again, two pixels to a point: `python docs/pictures/recipes.py`.

A contact sheet of samples has its options in `OPTIONS`. The colors are reduced to 256, which
leaves a third of the bytes.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SIZE = ["--size", "1280x960"]
OPTIONS = {"randomised": [*("--pick randomised-s000%d " * 4 % (0, 1, 2, 3)).split(), "--size", "640x480"]}


def main(names: list[str]) -> None:
    for recipe in sorted((ROOT / "recipes").glob("*.yaml")):
        picture = ROOT / "docs" / "pictures" / f"{recipe.stem}.png"
        if not picture.is_file() or (names and recipe.stem not in names):
            continue
        words = ["render", str(recipe), "-o", str(picture), *OPTIONS.get(recipe.stem, SIZE)]
        subprocess.run([sys.executable, "-m", "mjcompose", *words], check=True)
        Image.open(picture).convert("RGB").quantize(256, dither=Image.Dither.FLOYDSTEINBERG).save(
            picture, optimize=True
        )


if __name__ == "__main__":
    main(sys.argv[1:])
