"""The recipe that asks mjcompose for what a composition describes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import yaml
from fidelity.corpus import Attachment, Composition, repository


def write_recipe(composition: Composition, folder: Path) -> Path:
    """A recipe in `folder` that keeps the keys of the parts apart, as MuJoCo's own attach does.

    A prefix is written as its key and the recipe's separator; where that cannot be, as the part's `prefix`.
    """
    separator = _separator(composition)
    recipe: dict[str, Any] = {
        "recipe": 1,
        "separator": separator,
        "conflict": "base",
        "base": {"model": _reference(composition.parent, folder)},
    }
    models = [composition.parent, *(attachment.child for attachment in composition.attachments)]
    if tops := sorted({os.fspath(top) for model in models if (top := repository(model)) is not None}):
        recipe["trust"] = {"files": tops}
    attach = recipe["attach"] = {}
    for number, attachment in enumerate(composition.attachments, 1):
        key, part = _part(attachment, separator, folder)
        attach[key or f"part{number}"] = part
    path = folder / "recipe.yaml"
    path.write_text(yaml.safe_dump(recipe, sort_keys=False, allow_unicode=True), encoding="utf-8")
    return path


def _separator(composition: Composition) -> str:
    ends = {attachment.prefix[-1] for attachment in composition.attachments if attachment.prefix}
    if len(ends) > 1 or not ends <= set("/:.-_"):
        raise ValueError(f"{composition.id}: no one separator for prefixes that end in {sorted(ends)}")
    return ends.pop() if ends else "/"


def _part(attachment: Attachment, separator: str, folder: Path) -> tuple[str, dict[str, Any]]:
    part: dict[str, Any] = {"model": _reference(attachment.child, folder)}
    if attachment.site is not None:
        part["site"] = attachment.site
    elif attachment.body is not None:
        part["body"] = attachment.body
    if any(attachment.pos):
        part["pos"] = [float(x) for x in attachment.pos]
    if attachment.quat != (1.0, 0.0, 0.0, 0.0):
        part["quat"] = [float(x) for x in attachment.quat]
    part["keys"] = "prefix"
    if not attachment.prefix:
        part["prefix"] = ""
    return attachment.prefix.removesuffix(separator), part


def _reference(path: Path, folder: Path) -> str:
    relative = Path(os.path.relpath(path, folder)).as_posix()
    return relative if relative.startswith("../") else f"./{relative}"
