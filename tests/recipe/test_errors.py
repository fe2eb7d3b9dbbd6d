from __future__ import annotations

from pydantic import ValidationError

from composer.recipe.errors import faults, real_path
from composer.recipe.recipe import Recipe


def test_real_path_keeps_a_missing_last_step() -> None:
    data = {"attach": {"a": {"joint": [{}]}}}
    assert real_path(data, ("attach", "a", "tagged", "joint", 0, "name")) == (
        "attach",
        "a",
        "joint",
        0,
        "name",
    )


def test_related_places_are_moved_with_their_fault() -> None:
    data = {"recipe": 1, "attach": {"a": {"model": "m", "site": "s", "body": "b"}}}
    try:
        Recipe.model_validate(data)
    except ValidationError as error:
        (fault,) = faults(error, data)
    assert fault.at == ("attach", "a", "body")
    assert fault.related[0][1] == ("attach", "a", "site")
