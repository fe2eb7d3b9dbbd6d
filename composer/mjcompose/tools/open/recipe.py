"""A recipe as a model in this process: built without files, except generated assets in the cache.

`python -P -m mjcompose.tools.open.recipe RECIPE FOLDER` prints the MJCF for MuJoCo's decoder in C, or the reason that
there is none, on one line; the exit code says which. `FOLDER` is the current folder of the program.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from itertools import chain
from os import PathLike
from pathlib import Path
from threading import RLock
from typing import Any, NamedTuple, TypeAlias, TypeVar

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Severity, warn
from mjcompose.base.files import DATA, Mark, mark_of, read_regular
from mjcompose.base.guard import limit
from mjcompose.base.limits import in_force
from mjcompose.base.report import MjcomposeError, render, short_traceback
from mjcompose.base.runtime import forget_current_folder
from mjcompose.base.sink import TooManyFaults
from mjcompose.base.suggest import exists_note
from mjcompose.base.words import counted
from mjcompose.link.linking import FileUse
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.cache.inputs import Inputs
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.plan.read import Given
from mjcompose.sources import blobs
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import KINDS
from mjcompose.sources.store import Store
from mjcompose.text.dump import in_brackets, plain
from mjcompose.text.load import load
from mjcompose.tools.open.data import ProgramRecipe, RecipeLike, opened, with_value_keys
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
    recipe: RecipeLike,
    /,
    *,
    cell: str | None = None,
    sample: int = 0,
    verified: bool = False,
    base_dir: str | PathLike[str] | None = None,
    **values: Any,
) -> Spec:
    """Build a recipe in this process and return it as a `mujoco.MjSpec`, which you can edit, attach and compile.

        spec = mjcompose.spec("cell.yaml", tool="flange", reach=0.5)
        spec.worldbody.add_light(pos=[0, 0, 3])
        model = spec.compile()

    `recipe` is the path of a file, a mapping with the same keys, or YAML of several lines. The paths in a mapping or a
    text start at `base_dir`, by default the working directory. A mapping may have numbers and arrays of numpy, tuples
    and paths. An error in it names the line of your program and the keys, such as `recipe['attach']['hand']`:

        spec = mjcompose.spec({"recipe": 1, "base": "./arm.xml", "attach": {"hand": {"model": "./hand.xml"}}})

    `values` are the values of the recipe's parameters and variants, `cell` is the name of a cell of its matrix, and
    `sample` is the number of a sample of `randomize`. With `verified`, MuJoCo compiles the model in a process of its
    own first, and the recipe's checks run. A recipe whose files have not changed is not built again, nor is an equal
    mapping.

    Raises BuildError, and TypeError for a value that a recipe cannot have; warns with RecipeWarning.
    """
    import mujoco

    opening = _Opening.of(recipe, base_dir, cell, sample=sample, verified=verified, values=values)
    return _opened_by(mujoco.MjSpec.from_string, opening)


@short_traceback
def model(
    recipe: RecipeLike,
    /,
    *,
    cell: str | None = None,
    sample: int = 0,
    verified: bool = False,
    base_dir: str | PathLike[str] | None = None,
    **values: Any,
) -> Model:
    """Build a recipe in this process and return it as a compiled `mujoco.MjModel`.

        model = mjcompose.model("cell.yaml", tool="flange")
        data = mujoco.MjData(model)
        model = mjcompose.model({"recipe": 1, "base": "./arm.xml", "option": {"timestep": 0.001}}, base_dir="models")

    Takes the same recipes and values as `mjcompose.spec`. Raises BuildError, and TypeError for a value that a recipe
    cannot have; warns with RecipeWarning.
    """
    import mujoco

    opening = _Opening.of(recipe, base_dir, cell, sample=sample, verified=verified, values=values)
    return _opened_by(mujoco.MjModel.from_xml_string, opening)


class _Opening(Struct):
    """The input of one call: a recipe, its values, and the chosen model."""

    recipe: str | ProgramRecipe
    cell: str | None
    sample: int
    verified: bool
    written: Mapping[str, str]

    @classmethod
    def of(
        cls,
        recipe: RecipeLike,
        base_dir: str | PathLike[str] | None = None,
        cell: str | None = None,
        *,
        sample: int = 0,
        verified: bool = False,
        values: Mapping[str, Any] | None = None,
    ) -> _Opening:
        try:
            return cls(opened(recipe, base_dir), cell, sample=sample, verified=verified, written=as_yaml(values or {}))
        except MjcomposeError as error:
            raise BuildError(error.diagnostics) from None

    @property
    def path(self) -> str:
        return self.recipe if isinstance(self.recipe, str) else self.recipe.path

    @property
    def identity(self) -> tuple[str, str | None]:
        """Equal for equal recipes: the path and, of a recipe that is in no file, the content."""
        return self.path, None if isinstance(self.recipe, str) else self.recipe.key

    @property
    def key(self) -> str:
        places = [os.environ.get(name) for kind in KINDS for name in kind.variables]
        return json.dumps([*self.identity, self.written, self.cell, self.sample, self.verified, places])

    def readable(self) -> AbstractContextManager[None]:
        """Within the block, read the recipe at its path."""
        return nullcontext() if isinstance(self.recipe, str) else self.recipe.readable()

    def named(self, diagnostics: Iterable[Diagnostic], shown: str) -> Iterable[Diagnostic]:
        """Return diagnostics with the recipe's name in messages; `shown` is its path there."""
        diagnostics = with_value_keys(diagnostics, self.written)
        return diagnostics if isinstance(self.recipe, str) else self.recipe.named(diagnostics, shown)


