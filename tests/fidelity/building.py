"""The places where the harness calls mjcompose, and a stand-in for it that is MuJoCo's own attach."""

from __future__ import annotations

import atexit
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import mujoco
from fidelity import stored
from fidelity.corpus import Composition, repository
from fidelity.rival import attached
from mjcompose.mujoco.engine import Session


@dataclass(frozen=True)
class Build:
    """A model file, or None with the diagnostics that say why there is none."""

    model: Path | None
    diagnostics: str

    def load(self) -> mujoco.MjModel:
        if self.model is None:
            raise ValueError("nothing was built")
        if self.model.suffix == ".mjb":
            return mujoco.MjModel.from_binary_path(str(self.model))
        return mujoco.MjModel.from_xml_path(str(self.model))


def is_there() -> bool:
    """Whether mjcompose can build at all."""
    try:
        return find_spec("mjcompose.pipeline.stages") is not None and bool(__import__("mjcompose.pipeline.stages"))
    except ImportError:
        return False


@cache
def _session(process: int) -> Session:
    """One process of MuJoCo for everything that this one builds."""
    session = Session()
    atexit.register(session.close)
    return session


def session_of_process() -> Session:
    return _session(os.getpid())


def build(recipe: Path, *, verified: bool = False) -> Build:
    """The recipe built in this process, into a folder that the next build takes; the harness verifies it."""
    from mjcompose.base.report import render
    from mjcompose.pipeline.stages import ModelRequest, build as run
    from mjcompose.sources.context import Context

    context = Context(folder=recipe.parent)
    built = run(ModelRequest(recipe, verified=verified), context, session=_session(os.getpid()))
    told = "\n".join(render(found, _source(recipe.parent), False) for found in context.sink.diagnostics)
    if built is None:
        return Build(None, told)
    return Build(stored.folder("ours", built.bundle.files) / built.bundle.model, told)


def _source(folder: Path) -> Callable[[str], str | None]:
    def read(file: str) -> str | None:
        try:
            return (folder / file).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return None

    return read


def stand_in(composition: Composition, out: Path) -> Build:
    """What MuJoCo's own attach makes of it, saved as MJB: to see the harness at work without mjcompose."""
    try:
        model = attached(composition)
    except ValueError as error:
        return Build(None, f"error: {error}")
    out.mkdir(parents=True, exist_ok=True)
    path = out / "model.mjb"
    mujoco.mj_saveModel(model, str(path), None)
    return Build(path, "")


def reread(path: Path) -> bytes:
    """An MJCF file parsed into mjcompose's tree and written again. Raises ValueError where it is refused."""
    from mjcompose.base.access import own_door
    from mjcompose.base.sink import Sink
    from mjcompose.tree.parse import parse_file
    from mjcompose.tree.xml_text import write

    sink = Sink()
    top = repository(path)
    unit = parse_file(path, sink, door=own_door(path, () if top is None else (top,)))
    if unit is None:
        raise ValueError("; ".join(found.message for found in sink.diagnostics))
    return write(unit.root)
