"""A recipe as a model in this process: built without files, except generated assets in the cache.

`python -P -m mjcompose.tools.open.recipe RECIPE FOLDER` prints the MJCF for MuJoCo's decoder in C, or the reason that
there is none, on one line; the exit code says which. `FOLDER` is the current folder of the program.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Mapping
from itertools import chain
from os import PathLike
from pathlib import Path
from threading import RLock
from typing import Any, NamedTuple, TypeAlias, TypeVar

from mjcompose.base.diagnostic import Severity, warn
from mjcompose.base.files import Mark, mark_of, read_regular
from mjcompose.base.guard import limit
from mjcompose.base.limits import in_force
from mjcompose.base.report import MjcomposeError, counted, render, short_traceback
from mjcompose.base.runtime import forget_current_folder
from mjcompose.base.suggest import exists_note
from mjcompose.build.cache.inputs import Inputs
from mjcompose.build.plan.read import Given
from mjcompose.build.stages import Built, Request, build
from mjcompose.link.linking import FileUse
from mjcompose.mujoco.engine import Session
from mjcompose.sources import blobs
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import KINDS
from mjcompose.sources.store import Store
from mjcompose.text.load import load
from mjcompose.tree.files import NAMED_AFTER_FILE, stem
from mjcompose.tree.xml_text import write

T = TypeVar("T")
Spec: TypeAlias = Any
"""A `mujoco.MjSpec`, which has no type stubs."""
Model: TypeAlias = Any
"""A `mujoco.MjModel`, which has no type stubs."""


class BuildError(MjcomposeError):
    """A recipe that cannot be built; `diagnostics` has all errors and warnings of the build."""


class RecipeWarning(UserWarning):
    """A warning of a build, with its place in the recipe."""


@short_traceback
def spec(
    recipe: str | PathLike[str], /, *, cell: str | None = None, sample: int = 0, verified: bool = False, **values: Any
) -> Spec:
    """Build a recipe in this process and return it as a `mujoco.MjSpec`, which you can edit, attach and compile.

        spec = mjcompose.spec("cell.yaml", tool="flange", reach=0.5)
        spec.worldbody.add_light(pos=[0, 0, 3])
        model = spec.compile()

    `values` are the values of the recipe's parameters and variants, `cell` is the name of a cell of its matrix, and
    `sample` is the number of a sample of `randomize`. With `verified`, MuJoCo compiles the model in a process of its
    own first, and the recipe's checks run. A recipe whose files have not changed is not built again.

    Raises BuildError, and warns with RecipeWarning.
    """
    import mujoco

    return _opened_by(mujoco.MjSpec.from_string, recipe, cell, sample=sample, verified=verified, values=values)


@short_traceback
def model(
    recipe: str | PathLike[str], /, *, cell: str | None = None, sample: int = 0, verified: bool = False, **values: Any
) -> Model:
    """Build a recipe in this process and return it as a compiled `mujoco.MjModel`.

        model = mjcompose.model("cell.yaml", tool="flange")
        data = mujoco.MjData(model)

    Takes the same values as `mjcompose.spec`. Raises BuildError, and warns with RecipeWarning.
    """
    import mujoco

    return _opened_by(mujoco.MjModel.from_xml_string, recipe, cell, sample=sample, verified=verified, values=values)


def _opened_by(
    load: Callable[[str], T], recipe: str | PathLike[str], cell: str | None, *, sample: int, verified: bool,
    values: Mapping[str, Any],
) -> T:  # fmt: skip
    """Return the result of MuJoCo's function. If MuJoCo refuses the text, raise BuildError with the place in a file."""
    text = text_of(recipe, cell=cell, sample=sample, verified=verified, values=values)
    try:
        return load(text)
    except ValueError as error:
        refused = error
    text_of(recipe, cell=cell, sample=sample, verified=True, values=values)  # its error has the line of the source
    raise refused


