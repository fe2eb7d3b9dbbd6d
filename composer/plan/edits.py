"""Edits in words: the verbs and the selector."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from composer.plan.plan import DropElements, EditElements
from composer.recipe.edit import Edit
from composer.recipe.shown import shown


def in_words(step: EditElements | DropElements) -> str:
    """What a step does, on one line."""
    if isinstance(step, DropElements):
        return f"drop {', '.join(map(str, step.drop))}"
    return words_of(step.edit)


def words_of(edit: Edit) -> str:
    """The same of an entry of `edit`."""
    return f"edit {edit.select}: {'; '.join(_verbs(edit))}"


def _verbs(edit: Edit) -> Iterator[str]:
    if edit.remove is not None:
        yield "remove" if edit.remove is True else "remove, with all that refers to it"
    if isinstance(edit.unset, Mapping):
        yield f"unset {', '.join(f'{tag}.{name}' for tag, names in edit.unset.items() for name in names)}"
    elif edit.unset:
        yield f"unset {', '.join(edit.unset)}"
    for verb in ("set", "scale", "offset"):
        written: Mapping[str, Any] = getattr(edit, verb)
        if written:
            sign = {"set": "=", "scale": "×", "offset": "+"}[verb]
            yield f"{verb} {', '.join(f'{name} {sign} {value}' for name, value in _flat(written))}"
    if edit.convert:
        given = [f"{name} = {shown(value)}" for name, value in edit.convert.items() if name != "to"]
        yield f"convert to {edit.convert['to']}{' with ' if given else ''}{', '.join(given)}"
    if edit.move:
        to = edit.move["to"]
        given = [f"{name} = {shown(value)}" for name, value in edit.move.items() if name != "to"]
        place = f"the frame {to['frame']}" if isinstance(to, dict) else to
        yield f"move to {place}{' with ' if given else ''}{', '.join(given)}"
    if edit.rename:
        yield f"rename to {edit.rename}"


def _flat(written: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    for name, value in written.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{name}.")
        else:
            yield above + name, shown(value)
