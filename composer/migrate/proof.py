"""Whether a migrated model is the model that it was: both are compiled, each by the MuJoCo that it is for."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import field
from pathlib import Path

from composer.dataclass import dataclass
from composer.grammar.format import number_text
from composer.migrate.compare import Outcome, compare
from composer.migrate.environments import Compiled, Other
from composer.migrate.migrate import Migrated


@dataclass(slots=True)
class Proof:
    """`before` and `after` are what each MuJoCo made of the model, None for one that is not there."""

    before: Compiled | None = None
    after: Compiled | None = None
    outcome: Outcome | None = None


@dataclass(slots=True)
class Prover:
    """Compiles in a folder of its own. `others` are the MuJoCos that there are, by version."""

    folder: Path
    others: Mapping[str, Other]
    progress: Callable[[str], None]
    known: dict[str, Compiled] = field(default_factory=dict)

    def original(self, migrated_from: str, model: Path) -> Compiled | None:
        """What the MuJoCo of the model's own version makes of it where it stands. Raises OtherError."""
        other = self.others.get(migrated_from)
        if other is None:
            return None
        if migrated_from not in self.known:
            self.progress(f"compiling {model.name} with MuJoCo {migrated_from}")
            self.known[migrated_from] = other.compile(model, self.folder / "before.npz")
        return self.known[migrated_from]

    def result(self, migrated: Migrated, model: Path) -> Compiled | None:
        """What the other MuJoCo makes of the migrated model. Raises OtherError, and OSError."""
        other = self.others.get(migrated.after)
        if other is None:
            return None
        self.progress(f"compiling the migrated {model.name} with MuJoCo {migrated.after}")
        stage = self.folder / "stage"
        stage.mkdir()
        inside = lay_out(migrated, stage, link=True)
        return other.compile(inside[model], self.folder / "after.npz")

    def prove(self, migrated: Migrated, model: Path) -> Proof:
        """Raises OtherError, and OSError."""
        proof = Proof(self.original(migrated.before, model), self.result(migrated, model))
        one, two = proof.before, proof.after
        if one is not None and two is not None and one.error is None and two.error is None:
            proof.outcome = compare(one, two)
        return proof


def measured(compiled: Compiled | None) -> dict[str, object]:
    """What a change needs to know of the model as it was: the damping of each actuator."""
    if compiled is None or compiled.arrays is None:
        return {}
    import numpy as np

    with np.load(compiled.arrays, allow_pickle=False) as stored:
        damping = stored["actuator_biasprm"][:, 2]
    names = compiled.names.get("actuator", ())
    return {
        "kv": {name: number_text(-float(value)) for name, value in zip(names, damping, strict=False) if name}
    }


def lay_out(migrated: Migrated, folder: Path, *, link: bool = False) -> dict[Path, Path]:
    """Write the migrated files and what they read into a folder, as they stand to one another; where each is.

    With `link` what is not changed is only linked to. Raises OSError.
    """
    import shutil

    every = [*migrated.files, *migrated.assets]
    top = os.path.commonpath([os.path.abspath(each.parent) for each in every])
    placed: dict[Path, Path] = {}
    for path in every:
        to = folder / os.path.relpath(os.path.abspath(path), top)
        if to in placed.values():
            continue
        to.parent.mkdir(parents=True, exist_ok=True)
        placed[path] = to
        if path in migrated.files:
            to.write_bytes(migrated.files[path][1])
        elif not os.path.exists(path):
            continue  # MuJoCo says so
        elif link and os.name == "posix":
            to.symlink_to(os.path.abspath(path))
        else:
            shutil.copyfile(path, to)
    return placed
