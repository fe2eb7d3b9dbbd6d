"""The names and addresses of a model, with units, ranges and keyframes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.bundle.bundle import MODEL
from mjcompose.mujoco import engine
from mjcompose.mujoco.arrays import BY_WORD
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.index import CompiledIndex, addresses
from mjcompose.sides.side import Side
from mjcompose.sources.context import Context


class NamesRecord(Struct):
    """The names of a model. `sha256` is the hash of its MJCF text, and `keys` has the vectors of each keyframe."""

    model: str
    sha256: str
    sizes: Mapping[str, int]
    index: CompiledIndex
    keys: Sequence[Mapping[str, Sequence[float]]]

    def as_data(self) -> dict[str, Any]:
        """Return everything in the order of the model; elements without a name have an empty name."""
        rows = asdict(self.index)
        keys = [{**row, **key} for row, key in zip(rows["keyframes"], self.keys, strict=True)]
        for row in rows["joints"]:
            row["unit"] = BY_WORD[row["type"]].unit  # None for a free joint, which has several
            row["range"] = row["range"] if row.pop("limited") else None
        for row in rows["actuators"]:
            del row["stiffness"], row["joint"]
        kinds = {name: rows[name] for name in ("joints", "actuators", "sensors")}
        return {"model": self.model, "sha256": self.sha256, "sizes": dict(self.sizes), **kinds, "keyframes": keys}


def names_of(side: Side, session: Session, context: Context) -> NamesRecord | None:
    """Return the names of a model that the session keeps, or None if MuJoCo crashes, which is reported."""
    answer = engine.call(session, addresses, [side.kept], argument=None)
    if not answer.ok:
        message = f"the names of `{side.operand.label}` cannot be read: {answer.error or answer.crash}"
        context.sink.error("mujoco-crash", message)
        return None
    model = "" if side.traced is None else str(side.traced.model.root.get("model") or "")
    sha256 = side.digests.get(side.bundle.model if side.bundle is not None else MODEL, "")
    value = answer.value
    return NamesRecord(model, sha256, value["sizes"], index=CompiledIndex.from_data(value["index"]), keys=value["keys"])