class _Opened(NamedTuple):
    """The text of a built recipe, and the marks of the files that it depends on."""

    text: str
    marks: Mapping[str, Mark]
    warnings: tuple[str, ...]

    @property
    def is_current(self) -> bool:
        return all(mark_of(path) == mark for path, mark in self.marks.items())


_MOST = 64
"""The number of recipes whose text is remembered."""
_opened: dict[str, _Opened] = {}
_building = RLock()


def text_of(
    recipe: str | PathLike[str], *, cell: str | None = None, sample: int = 0, verified: bool = False,
    values: Mapping[str, Any] | None = None,
) -> str:  # fmt: skip
    """Return the MJCF of a recipe, which names all files by absolute paths. Raises BuildError.

    The text of an unchanged recipe is remembered. Threads may call it at the same time.
    """
    path = os.path.abspath(recipe)
    written = as_json(values or {})
    places = [os.environ.get(name) for kind in KINDS for name in kind.variables]
    key = json.dumps([path, written, cell, sample, verified, places])
    opened = _opened.get(key)
    if opened is None or not opened.is_current:
        with _building:
            opened = _opened.get(key)
            if opened is None or not opened.is_current:
                opened = _open(Path(path), written, cell, sample=sample, verified=verified)
                _opened.pop(key, None)
                _opened[key] = opened
                while len(_opened) > _MOST:
                    del _opened[next(iter(_opened))]
    for message in opened.warnings:
        warn(message, RecipeWarning)
    return opened.text


def files_of(recipe: str | PathLike[str]) -> tuple[str, ...]:
    """Return the files that a recipe depends on, to watch them: all inputs of its models in this process.

    It has no files before `mjcompose.spec`, `mjcompose.model` or MuJoCo has built it.
    """
    path = os.path.abspath(recipe)
    known = (opened.marks for key, opened in list(_opened.items()) if json.loads(key)[0] == path)
    return tuple(dict.fromkeys(chain.from_iterable(known)))


def _open(recipe: Path, written: Mapping[str, str], cell: str | None, *, sample: int, verified: bool) -> _Opened:
    started = time.time_ns()
    context = Context(fetching=Fetching())
    given = nodes_of(written, context)
    request = request_for(recipe, given, cell, sample=sample, verified=verified, context=context)
    with Session() as session:
        built = None if request is None else build(request, context, session=session)
    if built is None:
        raise BuildError(context.sink.diagnostics)
    inputs = Inputs()
    files = [*inputs.recipes(built.plan), *inputs.others(built, context)]
    marks = {path: mark_of(path) for path in files if not os.path.isdir(path)}
    text, generated = _text(built, context)
    marks |= {path: mark_of(path) for path in generated}
    # A file that changed during the build may have been read before: the model is built again at the next call.
    marks |= {path: None for path in files if (mark := marks.get(path)) is not None and mark[0] >= started}
    return _Opened(text, marks, tuple(map(render, context.sink.diagnostics)))


def request_for(
    recipe: Path, given: Given, cell: str | None, *, sample: int, verified: bool, context: Context
) -> Request | None:
    """Return the request for a model, a cell or a sample of a recipe, or None if there is none, which is reported."""
    sink = context.sink
    if cell is None and sample == 0:
        return None if sink.errors else Request(recipe, given, verified=verified)
    from mjcompose.build.cache.cells import cells_of, check_axes_are_free, of_samples, select_cells

    shown = context.shown(recipe)
    cells = cells_of(recipe, context, dict(given))
    if not cells and not sink.errors:
        message = f"`{shown}` has neither `matrix` nor `randomize`: it is one model"
        sink.error("missing-key", message, help="build it without `cell` and `sample`")
    chosen = cells if cell is None else select_cells(cells, [cell], sink, recipe=shown)
    if sample or any(each.is_sample for each in chosen if each.name != cell):
        chosen = of_samples(chosen, [sample], sink)
    if len(chosen) > 1:
        names = [each.name for each in chosen]
        notes = (exists_note("cell", names),)
        sink.error("selector", f"{len(names)} models fit", notes=notes, help="name one as `cell`")
    check_axes_are_free(chosen, given, sink, instead="omit `cell`")
    if sink.errors or not chosen:
        return None
    one = chosen[0]
    return Request(recipe, {**given, **one.given}, name=one.name, sample=one.sample, verified=verified)


