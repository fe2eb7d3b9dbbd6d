"""Convert pydantic's errors to faults."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from composer.diagnostics.fix import Fix
from composer.diagnostics.suggest import advised, closest, exists_note
from composer.expand.expand import SETTLED
from composer.recipe.advice import without_space
from composer.recipe.at_top import advice_at_top, part_keys
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.fault import Fault, Path
from composer.recipe.model import Model
from composer.recipe.recipe import VERSION, Recipe
from composer.recipe.shown import kind_of

_NOTHING = object()


def faults(error: ValidationError, data: Any) -> Iterator[Fault]:
    """Yield the faults of a validation, one for each mistake, with paths from the top of `data`.

    For pydantic, a misspelled key is an unknown key and a missing one. Here it is one fault.
    """
    errors = error.errors(include_url=False)
    extra = [each for each in errors if each["type"] == "extra_forbidden"]
    missing: dict[Path, dict[str, Any]] = {}
    for each in errors:
        if each["type"] == "missing":
            missing.setdefault(each["loc"][:-1], {})[str(each["loc"][-1])] = each
    typos = {id(each): _meant(each["loc"], missing) for each in extra}
    meant = {id(each) for each in typos.values() if each is not None}
    parts = part_keys(data) if isinstance(data, Mapping) else {}
    stray = [*parts]
    for each in errors:
        loc = real_path(data, each["loc"])
        if each["type"] == "fault":
            yield _moved(each["ctx"]["fault"], loc, each["loc"], data=data)
        elif each["type"] == "extra_forbidden":
            if loc[0] not in stray[1:]:  # the keys of a part at the top are one mistake
                yield _extra(loc, typos[id(each)], data, parts=parts)
        elif each["type"] != "missing":
            yield _other(each, loc)
        elif id(each) not in meant:
            yield _missing(loc)


def real_path(data: Any, loc: Path) -> Path:
    """Return the path without steps that are no keys of the data, such as pydantic's names of alternatives.

    The last step stays, because it may be a missing key.

    >>> real_path({"sensor": {"imu": {"site": 1}}}, ("sensor", "imu", "force", "site"))
    ('sensor', 'imu', 'site')
    """
    path: list[str | int] = []
    for index, step in enumerate(loc):
        below = _below(data, step)
        if below is not _NOTHING:
            data = below
        elif index < len(loc) - 1:
            continue
        path.append(step)
    return tuple(path)


def _below(data: Any, step: str | int) -> Any:
    """Return the value at a step, or `_NOTHING`."""
    if isinstance(data, Mapping):
        return data.get(step, _NOTHING)
    if isinstance(data, list) and isinstance(step, int) and step < len(data):
        return data[step]
    return _NOTHING


def _meant(loc: Path, missing: Mapping[Path, Mapping[str, Any]]) -> Any | None:
    """Return the error of the missing key that an unknown key beside it should have been.

    `missing` has the errors by mapping and key.
    """
    beside = missing.get(loc[:-1], {})
    near = closest(str(loc[-1]), list(beside)) if beside else []
    return beside[near[0]] if near else None


def _moved(fault: Fault, loc: Path, raw: Path, data: Any) -> Fault:
    """Return a fault whose paths start at the top, given the path of the value in which it was found."""
    start = raw[: len(raw) - len(fault.at)]
    related = tuple((message, real_path(data, (*start, *at))) for message, at in fault.related)
    return replace(fault, at=loc, related=related)


def _extra(loc: Path, meant: Any | None, data: Any, parts: Mapping[str, Any]) -> Fault:
    name = str(loc[-1])
    model, owner = _owner(loc[:-1])
    known = _keys(model)
    if model is Attachment:  # a note lists the first few: what places a part is most often meant
        known.sort(key=lambda name: name != "model" and name in _keys(Base))
    known += SETTLED if model is Recipe else ()
    help, fix = advised(name, known if meant is None else [str(meant["loc"][-1])])
    if model is Recipe and len(loc) == 1 and (elsewhere := advice_at_top(name, data[name], parts)):
        help, fix = elsewhere, None
    note = exists_note("key", known, name)
    return Fault(
        "unknown-key", f"{owner} has no key `{name}`", loc, key=True, notes=(note,), help=help, fix=fix
    )


def _keys(model: type[Model]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def _missing(loc: Path) -> Fault:
    if loc == ("recipe",):
        message = "the recipe does not say which version of the language it is written in"
        help = f"write `recipe: {VERSION}` as its first line"
        return Fault("missing-key", message, help=help, fix=Fix(f"recipe: {VERSION}\n"))
    name = str(loc[-1])
    _, owner = _owner(loc[:-1])
    example = "./FILE.xml" if name == "model" else "…"
    return Fault(
        "missing-key",
        f"{owner} lacks `{name}`",
        loc[:-1],
        key=True,
        help=f"write `{name}: {example}`",
        lacks=name,
    )


def _other(error: Any, loc: Path) -> Fault:
    """Return the fault for any other error, such as a value that is not a mapping or not an allowed word."""
    _, owner = _owner(loc)
    value = error["input"]
    if loc == ("base",):
        message = f"`base` expects a model reference, or a mapping with `model`, got {kind_of(value)}"
        return Fault("wrong-type", message, loc)
    if loc == ("attach",):
        help = None
        if isinstance(value, list):
            help = "the key is the prefix: write `PREFIX: {model: …}` instead of a list"
        message = f"`attach` expects a mapping from prefix to part, got {kind_of(value)}"
        return Fault("wrong-type", message, loc, help=help)
    if error["type"] in ("model_type", "model_attributes_type", "dict_type", "mapping_type"):
        help = None
        if isinstance(value, str) and (spaced := without_space(value, Attachment.model_fields)):
            help = f"put a space behind the colon: `{spaced}`"
        elif isinstance(value, str) and "\n" not in value:
            help = f"write `{{model: {value}}}`"
        return Fault("wrong-type", f"{owner} expects a mapping, got {kind_of(value)}", loc, help=help)
    return Fault("wrong-type", f"{owner}: {error['msg'][:1].lower()}{error['msg'][1:]}", loc)


def _owner(path: Path) -> tuple[type[Model], str]:
    """Return the model that validates a mapping, and its name in messages."""
    if not path:
        return Recipe, "the recipe"
    if path[0] == "attach" and len(path) == 2:
        return Attachment, f"part `{path[1]}`"
    if path == ("base",):
        return Base, "`base`"
    return Recipe, f"`{path[-1]}`"
