"""Compile and measure models with MuJoCo, isolated in a child process: the functions for the rest of the project."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer.compiled.index import Index
from composer.engine.answer import Called, Compiled, Measured
from composer.engine.limits import Limits
from composer.engine.request import Request
from composer.engine.session import Session

if TYPE_CHECKING:
    import numpy


def compile(
    folder: Path,
    model: str = "model.xml",
    *,
    wants: tuple[str, ...] = (),
    mjb: Path | None = None,
    text: str | None = None,
    keep: str | None = None,
    stands: bool = False,
    limits: Limits | None = None,
    session: Session | None = None,
) -> Compiled:
    """Compile `folder/model`, run one mj_forward, and write an MJB to `mjb` if that is given.

    Never raises for faults of the model. `limits` apply only without a `session`, which has its own.
    """
    request = Request(folder, model, wants=(*wants, "forward"), mjb=mjb, text=text, keep=keep, stands=stands)
    return _run([request], limits, session)[0].compiled


def measure(
    folder: Path,
    model: str = "model.xml",
    arrays: tuple[str, ...] = (),
    *,
    text: str | None = None,
    limits: Limits | None = None,
    session: Session | None = None,
) -> Measured:
    """Compile `folder/model` and return arrays of mjModel (or `data.NAME` of mjData) with all names.

    Units and shapes are MuJoCo's own: radians, metres, one row per object.
    """
    request = Request(folder, model, wants=("names",), arrays=arrays, text=text)
    return _run([request], limits, session)[0]


def run_many(requests: Iterable[Request], *, limits: Limits | None = None) -> list[Measured]:
    """Answer several requests with one start of MuJoCo; a crash does not affect the others."""
    return _run(requests, limits, None)


def call(session: Session, function: Callable[..., Any], models: Sequence[str], argument: Any) -> Called:
    """Run `function(mujoco, *models, argument)` in the session's child on models kept there by name."""
    answer = session.call(function, models, argument)
    return Called(
        ok=answer["ok"],
        value=answer.get("value"),
        error=answer.get("error"),
        crash=answer.get("crash"),
        warnings=_distinct(answer.get("warnings", ())),
    )


def _run(requests: Iterable[Request], limits: Limits | None, session: Session | None) -> list[Measured]:
    if session is not None:
        return [_ask(session, request) for request in requests]
    with Session(limits) as own:
        return [_ask(own, request) for request in requests]


def _ask(session: Session, request: Request) -> Measured:
    answer, arrays_file = session.ask(request)
    arrays = _load_arrays(arrays_file) if answer.get("arrays") else {}
    return Measured(_compiled(answer, request, session.mujoco_version), arrays)


def _compiled(answer: dict[str, Any], request: Request, version: str | None) -> Compiled:
    def relative(text: str | None) -> str | None:
        return None if text is None else without_folder(text, request.folder)

    names = answer.get("names")
    return Compiled(
        ok=answer["ok"],
        error=relative(answer.get("error")),
        crash=answer.get("crash"),
        warnings=_distinct(without_folder(text, request.folder) for text in answer.get("warnings", ())),
        mujoco_version=version,
        sizes=answer.get("sizes", {}),
        forward=relative(answer.get("forward")),
        index=_index(answer["index"]) if "index" in answer else None,
        names=None if names is None else {kind: tuple(found) for kind, found in names.items()},
    )


@lru_cache(maxsize=4)
def _index(text: str) -> Index:
    """Return the index for its JSON text. Samples of a model have the same, which is read once."""
    return Index.from_data(json.loads(text))


def without_folder(text: str, folder: Path) -> str:
    """Return `text` with paths below `folder` made relative to it, because the folder is not the reader's."""
    for form in (str(folder.absolute()), os.path.realpath(folder)):
        text = text.replace(form.rstrip("/\\") + "/", "").replace(form.rstrip("/\\") + "\\", "")
    return text


def _distinct(warnings: Iterable[str]) -> tuple[str, ...]:
    """Return each warning once, in order; MuJoCo logs the first line of some that it reports in full elsewhere."""
    found = list(dict.fromkeys(text.strip() for text in warnings if text.strip()))
    return tuple(text for text in found if not any(other.startswith(text + "\n") for other in found))


def _load_arrays(path: Path) -> dict[str, numpy.ndarray]:
    import numpy

    with numpy.load(path, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    path.unlink()
    return arrays
