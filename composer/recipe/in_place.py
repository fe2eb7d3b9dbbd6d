"""A recipe that is written in place, as a mapping instead of a model reference."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from composer.dataclass import dataclass
from composer.document.node import Key, Scalar, find
from composer.document.node import Mapping as Located
from composer.document.node import Sequence as List
from composer.formatting.order import WHOLE
from composer.recipe.fault import Fault, Path
from composer.recipe.form import Form
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.settings import Settings
from composer.recipe.text import Text

_TEXT = Text("model")
INHERITED = ("recipe", "angle", "eulerseq", "separator", "conflict")
"""What a model in place has of the recipe that it is written in, where it does not say otherwise."""
Judge = Callable[[Located], list[Fault]]
OF_A_FILE = {
    "extends": "write it into a file of its own: `model: ./NAME.yaml`",
    "params": "declare them in `params` of the recipe: `${…}` has the same values here",
    "variants": "write them in `variants` of the recipe: a piece may change what is written here",
    "matrix": "write it in the recipe itself",
    "randomize": "write it in the recipe itself, whose fields reach what is written here",
}


@dataclass(frozen=True, slots=True)
class ModelField(Form):
    """Form of the field `model`: a model reference, or a recipe as a mapping, which the planner reads."""

    def schema(self) -> Schema:
        return {"anyOf": [_TEXT.schema(), reference("in-place")]}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> str | Mapping[str, Any] | None:
        if isinstance(value, dict):
            return value
        if isinstance(value, list):
            message = "`model` is a model reference, or a recipe as a mapping, got a list"
            one_of = bool(value) and all(isinstance(each, str) for each in value)
            help = advice_to_choose(value) if one_of else "write `model: {add: […]}`"
            faults.append(Fault("wrong-type", message, help=help))
            return None
        return _TEXT.read(value, faults, settings)


def advice_to_choose(models: Sequence[str]) -> str:
    """Return what to write to choose one of several models in each sample."""
    drawn = f"{{which: {{param: which, choice: [{', '.join(models)}]}}}}"
    return (
        f'one in each sample: `params: {{which: {models[0]}}}`, `model: "${{which}}"`, and `randomize` with'
        f" `fields: {drawn}`"
    )


def fault_of_inline_recipe(value: Mapping[str, Any], owner: str, own: Iterable[str]) -> Fault | None:
    """Return the fault of a base or part that is a recipe without `model` above it. `own` are its allowed keys."""
    strange = [key for key in value if key in WHOLE[()] and key not in own]
    if "model" in value or not strange:
        return None
    keys = ", ".join(f"`{key}`" for key in strange)
    message = f"{keys} of {owner} {'stands' if len(strange) == 1 else 'stand'} where a `model` is expected"
    help = f"a model that is written in place stands below `model`: `model: {{{strange[0]}: …}}`"
    return Fault("missing-key", message, (strange[0],), key=True, help=help)


@definition("in")
def _definition(_: str) -> Schema:
    return {"$ref": "#/$defs/InPlace"}


def with_inherited(model: Located, around: Located) -> Located:
    """Return the recipe that is written in place, with what it inherits from the one around it."""
    inherited = {name: entry for name, entry in around.entries.items() if name in INHERITED}
    known = {name: entry for name, entry in model.entries.items() if name not in OF_A_FILE}
    version = Key("recipe", model.span), Scalar(1, model.span, "1", plain=True)
    return Located({"recipe": version, **inherited, **known}, model.span)


def faults_in_place(node: Located, judge: Judge) -> Iterator[Fault]:
    """Yield the faults of the recipes that are written in place. `judge` finds those of one recipe."""
    for at, model in _models(node):
        if (choice := _choice(model)) is not None:
            message = "`model` is a model reference or a recipe, and a choice among models is drawn"
            yield Fault("unknown-key", message, (*at, "choice"), key=True, help=advice_to_choose(choice))
            continue
        yield from (
            Fault(
                "unknown-key",
                f"a model that is written in place has no `{name}`",
                (*at, name),
                key=True,
                help=help,
            )
            for name, help in OF_A_FILE.items()
            if name in model.entries
        )
        for fault in judge(with_inherited(model, node)):
            if not fault.at or fault.at[0] in model.entries:
                related = tuple((message, (*at, *path)) for message, path in fault.related)
                yield replace(fault, at=(*at, *fault.at), related=related)


def _choice(model: Located) -> list[str] | None:
    """Return the models of a random choice, or None if `model` is not one."""
    choice = find(model, ("choice",))
    if len(model.entries) > 1 or not isinstance(choice, List) or not choice.items:
        return None
    return [each.text for each in choice.items if isinstance(each, Scalar)] or None


def _models(node: Located) -> Iterator[tuple[Path, Located]]:
    """Yield the models that are written in place, each with its path."""
    parts = find(node, ("attach",))
    names = list(parts.entries) if isinstance(parts, Located) else []
    for at in (("base", "model"), *(("attach", name, "model") for name in names)):
        model = find(node, at)
        if isinstance(model, Located):
            yield at, model
