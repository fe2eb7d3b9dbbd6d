from __future__ import annotations

import pytest
from pydantic import ValidationError

from composer.expr.angle import Angle
from composer.limits import Limits
from composer.recipe.attach import Attachment
from composer.recipe.replicate import Axis

MAX_COPIES = Limits().copies


def test_read() -> None:
    attachment = Attachment.model_validate(
        {
            "model": "m",
            "replicate": [{"count": 2, "offset": [1, 0, 0]}, {"count": 3, "euler": [0, "9deg", 0]}],
        }
    )
    assert attachment.replicate == (Axis(2, (1, 0, 0)), Axis(3, (0, 0, 0), (0, Angle(9.0, "deg"), 0)))


@pytest.mark.parametrize(("count", "allowed"), [(MAX_COPIES, True), (MAX_COPIES + 1, False)])
def test_not_without_end(count: int, allowed: bool) -> None:
    data = {"model": "m", "replicate": [{"count": count}]}
    if allowed:
        assert Attachment.model_validate(data).replicate[0].count == count
    else:
        with pytest.raises(ValidationError):
            Attachment.model_validate(data)
