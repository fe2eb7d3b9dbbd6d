"""The background of a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

SKYLESS = (235, 235, 235, 1)
"""The background of a model without a sky. MuJoCo 4.0 leaves it black, which hides dark models."""


def over(picture: Any, drawn: Any, background: tuple[int, int, int, int] | None) -> Any:
    """Return a picture on black composited over a background; `drawn` is the share of each pixel that is drawn.

    MuJoCo blends edges with black, so only the background has to be added there.
    """
    *colour, opacity = SKYLESS if background is None else background
    if opacity:
        behind = (1 - drawn)[:, :, None] * np.array(colour)
        return np.clip(np.rint(picture + behind), 0, 255).astype(np.uint8)
    share = np.rint(drawn * 255).astype(np.uint8)
    # A PNG has colours that are not multiplied by their opacity.
    own = np.clip(picture / np.maximum(drawn, 1 / 255)[:, :, None], 0, 255)
    return np.dstack([np.rint(own).astype(np.uint8), share])
