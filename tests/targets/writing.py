"""Builds a model for a target, as the command does."""

from __future__ import annotations

from pathlib import Path

import mujoco
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.staging import write_folder
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


def written(model: str, target: str | None, folder: Path) -> tuple[Bundle | None, Context]:
    """The bundle of a model that is given as text, and what was reported."""
    (folder / "model.xml").write_text(model)
    (folder / "recipe.yaml").write_text("recipe: 1\nallow: [license-missing]\nbase: ./model.xml\n")
    context = Context(folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml", target=target), context)
    return (None if built is None else built.bundle), context


def codes(context: Context) -> list[str]:
    return [each.code for each in context.sink.diagnostics]


def losses(context: Context) -> dict[str, str]:
    """What is told to be lost: sentences, each with its place."""
    found = {}
    for each in context.sink.diagnostics:
        if each.code == "target-loss":
            lines = each.notes[0].message.splitlines() if each.notes else [f"{each.span}: {each.message}"]
            found |= {line.partition(": ")[2]: line.partition(": ")[0] for line in lines}
    return found


def compiled(bundle: Bundle, folder: Path) -> mujoco.MjModel:
    write_folder(bundle, folder)
    return mujoco.MjModel.from_xml_path(str(folder / bundle.model))
