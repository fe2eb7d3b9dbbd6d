"""What is behind the model in a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

SKYLESS = (235, 235, 235, 1)
"""Behind a model without a sky. MuJoCo 4.0 leaves that black, and dark models cannot be seen."""


def over(picture: Any, drawn: Any, background: tuple[int, int, int, int] | None) -> Any:
    """A picture on black, over a background; `drawn` is the share of each pixel that something is drawn in.

    MuJoCo blends edges with the black, so that they only lack what is behind them.
    """
    *colour, opacity = SKYLESS if background is None else background
    if opacity:
        behind = (1 - drawn)[:, :, None] * np.array(colour)
        return np.clip(np.rint(picture + behind), 0, 255).astype(np.uint8)
    share = np.rint(drawn * 255).astype(np.uint8)
    # A PNG has colours that are not multiplied by their opacity.
    own = np.clip(picture / np.maximum(drawn, 1 / 255)[:, :, None], 0, 255)
    return np.dstack([np.rint(own).astype(np.uint8), share])
