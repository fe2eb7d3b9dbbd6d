"""The order of keys that `fmt` writes is that of the models: a key in only one of the two fails at import.

`fmt` has its own list because it is run at every save, and importing the models takes longer than formatting.
"""

from __future__ import annotations

from collections.abc import Iterable

from composer.expand.expand import SETTLED
from composer.formatting.order import WHOLE, Path
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.edit import KEYS as EDIT
from composer.recipe.keyframe import KEYS as KEYFRAME
from composer.recipe.model import Model
from composer.recipe.randomize import Randomize
from composer.recipe.recipe import Recipe
from composer.recipe.rows import check_rows

_WHEN = "when"


def _keys(model: type[Model]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def _check(path: Path, keys: Iterable[str], others: Iterable[str] = ()) -> None:
    """Compare the order at a path; `others` are keys that may stand anywhere among these."""
    table, keys, others = f"the order of the keys of {'.'.join(path) or 'a recipe'}", list(keys), set(others)
    order = [key for key in WHOLE[path] if key not in others]
    check_rows(f"{table} in composer/formatting/order.py", order, keys)
    if order != keys:
        raise TypeError(f"{table} is {' '.join(keys)}, and in composer/formatting/order.py {' '.join(order)}")


_check((), _keys(Recipe), SETTLED)
_check(("attach", "*"), _keys(Attachment), [_WHEN])
_check(("base",), _keys(Base), {*_keys(Attachment), _WHEN}.difference(_keys(Base)))
_check(("edit", "*"), EDIT)
_check(("keyframe", "*"), KEYFRAME)
_check(("randomize",), _keys(Randomize))
