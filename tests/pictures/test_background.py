"""What is behind the model."""

from __future__ import annotations

import numpy as np

from composer.pictures.background import SKYLESS, over

DRAWN = np.array([[0.0, 0.5, 1.0]])
PICTURE = np.array([[[0, 0, 0], [50, 0, 0], [100, 0, 0]]], np.uint8)
"""A red thing of which the middle pixel is half full: MuJoCo has blended it with black."""


def test_edges_are_blended_with_the_background() -> None:
    assert over(PICTURE, DRAWN, (200, 200, 200, 1)).tolist() == [[[200] * 3, [150, 100, 100], [100, 0, 0]]]


def test_without_a_sky_it_is_light() -> None:
    assert over(PICTURE, DRAWN, None)[0, 0].tolist() == list(SKYLESS[:3])


def test_a_transparent_one_keeps_the_colour_of_edges() -> None:
    assert over(PICTURE, DRAWN, (0, 0, 0, 0)).tolist() == [[[0, 0, 0, 0], [100, 0, 0, 128], [100, 0, 0, 255]]]
