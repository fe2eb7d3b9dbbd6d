from __future__ import annotations

import pytest
from lxml.etree import fromstring

from composer.tree.scaled import first_scaled, scaled_above


@pytest.mark.parametrize(
    ("attributes", "scales"),
    [
        ("", False),
        ('scale="1 1 1" massscale="0"', False),
        ('scale="2"', True),
        ('scale="1 1 3"', True),
        ('massscale="3"', True),
    ],
)
def test_a_frame_scales_all_that_is_in_it(attributes: str, scales: bool) -> None:
    root = fromstring(f"<worldbody><frame {attributes}><body><site/></body></frame><site/></worldbody>")
    inside, outside = root.iter("site")
    assert (first_scaled(root) is not None) == scales
    assert (scaled_above(inside) is not None) == scales
    assert scaled_above(outside) is None
