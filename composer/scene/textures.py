"""Textures as PNG files, and the textures of materials."""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.pictures.png import png
from composer.scene.blobs import Blobs

FLAT, CUBE, SKY = 0, 1, 2
_KINDS = {FLAT: "2d", CUBE: "cube", SKY: "skybox"}
# mjTEXROLE_RGB and mjTEXROLE_RGBA.
_COLOUR_ROLES = (1, 8)


def textures(model: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each texture; the faces of a cube are below each other: right, left, up, down, front, back."""
    found = []
    for number in range(model.ntex):
        width, height = int(model.tex_width[number]), int(model.tex_height[number])
        channels, first = int(model.tex_nchannel[number]), int(model.tex_adr[number])
        pixels = model.tex_data[first : first + width * height * channels].reshape(height, width, channels)

        def encode(pixels: Any = pixels, channels: int = channels) -> bytes:
            shown = pixels if channels in (3, 4) else np.repeat(pixels[:, :, :1], 3, axis=2)
            return png(shown)

        found.append({
            "blob": blobs.put("texture 1", [pixels], encode), "kind": _KINDS[int(model.tex_type[number])],
            "width": width, "height": height,
        })  # fmt: skip
    return found


def of_materials(model: Any) -> list[int]:
    """Return the texture for the colour of each material, -1 for none."""
    roles: Any = np.asarray(model.mat_texid).reshape(model.nmat, -1) if model.nmat else []
    return [next((int(row[role]) for role in _COLOUR_ROLES if row[role] >= 0), -1) for row in roles]
