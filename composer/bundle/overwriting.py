"""Prevent an output from replacing one of its inputs."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.output_error import OutputError
from composer.bundle.staging import real
from composer.reading.folders import real_path

if TYPE_CHECKING:
    from composer.link.linking import FileUse
    from composer.plan.plan import Plan
    from composer.tree.unit import Unit


def check_is_no_source(out: Path, files: Iterable[Path]) -> None:
    """Refuse an output that is a recipe, a model or an asset of this build, or a folder with one in it.

    Raises OutputError.
    """
    target = real(out)
    at = os.path.normcase(target)
    inside = at.rstrip(os.sep) + os.sep
    for path in files:
        source = os.path.normcase(real_path(path))
        if source == at:
            what = f"`{out}` is one of the files that this model is built from"
        elif source.startswith(inside):
            what = f"the folder `{out}` holds files that this model is built from, such as `{path.name}`"
        else:
            continue
        raise OutputError("output-unwritable", what, "choose another output")


def files_read(plan: Plan, model: Unit, uses: Iterable[FileUse]) -> Iterator[Path]:
    """Yield the recipes, models and assets that a model is made from."""
    yield from (each.path for each in plan.plans())
    yield from (source.path for source in plan.sources())
    yield from (text.path for text in model.origins.texts.values() if text.path is not None)
    yield from (Path(use.source) for use in uses if use.content is None)
