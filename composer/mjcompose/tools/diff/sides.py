"""Finding, checking out and compiling A or B, as the user named it."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import re
import shlex
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import field, replace
from enum import StrEnum
from pathlib import Path

from mjcompose.base.access import NOTHING
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import DiagnosticError, Span
from mjcompose.base.files import MJCF_FILES, RECIPES, URDF_FILES, foreign_format, read_regular
from mjcompose.base.scratch import scratch
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
from mjcompose.mujoco.messages import CRASHES, Fault, parse
from mjcompose.pipeline.cache.builder import source_files
from mjcompose.pipeline.cache.cells import cells_of, check_axes_are_free, select_cell
from mjcompose.plan.describe import acknowledge
from mjcompose.plan.matrix import check_sample, read_matrix
from mjcompose.plan.plan import Excluded, Plan
from mjcompose.plan.planner import make_plan, plan_what_remains
from mjcompose.plan.read import Given
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching, quiet
from mjcompose.sources.git_command import Git, GitFailure, GitSilence, objects_around, partial_from, write_tree
from mjcompose.sources.git_repository import replace_by_local
from mjcompose.sources.reference import SourceError, Trust
from mjcompose.tools.diff.changes import End
from mjcompose.tools.explain.explain import Traced
from mjcompose.tools.explain.trace import Trace
from mjcompose.tree.cost import CODE as TOO_MUCH
from mjcompose.tree.files import file_attributes, join, written_path
from mjcompose.tree.parse import all_admitted, parse_file, parse_text
from mjcompose.tree.unit import Unit
from mjcompose.verify.compile import OutsideFilesError, compile_and_report, verify

_LINKS = 5000
"""The most entries that are linked, the nearest first."""


class RevisionError(DiagnosticError):
    """The revision or its files cannot be read."""


def split(text: str) -> tuple[str, str] | None:
    """Split `REV:path` in two; return None for anything else, including a Windows drive.

    >>> split("main~2:arms/left.yaml"), split("left.yaml"), split("C:/left.yaml")
    (('main~2', 'arms/left.yaml'), None, None)
    """
    revision, colon, path = text.partition(":")
    if not colon or not revision or not path or (re.fullmatch(r"[A-Za-z]", revision) and path[0] in "/\\"):
        return None
    return revision, path


def check_out(revision: str, path: Path, into: Path, environment: Mapping[str, str]) -> tuple[Path, Path]:
    """Write all files of a revision of the repository around `path` below the empty folder `into`.

    Return the folder with them, and `path` in it. Links lead to the files outside the repository that it refers to,
    such as `../models/arm.xml`. `path` may be missing in the work tree. Raises RevisionError.
    """
    near = next(each for each in path.absolute().parents if os.path.isdir(each))
    git = Git(environment, quiet, limit=600)

    def asked(fault: str, *arguments: str) -> str:
        try:
            return git.around(near, "rev-parse", *arguments)
        except SourceError as error:
            message = "the git command is not installed: revisions cannot be read"
            raise RevisionError("git-revision", message, "install git") from error
        except GitSilence as error:
            help = f"a file of the repository may be a pipe: `find {shlex.quote(str(near))} -type p` lists them"
            raise RevisionError(
                "git-revision", f"the repository around `{near}` cannot be read: {error}", help
            ) from error
        except GitFailure as error:
            why = str(error).partition("\n")[0].removeprefix("fatal: ")
            raise RevisionError("git-revision", f"{fault}: {why}" if why else fault) from error

    outside = f"`{near}` is not in a git repository"
    top = Path(os.path.realpath(asked(outside, "--show-toplevel")))
    missing = f"the revision `{revision}` does not exist in the repository of `{path.name}`"
    if not Path(os.path.realpath(near)).is_relative_to(top):
        message = f"the repository around `{near}` says that its files are in `{top}`"
        help = f"look at the setting `core.worktree` in the `.git` of `{near}`"
        raise RevisionError("git-revision", message, help)
    commit = asked(missing, *"--verify --quiet --end-of-options".split(), f"{revision}^{{commit}}")
    inside = Path(os.path.relpath(os.path.realpath(near), top), path.absolute().relative_to(near))
    try:  # byte for byte: runs no filters and hooks, which may come from anyone
        root = _beside_the_same(top, into)
        with objects_around(git, near) as (reader, repository):
            write_tree(reader, repository, commit, target=root)
        replace_by_local(root, near / asked(outside, "--git-common-dir") / "lfs" / "objects")  # of all work trees
    except (GitFailure, SourceError, OSError) as error:
        fault = f"the files of revision `{revision}` cannot be checked out"
        how = _how_to_complete(git, near, top) if isinstance(error, GitFailure) else None
        raise RevisionError("git-revision", f"{fault}: {error}", how) from error
    return root, root / inside


def _how_to_complete(git: Git, near: Path, top: Path) -> str | None:
    """Return the command that fetches the missing objects of a partial clone; None for other repositories."""
    remote = partial_from(git, near)
    if remote is None:
        return None
    is_here = Path(os.path.realpath(os.curdir)).is_relative_to(top)
    command = ["git", *([] if is_here else ["-C", str(top)]), "fetch", "--refetch", "--no-filter", remote]
    return (
        f"it is a partial clone, and mjcompose fetches nothing for it. If it is your own, run `{shlex.join(command)}`"
    )


def _beside_the_same(top: Path, into: Path) -> Path:
    """Return an empty folder below `into` with links to everything next to and around a repository."""
    into.joinpath(*top.parts[1:]).mkdir(parents=True, exist_ok=True)
    left = _LINKS
    for folder in top.parents:
        with suppress(OSError), os.scandir(folder) as entries:
            for entry in itertools.islice(entries, left):
                link = into.joinpath(*folder.parts[1:], entry.name)
                if not os.path.lexists(link):
                    with suppress(OSError):  # Windows allows links to some users alone
                        link.symlink_to(entry.path, target_is_directory=os.path.isdir(entry.path))
                left -= 1
    return into.joinpath(*top.parts[1:])


class Kind(StrEnum):
    RECIPE = "recipe"
    MJCF = "MJCF file"
    BUNDLE = "bundle"


class Operand(Struct):
    """A or B. `context` collects its own diagnostics and has the folder that displayed paths start from.

    For a git revision, `files` is the folder with its files. `given` is the model for which `path` is a recipe that
    mjcompose wrote; no message shows it.
    """

    label: str
    kind: Kind
    path: Path
    context: Context
    revision: str | None = None
    files: Path | None = None
    given: Path | None = None

    def located(self, span: Span) -> Span:
        """Return a place that anyone can look up: in a fetched source, or in a named revision."""
        name = self.fetched(self.context.folder / span.file)
        return self._in_revision(span) or span if name is None else replace(span, file=name)

    def fetched(self, path: Path) -> str | None:
        """Return a file by the reference that fetched it, or None for other files."""
        origin = self.context.fetching.around(path) if self.context.fetching is not None else None
        if origin is None or not origin.is_fetched:
            return None
        return origin.named(os.path.relpath(os.path.realpath(path), os.path.realpath(origin.root)))

    def report(self, sink: Sink) -> None:
        """Pass its own diagnostics on to another context."""
        for each in self.context.sink.sorted():
            seen = (note for note in each.notes if not self._is_written(note.span))
            notes = tuple(replace(note, span=self._in_revision(note.span)) for note in seen)
            span = each.span
            if self.given is not None and self._is_written(span):
                span = Span(self.context.shown(self.given), 1, 1)
            sink.add(replace(each, span=self._in_revision(span), notes=notes))

    def _is_written(self, span: Span | None) -> bool:
        """Return whether a place is in the recipe that mjcompose wrote for a model."""
        return self.given is not None and span is not None and self.context.folder / span.file == self.path

    def _in_revision(self, span: Span | None) -> Span | None:
        path = self.context.folder / (span.file if span is not None else "")
        if span is None or self.files is None or not path.is_relative_to(self.files):
            return span
        return replace(span, file=f"{self.revision}:{os.path.relpath(path, self.context.folder)}")


def read_operand(text: str, context: Context, opened: ExitStack) -> Operand | None:
    """Return the operand that `text` names, or None if there is none, which `context` reports.

    Temporary folders live as long as `opened`.
    """
    path = context.folder / text
    revision = None
    files = None
    own = replace(context, sink=Sink())
    if not os.path.exists(path) and (parts := split(text)) is not None:
        revision = parts[0]
        with context.sink:
            path, files, own = _of_revision(revision, parts[1], own, opened=opened)
        if files is None:
            return None
    if not os.path.exists(path):
        where = "" if revision is None else f" in revision `{revision}`"
        shown = text if revision is None else own.shown(path)
        help = None if revision is None else f"`git ls-tree -r --name-only {revision}` lists the files"
        context.sink.error("file-not-found", f"the file or folder `{shown}` does not exist{where}", help=help)
        return None
    kind = _kind(path)
    if kind is None:
        foreign = foreign_format(path)
        message = f"`{text}` is neither a recipe nor an MJCF or URDF file nor a bundle"
        help = "name a .yaml, .xml, .urdf, .xacro, .zip, .mjz or a folder, or one of a git revision as `REV:path`"
        if foreign is not None:
            message = foreign.message(text)
            help = foreign.help(text)
        context.sink.error("source-kind", message, help=help)
        return None
    given = path if path.suffix.lower() in URDF_FILES else None
    if given is not None:
        path = _recipe_of(path, opened)
    return Operand(text, kind, path, context=own, revision=revision, files=files, given=given)


def as_recipe(operand: Operand, opened: ExitStack) -> Operand:
    """Return an MJCF file as a recipe with it as base, which has a bundle; return other operands unchanged."""
    if operand.kind is not Kind.MJCF:
        return operand
    return replace(operand, kind=Kind.RECIPE, path=_recipe_of(operand.path, opened), given=operand.path)


def _recipe_of(path: Path, opened: ExitStack) -> Path:
    """Write a recipe with a model file as base: only composed models are converted."""
    recipe = Path(opened.enter_context(scratch("recipe")), f"{path.stem}.yaml")
    # JSON is valid YAML whatever characters the path contains.
    text = json.dumps({"recipe": 1, "base": os.path.abspath(path)}, ensure_ascii=False)
    recipe.write_text(text, encoding="utf-8")
    return recipe


def _of_revision(revision: str, path: str, context: Context, opened: ExitStack) -> tuple[Path, Path, Context]:
    """Return the path in a checkout of the revision, its root, and a context with the user's folder in it."""
    made = Path(os.path.realpath(opened.enter_context(scratch("revision"))))
    root, there = check_out(revision, context.folder / path, made, environment=context.environment)
    inside = os.path.relpath(there, root)
    named = os.path.normpath(path)
    folder = root
    if not Path(path).is_absolute() and ".." not in Path(path).parts and inside.endswith(named):
        folder = root / inside.removesuffix(named)
    # Its root counts as the root of the project, even without a file there that says so.
    return there, root, replace(context, folder=folder, fetching=Fetching(trust=Trust(files=(root,))))


