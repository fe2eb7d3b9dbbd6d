"""The linter: it reads files as models, finds faults by rules, and reports them as diagnostics with fixes."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import asdict, replace
from itertools import islice, takewhile
from pathlib import Path
from xml.sax.saxutils import escape

from lxml.etree import _Element as Node

from mjcompose.base.access import ALL, Door, door_of_named, door_of_walk
from mjcompose.base.codes import BY_TOPIC
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Diagnostic, Fix, Severity, Span
from mjcompose.base.files import MJCF_FILES, MODEL_FILES, RECIPES, URDF_FILES, open_regular
from mjcompose.base.sink import Sink
from mjcompose.lint.rule import ElementEdit, Finding, LintQuestion, PlacedFinding, Rule, Subject, found, in_child
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import CRASHES, parse, report as report_message, translate
from mjcompose.sides.operand import OperandKind, read_operand
from mjcompose.sides.side import load
from mjcompose.sources.context import Context
from mjcompose.tree.parse import all_admitted, parse_file
from mjcompose.tree.unit import Unit, element_at, line_of
from mjcompose.tree.xml_text import Stretch, write

SUFFIXES = (*MODEL_FILES, ".zip", ".mjz")
_KEPT = "lint"
_ABOUT_URDF = {*BY_TOPIC["URDF and xacro"], *BY_TOPIC["Meshes"], "mujoco-warning", "name-clash", "unknown-name"}
_HIDDEN = re.compile(r"\..+|__pycache__|node_modules")
_IGNORED = re.compile(r"mjcompose:\s*(ignore|ignore-file)\[([\w\s,-]+)\]")
_MODEL = re.compile(rb"<mujoco[\s>].*<(worldbody|include|attach)[\s/>]", re.DOTALL)
_RECIPE = re.compile(rb"^(recipe|extends)\s*:", re.MULTILINE)
_INCLUDE = re.compile(rb"""<include\s+file\s*=\s*["']([^"']+)""")
_GLOB = re.compile(r"[*?\[]")
_HEAD = 1 << 20
_MOST_NEAR = 200


class LintFile(Struct):
    """A file to lint. If it `may_be_part` of another file, its errors do not count. `door` has the files to change."""

    path: Path
    may_be_part: bool = False
    door: Door = ALL


def targets_of(paths: Iterable[Path]) -> list[LintFile]:
    """Return the models in folders, the models that a glob matches, and all other paths unchanged.

    A folder with a manifest is a bundle. In another folder, an XML or YAML file counts if it is a model or a recipe.
    A file that another file includes may not be a model by itself.
    """
    found: dict[Path, LintFile] = {}
    for path in paths:
        named = sorted(Path().glob(str(path))) if _GLOB.search(str(path)) and not os.path.exists(path) else [path]
        for each in named or [path]:
            if os.path.isdir(each) and not _is_bundle(each):
                below = _models_below(each)
            elif each == path:
                below = [LintFile(each, door=door_of_named(each))]
            else:
                below = [LintFile(each, door=door_of_walk(_folder_of_glob(path)))]
            found |= {target.path: target for target in below}
    return list(found.values())


def _folder_of_glob(pattern: Path) -> Path:
    """Return the folder that a glob looks through: the steps before the first one with a special character."""
    return Path(*takewhile(lambda step: not _GLOB.search(step), pattern.parts))


def _is_bundle(folder: Path) -> bool:
    return os.path.isfile(folder / "manifest.json")


def _models_below(top: Path) -> list[LintFile]:
    models: list[Path] = []
    included: set[str] = set()
    for folder, folders, names in os.walk(top):
        here = Path(folder)
        bundles = [here / name for name in folders if _is_bundle(here / name)]
        folders[:] = [name for name in folders if not _HIDDEN.fullmatch(name) and here / name not in bundles]
        models += bundles
        for path in (here / name for name in names):
            kind = path.suffix.lower()
            head = _head(path) if kind in (*MJCF_FILES, *RECIPES) else b""
            if kind in MJCF_FILES:
                included |= _included(path, head)
            is_model = _MODEL.search(head) if kind in MJCF_FILES else _RECIPE.search(head) if head else kind in SUFFIXES
            models += [path] if is_model else []
    door = door_of_walk(top)
    return [LintFile(path, os.path.normpath(path) in included, door) for path in sorted(models)]


def _included(path: Path, head: bytes) -> set[str]:
    return {os.path.normpath(path.parent / os.fsdecode(name)) for name in _INCLUDE.findall(head)}


def _others(path: Path) -> bytes:
    """Return the text of the models near a file that include it, of their files, and of recipes that name it."""
    path = Path(os.path.abspath(path))
    near = [
        each
        for folder in (path.parent, path.parent.parent)
        for kind in (*MJCF_FILES, *RECIPES)
        for each in islice(folder.glob(f"*{kind}"), _MOST_NEAR)
        if os.path.isfile(each)
    ]
    heads = {str(each): _head(each) for each in near}
    recipes = [text for name, text in heads.items() if name.endswith(RECIPES) and os.fsencode(path.name) in text]
    waiting = [name for name, text in heads.items() if str(path) in _included(Path(name), text)]
    texts = {str(path): b""}
    while waiting and len(texts) < _MOST_NEAR:
        name = waiting.pop()
        if name not in texts and os.path.isfile(name):
            texts[name] = _head(Path(name))
            waiting += _included(Path(name), texts[name])
    return b"\n".join((*recipes, *texts.values()))


def _may_be_used(finding: Finding, others: bytes, may_be_part: bool) -> bool:
    """Return whether a model that includes the file may use the element, which the file itself does not use."""
    if finding.edit is None or not finding.edit.removes or finding.element is None or finding.attribute is None:
        return False
    names = {str(each.get(key)) for each in finding.element.iter("*") for key in ("class", "name") if each.get(key)}
    names |= set() if finding.element.get("name") else {Path(str(finding.element.get("file"))).stem}
    word = re.compile(rf"(?<![\w.-])({'|'.join(map(re.escape, names))})(?![\w.-])".encode())
    return (may_be_part and not others) or word.search(others) is not None


def _head(path: Path) -> bytes:
    with suppress(OSError), open_regular(path) as file:
        return file.read(_HEAD)
    return b" "


class Linted(Struct):
    """The result for one file: its findings, without ignored ones, and the number of ignored findings."""

    path: Path
    found: tuple[Diagnostic, ...]
    ignored: int = 0


def lint(path: Path, context: Context, session: Session, selected: Sequence[Rule], may_be_part: bool = False) -> Linted:
    """Return the findings of rules about the model of a file; errors of the model itself are reported to the context.

    `path` is an MJCF or URDF file, a recipe or a bundle. If MuJoCo refuses the model, the rules that need it are left
    out. An element counts as used if a model that includes the file uses it, or a recipe that names the file.
    """
    with ExitStack() as opened:
        read = _model(path, context, session, opened=opened)
        if read is None:
            return Linted(path, ())
        unit = read.unit
        subject = Subject(unit.root, unit, is_part=read.is_part)
        findings = list(found(subject, [each for each in selected if not each.in_mujoco]))
        deep = [each for each in selected if each.in_mujoco]
        if read.is_compiled and deep:
            findings += _in_mujoco(read, context, session, selected=deep)
        if any(each.edit is not None and each.edit.removes for _, each in findings):
            others = _others(path)
            findings = [each for each in findings if not _may_be_used(each[1], others, may_be_part)]
        places = {element: at for at, element in enumerate(unit.root.iter("*"))}
        findings.sort(key=lambda each: -1 if each[1].element is None else places[each[1].element])
        every = [_diagnostic(each, finding, unit, is_written=read.is_written) for each, finding in findings]
        if path.suffix.lower() in URDF_FILES:
            every += _of_reading(context.sink)
        comments = _Comments(unit)
        kept = tuple(each for each in every if not comments.ignore(each))
        return Linted(path, kept, len(every) - len(kept))


class _Model(Struct):
    """The model of a file, and its text as MJCF.

    `is_part` says whether other files may complete it, `is_compiled` whether the session keeps it, and `is_written`
    whether it matches the file, without being linked or converted.
    """

    unit: Unit
    text: bytes
    is_part: bool
    is_compiled: bool
    is_written: bool


def _model(path: Path, context: Context, session: Session, opened: ExitStack) -> _Model | None:
    """Return the model of a file, or None if it cannot be read, which is reported."""
    operand = read_operand(str(path), context, opened)
    if operand is None:
        return None
    if operand.kind is not OperandKind.MJCF:
        side = load(operand, _KEPT, session)
        operand.report(context.sink)
        if side is None or side.traced is None:
            return None
        unit = side.traced.model
        is_part = path.suffix.lower() in URDF_FILES
        return _Model(unit, write(unit.root), is_part, is_compiled=True, is_written=False)
    read = parse_file(path, context.sink, file=context.shown(path))
    if read is None or not all_admitted(read, context.sink, context.shown):
        return None
    text = write(read.root)
    compiled = engine.compile(path.parent, path.name, text=text.decode(), keep=_KEPT, session=session)
    if not compiled.ok:
        _refused(compiled, read, text, context=context)
    return _Model(read, text, is_part=True, is_compiled=compiled.ok, is_written=True)


def _of_reading(sink: Sink) -> Iterator[Diagnostic]:
    """Yield the warnings about the elements and meshes of a URDF, which no other command shows for a file alone."""
    for each in sink.sorted():
        if each.severity is Severity.WARNING and each.code in _ABOUT_URDF:
            yield each


def _refused(compiled: engine.Compiled, unit: Unit, text: bytes, context: Context) -> None:
    error = compiled.error or ""
    crash = compiled.crash
    at = Span(unit.file, 1, 1)
    if crash is not None:
        context.sink.error(CRASHES.get(crash, "mujoco-crash"), f"`{unit.file}`: {error}", at)
        return
    fault = parse(error)
    element = None if fault.line is None else element_at(unit.root, text, fault.line)
    report_message(translate(fault.message, element), element, unit, context=context, at=at)


def _in_mujoco(
    read: _Model, context: Context, session: Session, selected: Sequence[Rule]
) -> Iterator[tuple[Rule, Finding]]:
    by_code = {each.code: each for each in selected}
    unit = read.unit
    question = LintQuestion(read.text.decode(), list(by_code), read.is_part)
    answer = engine.call(session, in_child, [_KEPT], argument=asdict(question))
    if not answer.ok:
        code = CRASHES.get(answer.crash or "", "mujoco-crash")
        context.sink.error(code, f"`{unit.file}`: {answer.error or answer.crash}", Span(unit.file, 1, 1))
        return
    elements = list(unit.root.iter("*"))
    for placed in map(PlacedFinding.of, answer.value):
        yield by_code[placed.code], placed.finding(elements)


def _diagnostic(rule: Rule, finding: Finding, unit: Unit, is_written: bool) -> Diagnostic:
    element = finding.element
    span = Span(unit.file, 1, 1)
    if element is not None:
        span = unit.origins.span(element, unit.file, finding.attribute)
    fix = None if element is None or finding.edit is None or not is_written else fix_of(element, finding.edit, unit)
    return Diagnostic(rule.code, finding.message, span, severity=Severity.WARNING, help=finding.help, fix=fix)


def fix_of(element: Node, edit: ElementEdit, unit: Unit) -> Fix | None:
    """Return the change of the file's text, or None if the file has the element in another form."""
    owner = unit.origins.owner(element, unit.file)
    line = line_of(element)
    if not isinstance(owner, str) or line is None or element in unit.origins.settings:
        return None
    text = unit.origins.text(owner)
    if text is None:
        return None
    if owner != unit.file and (edit.removes or "name" in dict(edit.attributes)):
        return None  # other models may include the file
    tag = str(element.tag)
    written = {str(name): str(value) for name, value in element.items()}
    if edit.removes:
        ends = text.whole(tag, line, written)
        return None if ends is None else _replaced(owner, ends[0], "", start=ends[0].column, last=ends[1])
    at = text.element(tag, line, written)
    if at is None:
        return None
    names = {name for name, _ in edit.attributes}
    if names.isdisjoint(written):
        added = "".join(f' {name}="{_escaped(value)}"' for name, value in edit.attributes)
        return _replaced(owner, at, added, start=at.end_column)
    if len(edit.attributes) != 1:
        return None
    ((name, value),) = edit.attributes
    at = text.attribute(tag, line, written, name=name)
    key = text.attribute(tag, line, written, name=name, key=True)
    if at is None or key is None:
        return None
    return _fix_of_attribute(owner, key, at, value)


def _fix_of_attribute(file: str, key: Stretch, at: Stretch, value: str | None) -> Fix | None:
    """Return the change of a written attribute to a value, or its removal with None."""
    if value is not None:
        return _replaced(file, at, _escaped(value), start=at.column)
    if at.line != key.line:
        return None
    return _replaced(file, at._replace(end_column=at.end_column + 1), "", start=max(key.column - 1, 1))


def _replaced(file: str, first: Stretch, replacement: str, *, start: int, last: Stretch | None = None) -> Fix:
    last = last or first
    return Fix(replacement, None, Span(file, first.line, start, end_line=last.line, end_column=last.end_column))


def _escaped(value: str | None) -> str:
    return escape(value or "", {each: f"&#{ord(each)};" for each in "\"'\n\r\t"})


class _Comments:
    """The comments in the files of a model that ignore findings."""

    def __init__(self, unit: Unit) -> None:
        self.unit = unit
        self._lines: dict[str, list[str]] = {}
        self._of_files: dict[str, set[str]] = {}

    def ignore(self, diagnostic: Diagnostic) -> bool:
        """Return whether a comment on the line of a finding, above it, or for the file ignores it."""
        span = diagnostic.span
        if span is None:
            return False
        if span.file not in self._lines:
            text = self.unit.origins.text(span.file)
            lines = [] if text is None else text.text.split("\n")
            self._lines[span.file] = lines
            self._of_files[span.file] = {code for line in lines for code in _ignored(line, "ignore-file")}
        lines = self._lines[span.file]
        own = lines[span.line - 1 : span.line]
        above = (lines[number] for number in range(span.line - 2, -1, -1)) if own else ()
        near = [*own, *takewhile(lambda line: line.strip().startswith(("<!--", "#")), above)]
        is_ignored = any(diagnostic.code in _ignored(line, "ignore") for line in near)
        return is_ignored or diagnostic.code in self._of_files[span.file]


def _ignored(line: str, word: str) -> list[str]:
    """Return the codes that a comment on a line ignores.

    >>> _ignored("<!-- mjcompose: ignore[unused-class, overlap] -->", "ignore")
    ['unused-class', 'overlap']
    """
    found = _IGNORED.search(line)
    return re.split(r"[\s,]+", found[2].strip()) if found and found[1] == word else []


def lint_all(
    targets: Sequence[LintFile],
    new_context: Callable[[], Context],
    selected: Sequence[Rule],
    jobs: int,
    done: Callable[[Path], None],
) -> list[tuple[Linted, Context]]:
    """Lint files with `jobs` processes of MuJoCo; each result has a context with the errors of its model.

    Each file has a new context, because the lock file of a recipe belongs to its context.
    """
    from concurrent.futures import ThreadPoolExecutor
    from contextvars import copy_context
    from queue import SimpleQueue

    with ExitStack() as opened:
        free: SimpleQueue[Session] = SimpleQueue()
        for _ in range(max(1, min(jobs, len(targets)))):
            free.put(opened.enter_context(Session()))

        def one(target: LintFile) -> tuple[Linted, Context]:
            own = new_context()
            session = free.get()
            try:
                linted = lint(target.path, own, session, selected=selected, may_be_part=target.may_be_part)
            finally:
                free.put(session)
                done(target.path)
            if target.may_be_part and own.sink.has_errors:
                return Linted(target.path, ()), replace(own, sink=Sink())
            return linted, own

        with ThreadPoolExecutor(jobs) as executor:  # the limits of the command are variables of its context
            return [each.result() for each in [executor.submit(copy_context().run, one, target) for target in targets]]


def merged(found: Collection[Diagnostic]) -> Iterator[tuple[Diagnostic, Cause]]:
    """Yield findings with a common cause: the findings of a rule in a file become one block."""
    yield from ((each, Cause(f"{each.code} {each.span.file if each.span else ''}", each.message)) for each in found)
