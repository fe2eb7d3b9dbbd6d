"""Worlds from separately built models: of a matrix, of drawn parameters, of any numbers."""

from __future__ import annotations

from os import PathLike

from composer.loading.many import load_many
from composer.worlds.errors import failure
from composer.worlds.joining import Joined, join
from composer.worlds.worlds import Worlds


def gather(path: str | PathLike[str], where: str | None = None) -> Worlds:
    """Load the models that `mjcompose build --all` wrote to a folder as worlds of one model.

        study = worlds.gather("build/study", where="payload > 0")
        study.save("study.npz")     # worlds.load("build/study/first.zip", "study.npz") needs no other model

    `where` is as in `composer.load_many`. The models must have the same elements with the same names; numbers of
    mjModel and options may differ. World `n` is the n-th of these models. Raises LoadError.
    """
    every = list(load_many(path, where))
    if not every:
        raise failure("unknown-name", f"no model in `{path}` is to be gathered", "choose others with `where`")

    found = (
        Joined(
            each.load(),
            each.name,
            {"name": each.values.get("cell", each.name)},
            sample=int(str(each.values.get("sample", 0))),
        )
        for each in every
    )
    return join(found, len(every))