def _text(built: Built, context: Context) -> tuple[str, list[str]]:
    """Return the model's text, and the generated files that it names.

    Assets keep their paths, so MuJoCo's cache of meshes, which uses path and time, has them already. Generated assets
    go to the store, by their hash.
    """
    folder = Store.of(context.environment).folder / "opened"
    root = built.composed.model.root
    inner = [each for each in built.composed.files
             if each.element.tag == "model" or each.element.getroottree().getroot() is not root]  # fmt: skip
    generated = _write_models(root, inner, folder) if inner else []
    for use in built.composed.files:
        if use in inner:
            continue
        path = os.path.abspath(context.folder / use.source)
        if use.content is not None:
            path = str(folder / f"{blobs.digest(use.content)}{os.path.splitext(use.path)[1]}")
            generated.append(path)
            if not os.path.exists(path):
                blobs.write_whole(folder.parent, path, use.content)
        if use.element.tag in NAMED_AFTER_FILE and not use.element.get("name"):
            use.element.set("name", stem(use.path))
        use.element.set(use.attribute, path)
    return write(root).decode(), generated


def _write_models(root: Any, uses: list[FileUse], folder: Path) -> list[str]:
    """Write the models that MuJoCo attaches, which name their files by relative paths; return all their files."""
    contents = {use.path: read_regular(use.source) if use.content is None else use.content for use in uses}
    key = json.dumps([[path, blobs.digest(content)] for path, content in sorted(contents.items())])
    place = folder / blobs.digest(key.encode())
    for path, content in contents.items():
        if not os.path.exists(place / path):
            blobs.write_whole(folder.parent, place / path, content)
    for element in root.iterfind("asset/model"):
        element.set("file", str(place / str(element.get("file"))))
    return [str(place / path) for path in contents]


def as_json(values: Mapping[str, Any]) -> dict[str, str]:
    """Return values of Python as text that `nodes_of` reads. Raises TypeError."""

    def plain(value: Any) -> Any:
        if hasattr(value, "tolist"):  # of numpy
            return value.tolist()
        raise TypeError(f"a recipe has no values such as {value!r}")

    return {name: json.dumps(value, default=plain, ensure_ascii=False) for name, value in sorted(values.items())}


def nodes_of(written: Mapping[str, str], context: Context) -> Given:
    nodes = {name: load(text, f"{name}=", context.sink) for name, text in written.items()}
    return {name: node for name, node in nodes.items() if node is not None}


def main(recipe: str, folder: str) -> int:
    """Print the MJCF of a recipe or, on one line, why there is none; standard error gets all diagnostics."""
    forget_current_folder()
    if os.name == "posix":
        limit(in_force().memory, 0)
    try:
        os.chdir(folder)
        text = text_of(recipe)
        code = 0
    except MjcomposeError as error:
        sys.stderr.write(f"{error}\n")
        text = in_one_line(error)
        code = 1
    except OSError as error:
        text = f"`{recipe}` cannot be opened: {(error.strerror or str(error)).lower()}"
        code = 1
    sys.stdout.buffer.write(text.encode(errors="replace"))
    return code


def in_one_line(error: MjcomposeError) -> str:
    """Return the first error with its help, and the number of the others. No I/O."""
    first, *others = [each for each in error.diagnostics if each.severity is Severity.ERROR]
    head = render(first).splitlines()[0]
    help = f"; help: {' '.join(first.help.split())}" if first.help else ""
    return f"{head}{help}" + (f" (and {counted(len(others), 'more error')})" if others else "")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
