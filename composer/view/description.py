"""Everything that the page shows of one model: MuJoCo's compiled model, and the origins of its elements."""

from __future__ import annotations

import json
import os
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer import engine
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.unknown import unknown_name
from composer.diff.side import Side
from composer.scene.describe import FILE, describe
from composer.scratch import scratch
from composer.version import __version__
from composer.view.names import Names
from composer.view.origins import Origins

if TYPE_CHECKING:
    from composer.engine import Session


@dataclass(frozen=True, slots=True)
class Description:
    """The description of a model for the page.

    `text` is JSON; `used` are the names of the blobs that it refers to, `blobs` the bytes of the new ones.
    """

    title: str
    text: str
    used: tuple[str, ...]
    blobs: dict[str, bytes]
    keys: tuple[str, ...] = ()

    def has_key(self, key: str | None, sink: Sink) -> bool:
        """Return whether the keyframe exists, or none is requested; report a missing one."""
        if key is None or key in self.keys:
            return True
        sink.add(unknown_name("keyframe", key, filter(None, self.keys), written="--key {}"))
        return False


def described(
    side: Side,
    session: Session,
    known: Collection[str] = (),
    editor: str | None = None,
    names: Names | None = None,
    **more: Any,
) -> Description | None:
    """Return the description of a model that `session` keeps, or None if MuJoCo fails, which is reported.

    Blobs in `known` are not created again. With an `editor` address, in which `{file}`, `{line}` and `{column}`
    stand for a place, it has paths of this machine; without one it has none, and the same model gives the same
    bytes. `names` are the file names shared with another model on the page. `more` is added to the JSON.
    """
    with scratch("scene") as folder:
        answer = engine.call(
            session, describe, [side.kept], argument={"folder": str(folder), "known": sorted(known)}
        )
        if not answer.ok:
            said = answer.error or answer.crash
            message = f"`{side.operand.label}` cannot be shown: {said}"
            side.operand.context.sink.error("mujoco-crash", message)
            return None
        scene = json.loads(Path(folder, FILE).read_text(encoding="utf-8"))
        used = tuple(answer.value["blobs"])
        blobs = {name: path.read_bytes() for name in used if os.path.exists(path := Path(folder, name))}
    origins = Origins(side, names or Names(side.operand.context.folder))
    elements = {
        kind: columns["name"]
        for kind, columns in scene.items()
        if isinstance(columns, dict) and "name" in columns
    }
    bodies, excluded = scene["body"]["name"], scene["exclude"]
    pairs = [
        (bodies[one], bodies[two]) for one, two in zip(excluded["body1"], excluded["body2"], strict=True)
    ]
    scene["origins"] = origins.data(elements, pairs)
    scene["title"] = title = _title(side)
    if editor is not None:
        scene["editor"] = {"template": editor, "files": origins.absolute}
    scene["made"] = f"mjcompose {__version__}"
    scene |= more
    text = json.dumps(scene, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return Description(title, text, used, blobs=blobs, keys=tuple(scene["key"]["name"]))


def _title(side: Side) -> str:
    """Return the model's name: that of the recipe, otherwise that of the file."""
    if side.cell is not None:
        return str(side.cell)
    return str(side.plan.name) if side.plan is not None else Path(side.operand.label).stem
