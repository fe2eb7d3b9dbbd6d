"""The order in which `fmt` writes the keys of a recipe: that of the fields and rows of the language.

`python -m composer.recipe.key_order > composer/formatting/key_order.json` writes it to a file. `fmt` runs at every
save and reads that file, because importing the models takes longer than formatting.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable

from composer.expand.expand import SETTLED
from composer.expand.matrix import KEYS as MATRIX
from composer.expand.params import KEYS as PARAMETER
from composer.recipe.add import ID, TO, Additions
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.default_class import PARENT, Defaults
from composer.recipe.edit import KEYS as EDIT
from composer.recipe.keyframe import KEYS as KEYFRAME
from composer.recipe.keyframe import Keyframes
from composer.recipe.model import Model
from composer.recipe.randomize import Randomize
from composer.recipe.recipe import Recipe, sections_of
from composer.recipe.rows import check_rows
from composer.recipe.typed import TYPE, Typed

_WHEN = "when"
_AFTER = {
    "extends": "description",
    "trust": "extends",
    "params": "conflict",
    "variants": "keyframe",
    "matrix": "variants",
}
"""What is settled before a recipe is validated, each with the key behind which it stands."""
check_rows("the places of keys in composer/recipe/key_order.py", _AFTER, SETTLED)


def key_order() -> dict[str, dict[str, list[str]]]:
    """Return keys by the path of their mapping, in which `*` stands for any name or index.

    In the mappings of `whole`, each key has a place. In those of `first`, only some keys have one, and come first;
    the author orders the others.
    """
    edit = list(EDIT)
    whole = {
        "": _top(),
        "base": _keys(Base),
        "attach.*": [*_keys(Attachment), _WHEN],
        "edit.*": edit,
        "base.edit.*": edit,
        "attach.*.edit.*": edit,
        "params.*": list(PARAMETER),
        **{f"{section}.*": list(KEYFRAME) for section in sections_of(Keyframes)},
        "matrix": list(MATRIX),
        "randomize": _keys(Randomize),
    }
    first = {
        **_each(sections_of(Additions), ID, TO),
        **_each(sections_of(Defaults), PARENT),
        **_each(sections_of(Typed), TYPE),
    }
    return {"whole": whole, "first": first}


def text() -> str:
    """Return the order as the text of its file, with one mapping on each line."""
    tables = [
        f'  "{name}": {{\n'
        + ",\n".join(f"    {json.dumps(path)}: {json.dumps(keys)}" for path, keys in table.items())
        + "\n  }"
        for name, table in key_order().items()
    ]
    return "{\n" + ",\n".join(tables) + "\n}\n"


def _top() -> list[str]:
    keys = _keys(Recipe)
    for key, before in _AFTER.items():
        keys.insert(keys.index(before) + 1, key)
    return keys


def _keys(model: type[Model]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def _each(sections: Iterable[str], *keys: str) -> dict[str, list[str]]:
    return {f"{section}.*": list(keys) for section in sections}


if __name__ == "__main__":
    sys.stdout.write(text())