def _opened_by(load: Callable[[str], T], opening: _Opening) -> T:
    """Return the result of MuJoCo's function. If MuJoCo refuses the text, raise BuildError with the place in a file."""
    text = _text_of(opening)
    try:
        return load(text)
    except ValueError as error:
        refused = error
    _text_of(replace(opening, verified=True))  # its error has the line of the source
    raise refused


class _Opened(NamedTuple):
    """The text of a built recipe, and the marks of the files that it depends on. `shown` is its path in messages."""

    text: str
    marks: Mapping[str, Mark]
    warnings: tuple[Diagnostic, ...]
    shown: str

    @property
    def is_current(self) -> bool:
        return all(mark_of(path) == mark for path, mark in self.marks.items())


_MOST = 64
"""The number of recipes whose text is remembered."""
_opened: dict[str, _Opened] = {}
_building = RLock()


def text_of(recipe: str | PathLike[str]) -> str:
    """Return the MJCF of the recipe in a file, which names all files by absolute paths. Raises BuildError.

    The text of an unchanged recipe is remembered. Threads may call it at the same time.
    """
    return _text_of(_Opening.of(Path(recipe)))


def _text_of(opening: _Opening) -> str:
    key = opening.key
    known = _opened.get(key)
    if known is None or not known.is_current:
        with _building:
            known = _opened.get(key)
            if known is None or not known.is_current:
                known = _open(opening)
                _opened.pop(key, None)
                _opened[key] = known
                while len(_opened) > _MOST:
                    del _opened[next(iter(_opened))]
    for diagnostic in opening.named(known.warnings, known.shown):
        warn(render(diagnostic), RecipeWarning)
    return known.text


def files_of(recipe: RecipeLike, *, base_dir: str | PathLike[str] | None = None) -> tuple[str, ...]:
    """Return the files that a recipe depends on, to watch them: all inputs of its models in this process.

        times = {path: os.stat(path).st_mtime for path in mujoco_plugin.files_of("cell.yaml")}

    It has no files before `mjcompose.spec`, `mjcompose.model` or MuJoCo has built it. A mapping or a text is in no file
    itself: build it again when your program changes it.
    """
    own = list(_Opening.of(recipe, base_dir).identity)
    known = (each.marks for key, each in list(_opened.items()) if json.loads(key)[:2] == own)
    files = dict.fromkeys(chain.from_iterable(known))
    return tuple(path for path in files if not os.path.basename(path).startswith(DATA))


def _open(opening: _Opening) -> _Opened:
    started = time.time_ns()
    context = Context(fetching=Fetching())
    recipe = Path(opening.path)
    shown = context.shown(recipe)
    given = nodes_of(opening.written, context)
    try:
        with opening.readable(), Session() as session:
            request = request_for(
                recipe, given, opening.cell, sample=opening.sample, verified=opening.verified, context=context
            )
            built = None if request is None else build(request, context, session=session)
    except TooManyFaults as error:
        raise BuildError(opening.named(error.sink.diagnostics, shown)) from None
    if built is None:
        raise BuildError(opening.named(context.sink.diagnostics, shown))
    inputs = Inputs()
    files = [*inputs.recipes(built.plan), *inputs.others(built, context)]
    marks = {path: mark_of(path) for path in files if not os.path.isdir(path)}
    _forget_changed(marks)
    text, generated = _text(built, context)
    marks |= {path: mark_of(path) for path in generated}
    # A file that changed during the build may have been read before: the model is built again at the next call.
    marks |= {path: None for path in files if (mark := marks.get(path)) is not None and max(mark[:2]) >= started}
    return _Opened(text, marks, tuple(context.sink.diagnostics), shown)


_seen: dict[str, Mark] = {}
"""The marks of all files when a model was last built with them in this process."""


def _forget_changed(marks: Mapping[str, Mark]) -> None:
    """Clear MuJoCo's cache of assets if a file changed.

    MuJoCo 4.0 takes an asset from it if the path and the time in whole seconds are the same.
    """
    import mujoco

    if any(_seen.get(path, mark) != mark for path, mark in marks.items()):
        mujoco.mj_clearCache(mujoco.mj_getCache())
    _seen.update(marks)


def request_for(
    recipe: Path, given: Given, cell: str | None, *, sample: int, verified: bool, context: Context
) -> ModelRequest | None:
    """Return the request for a model, a cell or a sample of a recipe, or None if there is none, which is reported."""
    sink = context.sink
    if cell is None and sample == 0:
        return None if sink.errors else ModelRequest(recipe, given, verified=verified)
    from mjcompose.pipeline.cache.cells import cells_of, check_axes_are_free, of_samples, select_cells

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
    return ModelRequest(recipe, {**given, **one.given}, name=one.name, sample=one.sample, verified=verified)


def _text(built: Built, context: Context) -> tuple[str, list[str]]:
    """Return the model's text, and the generated files that it names.

    Assets keep their paths, so MuJoCo's cache of meshes, which uses path and time, has them already. Generated assets
    go to the store, by their hash.
    """
    folder = Store.of(context.environment).folder / "opened"
    root = built.composed.model.root
    inner = [
        each
        for each in built.composed.files
        if each.element.tag == "model" or each.element.getroottree().getroot() is not root
    ]
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


def as_yaml(values: Mapping[str, Any]) -> dict[str, str]:
    """Return values of Python as text that `nodes_of` reads. Raises TypeError, and MjcomposeError for a limit."""
    return {name: in_brackets(plain(value, name)) for name, value in sorted(values.items())}


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
