"""Compile a unit alone with MuJoCo's engine, to answer what the linker asks about it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from composer import engine
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.linking import Measure
from composer.mujoco_errors.message import CRASHES, crash_help, parse
from composer.mujoco_errors.report import report
from composer.mujoco_errors.translation import translate
from composer.scratch import scratch
from composer.tree.files import file_attributes, is_absolute, written_path
from composer.tree.line import element_at
from composer.tree.mesh_points import check_meshes
from composer.tree.unit import Unit
from composer.tree.write import write

_SIZES = ("nq", "nv", "narena")


def measure_with(
    context: Context, limits: engine.Limits | None = None, session: engine.Session | None = None
) -> Measure:
    """Return a function that compiles a unit alone. If this fails, the error goes to the sink and the result is empty.

    With a `session` its process does that, under its own limits.
    """

    def measure(unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]:
        if not check_meshes(unit, 0, Sink() if attempt else context.sink):
            return {}
        wanted = tuple(name for name in arrays if name not in _SIZES)
        text = write(unit.root)
        with folder_of(unit) as folder:
            measured = engine.measure(
                folder, arrays=wanted, text=text.decode(), limits=limits, session=session
            )
        compiled = measured.compiled
        if not compiled.ok:
            if not attempt:
                _rejected(compiled, unit, text, context)
            return {}
        found = {name: [float(value) for value in array.ravel()] for name, array in measured.arrays.items()}
        return {**found, **{name: [float(compiled.sizes[name])] for name in _SIZES}}

    return measure


@contextmanager
def folder_of(unit: Unit) -> Iterator[Path]:
    """Yield the folder with the unit's files: its own, or a temporary one with the files that are in memory."""
    if not unit.contents:
        yield unit.directory
        return
    contents = {path: content for path, content in _contents(unit) if not is_absolute(path)}
    outward = max((path.count("../") for path in contents), default=0)
    with scratch("unit") as name:
        folder = Path(name, *["model"] * outward)  # deep enough for every `..`
        folder.mkdir(parents=True, exist_ok=True)
        for path, content in contents.items():
            file = Path(os.path.normpath(folder / path))
            file.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(content, bytes):
                file.write_bytes(content)
            elif os.path.isfile(content):
                shutil.copyfile(content, file)
        yield folder


def _contents(unit: Unit) -> Iterator[tuple[str, bytes | Path]]:
    """Yield the files in memory, and the files next to the unit that it also refers to."""
    yield from unit.contents.items()
    for element, _, name in file_attributes(unit.root):
        path = written_path(unit.settings, element, name)
        if path not in unit.contents and unit.door.sees(unit.directory / path):
            yield path, unit.directory / path


def _rejected(compiled: engine.Compiled, unit: Unit, text: bytes, context: Context) -> None:
    whole = unit.origins.span(unit.root, unit.file)
    if compiled.crash is not None:
        code = CRASHES.get(compiled.crash, "mujoco-crash")
        message = f"`{unit.file}` by itself: {compiled.error or compiled.crash}"
        context.sink.error(code, message, whole, help=crash_help(code))
        return
    fault = parse(compiled.error or "")
    element = None if fault.line is None else element_at(unit.root, text, fault.line)
    report(translate(" ".join(fault.message.split()), element), element, unit, context, at=whole)
