"""A model of an operand: composed or read, compiled, and traced."""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from dataclasses import field
from pathlib import Path

from mjcompose.base.access import NOTHING
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.bundle.assemble import assemble
from mjcompose.bundle.bundle import MANIFEST, MODEL, Bundle, OutputError
from mjcompose.bundle.read import ReadError, read
from mjcompose.compose.compose import ComposeOptions, Composer
from mjcompose.compose.load import Library
from mjcompose.language.expand import Cell
from mjcompose.link.collect import collect
from mjcompose.link.measure import measure_with
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import CRASHES, EngineMessage, parse
from mjcompose.pipeline.cache.builder import source_files
from mjcompose.pipeline.cache.cells import cells_of, check_axes_are_free, select_cell
from mjcompose.plan.describe import acknowledge
from mjcompose.plan.matrix import check_sample, read_matrix
from mjcompose.plan.plan import ExcludedPair, Plan
from mjcompose.plan.planner import make_plan, plan_what_remains
from mjcompose.plan.read import Given
from mjcompose.sides.operand import Operand, OperandKind
from mjcompose.sources.context import Context
from mjcompose.trace.trace import Trace
from mjcompose.trace.traced import Traced
from mjcompose.tree.cost import CODE as TOO_MUCH
from mjcompose.tree.files import file_attributes, join, written_path
from mjcompose.tree.parse import all_admitted, parse_file, parse_text
from mjcompose.tree.unit import Unit
from mjcompose.verify.compile import OutsideFilesError, compile_and_report, verify


class End(Struct):
    """A or B: its name in messages, its kind, and the sha256 of its files without the manifest.

    `cell` is the cell of its matrix that was compared. Without it, `cells` is the number of cells. `outside` are the
    files of a git revision that are not in its repository; they are used in their current state.
    """

    label: str
    kind: str
    sha256: str
    cell: str | None = None
    cells: int = 0
    outside: tuple[str, ...] = ()

    @property
    def said_outside(self) -> str:
        """A sentence about the files that are not in the revision, or an empty text."""
        if not self.outside:
            return ""
        more = f" and {len(self.outside) - 3} more" if len(self.outside) > 3 else ""
        named = ", ".join(f"`{each}`" for each in self.outside[:3])
        return f"{named}{more}: outside the repository, as now in the work tree"

    @property
    def named(self) -> str:
        return self.label if self.cell is None else f"{self.label}: {self.cell}"


