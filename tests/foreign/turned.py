"""A model twice in one composition, turned and tilted: each copy is the model that it is alone."""

from __future__ import annotations

import os
import tempfile
import warnings
from pathlib import Path

import mujoco
import yaml
from fidelity.building import build
from foreign.strings import Source, Verdict
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.match import Mount
from mjcompose.mujoco.unchanged import compare

# Angles and places of no symmetry, and both with all digits.
PLACES = {"one/": ((3.1, -2.3, 1.7), (0.8, 0.2, -0.5, 0.25)), "two/": ((-4.3, 1.9, 0.6), (0.1, -0.7, 0.3, 0.6))}
_SHOWN = 3


def judge(source: Source) -> Verdict:
    """Compose, compile, and compare each copy by name with the model alone."""
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore")
        path = source.path
        if source.text is not None:
            path = Path(folder, "model.xml")
            path.write_text(source.text, encoding="utf-8")
        try:
            alone = mujoco.MjModel.from_xml_path(str(path))
        except (ValueError, mujoco.FatalError):
            return Verdict(source.id, False)
        built = build(_recipe(path, Path(folder)))
        try:
            composed = built.load()
        except (ValueError, mujoco.FatalError) as error:
            said = built.diagnostics if built.model is None else str(error)
            return Verdict(source.id, True, "refused: " + " ".join(said.split())[:400])
    return Verdict(source.id, True, ", ".join(_differences(alone, composed)))


def _recipe(model: Path, folder: Path) -> Path:
    parts = {
        prefix.rstrip("/"): {"model": os.fspath(model), "pos": list(pos), "quat": list(quat), "keys": "prefix"}
        for prefix, (pos, quat) in PLACES.items()
    }
    path = folder / "recipe.yaml"
    path.write_text(yaml.safe_dump({"recipe": 1, "attach": parts}, sort_keys=False), encoding="utf-8")
    return path


def _differences(alone: mujoco.MjModel, composed: mujoco.MjModel) -> list[str]:
    told: list[str] = []
    for prefix, (pos, quat) in PLACES.items():
        hung_on = Mount.of(composed, pos=pos, quat=quat)
        other = [(each, alone) for each in PLACES if each != prefix]
        found = compare(alone, composed, prefix=prefix, hung_on=hung_on, keys=KeyMode.PREFIX, others=other)
        # Where it knows that MuJoCo itself makes the difference, the comparison says why: docs/contributing/fidelity.md has these.
        told += [str(each) for each in found if not each.why]
    return told[:_SHOWN] + ([f"and {len(told) - _SHOWN} more"] if len(told) > _SHOWN else [])
