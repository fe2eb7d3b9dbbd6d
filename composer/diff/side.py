"""A or B, compiled. MuJoCo's child process keeps the model; the tree shows where everything came from."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from composer import engine
from composer.bundle.assemble import assemble
from composer.bundle.bundle import MANIFEST, MODEL, Bundle
from composer.bundle.collect import collect
from composer.bundle.output_error import OutputError
from composer.bundle.read import ReadError, read
from composer.cache.cells import cells_of, check_axes_are_free, picked_one
from composer.cache.result import files_read
from composer.compose.compose import Composer
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diff.change import End
from composer.diff.operand import Kind, Operand
from composer.expand.matrix import Cell
from composer.explain.trace import Trace
from composer.explain.traced import Traced
from composer.link.measure import measure_with
from composer.mujoco_errors.message import CRASHES, Fault, parse
from composer.plan.allowed import acknowledge
from composer.plan.concrete import Given
from composer.plan.drawn_parameters import check_sample
from composer.plan.foreseen import Excluded
from composer.plan.matrix import read_matrix
from composer.plan.plan import Plan
from composer.plan.planner import make_plan, plan_what_remains
from composer.reading.door import NOTHING
from composer.reading.regular import read_regular
from composer.tree.admitted import all_admitted
from composer.tree.expansion import CODE as TOO_MUCH
from composer.tree.files import file_attributes, join, written_path
from composer.tree.parse import parse_file, parse_text
from composer.tree.unit import Unit
from composer.verify.compile_report import judge
from composer.verify.compiles import StrangerError, verify

if TYPE_CHECKING:
    from composer.compose.load import Library
    from composer.engine import Session


@dataclass(slots=True)
class Side:
    """One of the two compared models.

    `kept` is the name under which the session keeps the model; `digests` are the sha256 of files by path, for an
    MJCF file that of the file alone. `traced` is None if the origin of elements is unknown, `plan` is None if this
    is not a recipe. `cell` is the compared cell of its matrix, `cells` the number of cells. `given` are the values
    of parameters and variants from the command or the cell. `inputs` are the files that were read. `bundle` is set
    for a recipe or bundle if the caller asked for it. `excluded` are the bodies that need not collide, of a recipe
    that asks for these.
    """

    operand: Operand
    kept: str
    digests: dict[str, str]
    traced: Traced | None
    plan: Plan | None = None
    cell: str | None = None
    cells: int = 0
    given: Given = field(default_factory=dict)
    inputs: tuple[Path, ...] = ()
    texts: dict[str, str] = field(default_factory=dict)
    read: dict[str, list[str]] = field(default_factory=dict)
    bundle: Bundle | None = None
    excluded: tuple[Excluded, ...] = ()

    @property
    def end(self) -> End:
        whole = hashlib.sha256("".join(f"{path}\0{sha}\n" for path, sha in self.digests.items()).encode())
        cells = 0 if self.cell is not None else self.cells
        outside = _outside(self.operand, self.inputs)
        return End(
            self.operand.label,
            self.operand.kind,
            whole.hexdigest(),
            cell=self.cell,
            cells=cells,
            outside=outside,
        )

    def lines(self, file: str) -> list[str]:
        """Return the lines of a file; none if it cannot be read."""
        if file not in self.read:
            text = self.texts.get(file)
            if text is None:
                try:
                    text = read_regular(self.operand.context.folder / file).decode("utf-8", "replace")
                except (OSError, ValueError):
                    text = ""
            self.read[file] = text.splitlines()
        return self.read[file]


def load(
    operand: Operand,
    kept: str,
    session: Session,
    given: Given | None = None,
    pick: str | None = None,
    sample: int | None = None,
    library: Library | None = None,
    *,
    whole: bool = False,
) -> Side | None:
    """Return the compiled model of an operand, or None if there is none, which goes to its sink.

    For a recipe it is the cell `pick` of its matrix, or the `sample` of its draws. `library` has source files that
    were read before. With `whole` the side has its bundle.
    """
    if operand.kind is Kind.RECIPE:
        side = _recipe(operand, kept, session, given=given or {}, pick=pick, sample=sample, library=library)
    elif operand.kind is Kind.MJCF:
        side = _mjcf(operand, kept, session)
    else:
        side = _bundle(operand, kept, session)
    if side is not None and not whole:
        side.bundle = None
    return side


def _recipe(
    operand: Operand,
    kept: str,
    session: Session,
    given: Given,
    pick: str | None,
    sample: int | None,
    library: Library | None,
) -> Side | None:
    cell = None if pick is None else _cell(operand, given, pick, sample=sample)
    if pick is not None and cell is None:
        return None
    side = load_cell(operand, kept, session, given=given, cell=cell, sample=sample or 0, library=library)
    if side is not None:
        side.cell = pick
    return side


def load_cell(
    operand: Operand,
    kept: str,
    session: Session,
    given: Given,
    cell: Cell | None,
    sample: int = 0,
    library: Library | None = None,
) -> Side | None:
    """Return the model of a cell of a recipe, or without one the `sample` of its draws; None as in `load`."""
    context, watch = operand.context, Trace()
    if cell is None:
        values = given
        plan = make_plan(operand.path, context, given, sample=sample)
        if plan is not None and not check_sample(plan, sample, context.sink):
            return None
    else:
        values = {**given, **cell.given}
        plan = plan_what_remains(operand.path, context, values, name=cell.name, sample=cell.sample)
    if plan is None or context.sink.has_errors:
        return None
    measure = measure_with(context, session=session)
    composer = Composer(context, measure, session, watch=watch, library=library, checks_sources=True)
    if (composed := composer.compose(plan)) is None:
        return None
    if (bundle := assemble(plan, composed.model, composed.files, context=context)) is None:
        return None
    watch([composed.model], collect)
    compiled = judge(bundle, composed.model, context, session=session, keep=kept, at=plan.span)
    acknowledge(plan, context.sink, context.shown, whole=False)
    if compiled is None or context.sink.has_errors:
        return None
    traced = Traced(composed.model, watch, plan.separator, folder=context.folder)
    matrix = read_matrix(operand.path, context, given)
    cells = len(matrix.cells) if matrix else 0
    name = None if cell is None else cell.name
    inputs = tuple(files_read(plan, composed.model, composed.files))
    return Side(
        operand,
        kept,
        _digests(bundle),
        traced=traced,
        plan=plan,
        cell=name,
        cells=cells,
        given=values,
        inputs=inputs,
        bundle=bundle,
        excluded=composed.excluded,
    )


def _outside(operand: Operand, inputs: Iterable[Path]) -> tuple[str, ...]:
    """Return the files of a revision that are not in its repository, from its top: these are as they are now."""
    root = operand.files
    if root is None:
        return ()
    there = {Path(os.path.normpath(path)) for path in inputs}
    return tuple(sorted(os.path.relpath(path, root) for path in there if not path.is_relative_to(root)))


def _cell(operand: Operand, given: Given, pick: str, sample: int | None) -> Cell | None:
    """Return the picked cell, or None if there is no such cell, which is reported."""
    sink = operand.context.sink
    every = cells_of(operand.path, operand.context, dict(given))
    if sink.has_errors:
        return None
    cell = picked_one(every, pick, sample, sink=sink, recipe=operand.label)
    if cell is not None:
        check_axes_are_free([cell], given, sink, instead="compare without `--pick`")
    return None if sink.has_errors else cell


def _mjcf(operand: Operand, kept: str, session: Session) -> Side | None:
    context, path = operand.context, operand.path
    shown = context.shown(path)
    unit = parse_file(path, aside := Sink(), file=shown)
    too_much = any(each.code == TOO_MUCH for each in aside.errors)
    if unit is None or too_much or not all_admitted(unit, aside, context.shown):
        for each in aside.errors:
            context.sink.add(each)
        return None
    compiled = engine.compile(path.parent, path.name, keep=kept, session=session)
    if not compiled.ok:
        fault = Fault(compiled.error or "") if compiled.crash else parse(compiled.error or "")
        _refused(fault, compiled.crash, shown, context=context)
        return None
    digest = hashlib.sha256(read_regular(path)).hexdigest()
    inputs = tuple(_files_of(unit, path))
    return Side(operand, kept, {MODEL: digest}, traced=_traced(unit, context), inputs=inputs)


def _files_of(unit: Unit, path: Path) -> Iterator[Path]:
    """Yield an MJCF file, the files that it includes, and the meshes and other files that it names."""
    yield path
    yield from (text.path for text in unit.origins.texts.values() if text.path is not None)
    for element, _, name in file_attributes(unit.root):
        yield Path(join(str(unit.directory), written_path(unit.settings, element, name)))


def _bundle(operand: Operand, kept: str, session: Session) -> Side | None:
    context = operand.context
    shown = context.shown(operand.path)
    try:
        bundle = read(operand.path, shown=shown)
        verified = verify(bundle, session=session, keep=kept, stranger=shown)
    except StrangerError as error:
        for each in error.found:
            context.sink.add(each)
        return None
    except (ReadError, OutputError) as error:
        context.sink.add(error.diagnostic)
        return None
    if verified.error is not None and not verified.compiled.ok:
        _refused(verified.error, verified.crash, f"{shown}/{bundle.model}", context=context)
        return None
    file, text = f"{shown}/{bundle.model}", bundle.files[bundle.model]
    unit = parse_text(
        text,
        Sink(),
        file=file,
        directory=operand.path,
        label=operand.path.stem,
        contents=bundle.files,
        door=NOTHING,
    )
    files = [operand.path / name for name in bundle.files] if os.path.isdir(operand.path) else [operand.path]
    side = Side(operand, kept, _digests(bundle), traced=_traced(unit, context), inputs=tuple(files))
    side.bundle = bundle
    side.texts[file] = text.decode("utf-8", "replace")
    return side


def _traced(unit: Unit | None, context: Context) -> Traced | None:
    if unit is None:
        return None
    watch = Trace()
    watch([unit], parse_file)
    return Traced(unit, watch, "/", folder=context.folder)


def _refused(fault: Fault, crash: str | None, file: str, context: Context) -> None:
    code = "mujoco-rejects" if crash is None else CRASHES.get(crash, "mujoco-crash")
    span = None if fault.line is None else Span(file, fault.line, fault.column or 1)
    named = f" ({fault.element or 'element'} `{fault.name}`)" if fault.name else ""
    said = " ".join(fault.message.split())
    context.sink.error(code, f"`{file}` does not compile: {said}{named}", span)


def _digests(bundle: Bundle) -> dict[str, str]:
    """Return the digests of all files except the manifest, which describes the build and not the model."""
    return {path: bundle.digest(path) for path in bundle.files if path != MANIFEST}