def _kind(path: Path) -> Kind | None:
    suffix = path.suffix.lower()
    if os.path.isdir(path) or suffix in (".zip", ".mjz"):
        return Kind.BUNDLE
    if suffix in (*URDF_FILES, *RECIPES):
        return Kind.RECIPE
    return Kind.MJCF if suffix in MJCF_FILES else None


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
    excluded: tuple[Excluded, ...] = ()

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
    if operand.kind is not Kind.RECIPE:
        side = (_mjcf if operand.kind is Kind.MJCF else _bundle)(operand, kept, session)
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
    composed = Composer(context, measure, session, watch=watch, library=library, options=options).compose(plan)
    bundle = None if composed is None else assemble(plan, composed.model, composed.files, context=context)
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
        fault = Fault(compiled.error or "") if compiled.crash else parse(compiled.error or "")
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


def _refused(fault: Fault, crash: str | None, file: str, context: Context) -> None:
    code = "mujoco-rejects" if crash is None else CRASHES.get(crash, "mujoco-crash")
    span = None if fault.line is None else Span(file, fault.line, fault.column or 1)
    name = f" ({fault.element or 'element'} `{fault.name}`)" if fault.name else ""
    context.sink.error(code, f"`{file}` does not compile: {' '.join(fault.message.split())}{name}", span)


def _digests(bundle: Bundle) -> dict[str, str]:
    """Return the digests of all files except the manifest, which describes the build, not the model."""
    return {path: bundle.digest(path) for path in bundle.files if path != MANIFEST}
