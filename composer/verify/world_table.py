"""`emit: worlds`: compute in MuJoCo's process the numbers that differ between worlds; compare with samples."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np

from composer import engine
from composer.bundle.bundle import MODEL, WORLDS, Bundle
from composer.document.node import locate
from composer.scratch import scratch
from composer.verify import worlds
from composer.verify.compiles import WHOLE
from composer.verify.draw_table import CODE, SAMPLE, DrawTable

_FORMAT = 1

Build = Callable[[int], bool]
"""Builds a sample, which the session keeps as `SAMPLE`; returns whether it succeeded."""


def with_worlds(table: DrawTable, bundle: Bundle, build: Build) -> Bundle:
    """Return the bundle with the worlds of a filled table, one for each sample from 1; errors go to the sink.

    The first, middle and last sample are built, and each array of mjModel is compared.
    """
    with scratch("worlds") as folder:
        paths = {"draws": str(folder / "draws.npy"), "out": str(folder / "worlds.npz")}
        np.save(paths["draws"], np.array(list(table.values.values()), float).T)
        question: dict[str, object] = {**paths, "columns": list(table.columns.values())}
        answer = engine.call(table.session, worlds.compute, [WHOLE], argument=question)
        if not answer.ok:
            table.crashed(answer)
            return bundle
        count = _count(table)
        for sample in sorted({1, (count + 1) // 2, count}):
            if not build(sample):
                return bundle
            question = {**paths, "world": sample - 1}
            answer = engine.call(table.session, worlds.compare, [WHOLE, SAMPLE], argument=question)
            if not answer.ok:
                table.crashed(answer)
                return bundle
            if answer.value:
                _fault(table, sample, answer.value)
                return bundle
        return bundle.with_files({WORLDS: _described(table, Path(paths["out"]).read_bytes())})


def _count(table: DrawTable) -> int:
    wanted = table.plan.randomize
    assert wanted is not None
    return wanted.samples


def _fault(table: DrawTable, sample: int, arrays: list[str]) -> None:
    listed = ", ".join(f"`{name}`" for name in arrays)
    table.context.sink.error(
        CODE,
        f"world {sample - 1} is not what a build makes of sample {sample}: {listed}",
        locate(table.plan.document, ("randomize", "emit")),
        help="leave the fields out that change these, or write `emit: models`, which builds every sample",
    )


def _described(table: DrawTable, content: bytes) -> bytes:
    """Return the file with its description in it."""
    wanted = table.plan.randomize
    assert wanted is not None
    about: dict[str, object] = {
        "worlds": _FORMAT, "model": MODEL, "mujoco": table.session.mujoco_version,
        "seed": wanted.seed, "samples": wanted.samples,
    }  # fmt: skip
    out = BytesIO(content)
    with zipfile.ZipFile(out, "a") as archive:
        archive.writestr(zipfile.ZipInfo("about.json"), json.dumps(about))
    return out.getvalue()