class Side(Struct, frozen=False):
    """One of the two compared models.

    `kept` is the name under which the session keeps the model; `digests` are the sha256 of files by path, for an MJCF
    file, only its own. `traced` is None if the origin of elements is unknown, and `plan` is None if this is not a
    recipe. `cell` is the compared cell of its matrix, and `cells` is the number of cells. `given` are the values of
    parameters and variants from the command or the cell. `inputs` are the files that were read. `bundle` is set for a
    recipe or bundle if the caller requests it. `excluded` are the bodies that need not collide, if the recipe requests
    them.
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
    read: dict[str, list[str]] = field(default_factory=dict)
    bundle: Bundle | None = None
    excluded: tuple[ExcludedPair, ...] = ()

    @property
    def end(self) -> End:
        whole = hashlib.sha256("".join(f"{path}\0{sha}\n" for path, sha in self.digests.items()).encode())
        cells = 0 if self.cell is not None else self.cells
        root = self.operand.files
        outside: set[str] = set()
        if root is not None:  # files outside of the repository are as they are now
            inputs = (Path(os.path.normpath(path)) for path in self.inputs)
            outside = {os.path.relpath(path, root) for path in inputs if not path.is_relative_to(root)}
        return End(
            self.operand.label,
            self.operand.kind,
            whole.hexdigest(),
            cell=self.cell,
            cells=cells,
            outside=tuple(sorted(outside)),
        )

    def lines(self, file: str) -> list[str]:
        """Return the lines of a file; none if it cannot be read."""
        if file not in self.read:
            self.read[file] = []
            with suppress(OSError, ValueError):
                content = read_regular(self.operand.context.folder / file)
                self.read[file] = content.decode("utf-8", "replace").splitlines()
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
    """Return the compiled model of an operand, or None if there is none, which is reported.

    For a recipe it is the cell `pick` of its matrix, or the `sample` of its draws. `library` has source files that
    were read before. With `whole` the side has its bundle.
    """
    if operand.kind is not OperandKind.RECIPE:
        side = (_mjcf if operand.kind is OperandKind.MJCF else _bundle)(operand, kept, session)
    else:
        cell = None if pick is None else _cell(operand, given or {}, pick, sample=sample)
        if pick is not None and cell is None:
            return None
        side = load_cell(operand, kept, session, given=given or {}, cell=cell, sample=sample or 0, library=library)
        if side is not None:
            side.cell = pick
    if side is not None and not whole:
        side.bundle = None
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
    """Return the model of a cell of a recipe, or without a cell the `sample` of its draws; None as in `load`."""
    context = operand.context
    watch = Trace()
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
    options = ComposeOptions(checks_sources=True)
    with watch.recording():
        composed = Composer(context, measure, session, watch=watch, library=library, options=options).compose(plan)
        bundle = (
            None
            if composed is None
            else assemble(plan, composed.model, composed.files, context, terrain=composed.terrain)
        )
        if composed is None or bundle is None:
            return None
        watch([composed.model], collect)
    compiled = compile_and_report(bundle, composed.model, context, session=session, keep=kept, at=plan.span)
    acknowledge(plan, context.sink, context.shown, whole=False)
    if compiled is None or context.sink.has_errors:
        return None
    traced = Traced(composed.model, watch, plan.separator, folder=context.folder, merged=composed.merged)
    matrix = read_matrix(operand.path, context, given)
    return Side(
        operand,
        kept,
        _digests(bundle),
        traced=traced,
        plan=plan,
        cell=None if cell is None else cell.name,
        cells=len(matrix.cells) if matrix else 0,
        given=values,
        inputs=tuple(source_files(plan, composed.model, composed.files)),
        bundle=bundle,
        excluded=composed.excluded,
    )


def _cell(operand: Operand, given: Given, pick: str, sample: int | None) -> Cell | None:
    """Return the picked cell, or None if there is no such cell, which is reported."""
    sink = operand.context.sink
    every = cells_of(operand.path, operand.context, dict(given))
    cell = None if sink.has_errors else select_cell(every, pick, sample, sink=sink, recipe=operand.label)
    if cell is not None:
        check_axes_are_free([cell], given, sink, instead="compare without `--pick`")
    return None if sink.has_errors else cell


def _mjcf(operand: Operand, kept: str, session: Session) -> Side | None:
    context = operand.context
    path = operand.path
    shown = context.shown(path)
    unit = parse_file(path, aside := Sink(), file=shown)
    too_much = any(each.code == TOO_MUCH for each in aside.errors)
    if unit is None or too_much or not all_admitted(unit, aside, context.shown):
        context.sink.extend(aside.errors)
        return None
    compiled = engine.compile(path.parent, path.name, keep=kept, session=session)
    if not compiled.ok:
        fault = EngineMessage(compiled.error or "") if compiled.crash else parse(compiled.error or "")
        _refused(fault, compiled.crash, shown, context=context)
        return None
    digest = hashlib.sha256(read_regular(path)).hexdigest()
    included = (text.path for text in unit.origins.texts.values() if text.path is not None)
    named = (written_path(unit.settings, element, name) for element, _, name in file_attributes(unit.root))
    inputs = (path, *included, *(Path(join(str(unit.directory), name)) for name in named))
    return Side(operand, kept, {MODEL: digest}, traced=_traced(unit, context), inputs=inputs)


def _bundle(operand: Operand, kept: str, session: Session) -> Side | None:
    context = operand.context
    shown = context.shown(operand.path)
    try:
        bundle = read(operand.path, shown=shown)
        verified = verify(bundle, session=session, keep=kept, stranger=shown)
    except (OutsideFilesError, ReadError, OutputError) as error:
        context.sink.extend(error.found if isinstance(error, OutsideFilesError) else [error.diagnostic])
        return None
    if verified.error is not None and not verified.compiled.ok:
        _refused(verified.error, verified.crash, f"{shown}/{bundle.model}", context=context)
        return None
    file = f"{shown}/{bundle.model}"
    text = bundle.files[bundle.model]
    unit = parse_text(
        text, Sink(), file=file, directory=operand.path, label=operand.path.stem, contents=bundle.files, door=NOTHING
    )
    files = [operand.path / name for name in bundle.files] if os.path.isdir(operand.path) else [operand.path]
    return Side(
        operand,
        kept,
        _digests(bundle),
        traced=_traced(unit, context),
        inputs=tuple(files),
        bundle=bundle,
        read={file: text.decode("utf-8", "replace").splitlines()},
    )


def _traced(unit: Unit | None, context: Context) -> Traced | None:
    if unit is None:
        return None
    watch = Trace()
    watch([unit], parse_file)
    return Traced(unit, watch, "/", folder=context.folder)


def _refused(fault: EngineMessage, crash: str | None, file: str, context: Context) -> None:
    code = "mujoco-rejects" if crash is None else CRASHES.get(crash, "mujoco-crash")
    span = None if fault.line is None else Span(file, fault.line, fault.column or 1)
    name = f" ({fault.element or 'element'} `{fault.name}`)" if fault.name else ""
    context.sink.error(code, f"`{file}` does not compile: {' '.join(fault.message.split())}{name}", span)


def _digests(bundle: Bundle) -> dict[str, str]:
    """Return the digests of all files except the manifest, which describes the build, not the model."""
    return {path: bundle.digest(path) for path in bundle.files if path != MANIFEST}
