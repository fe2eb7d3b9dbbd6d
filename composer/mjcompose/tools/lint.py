"""The linter: files become models, rules find their faults, and findings become diagnostics with fixes."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Cause, Diagnostic, Fix, Severity, Span
from mjcompose.base.sink import Sink
from mjcompose.build.lint.rule import Edit, Finding, Rule, Subject, found, in_child
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import CRASHES, parse, translate
from mjcompose.mujoco.messages import report as report_message
from mjcompose.sources.context import Context
from mjcompose.tools.diff.sides import Kind, load, read_operand
from mjcompose.tree.parse import all_admitted, parse_file
from mjcompose.tree.unit import Unit, element_at, line_of
from mjcompose.tree.xml_text import Stretch, write

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

SUFFIXES = (".xml", ".urdf", ".xacro", ".yaml", ".yml", ".zip", ".mjz")
_KEPT = "lint"
_HIDDEN = re.compile(r"\..+|__pycache__|node_modules")
_IGNORED = re.compile(r"mjcompose:\s*(ignore|ignore-file)\[([\w\s,-]+)\]")
_MODEL = re.compile(rb"<mujoco[\s>].*<(worldbody|include|attach)[\s/>]", re.DOTALL)
_RECIPE = re.compile(rb"^(recipe|extends)\s*:", re.MULTILINE)
_HEAD = 1 << 20


def files_below(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield the models in folders, and all other paths as they are.

    A folder with a manifest is a bundle. In another folder, an XML or YAML file counts if it is a model or a recipe,
    unless another XML file of the folder includes it: it is linted there.
    """
    for path in paths:
        if not path.is_dir() or (path / "manifest.json").is_file():
            yield path
            continue
        found: list[Path] = []
        for folder, folders, names in os.walk(path):
            here = Path(folder)
            bundles = [name for name in folders if (here / name / "manifest.json").is_file()]
            found += [here / name for name in bundles]
            folders[:] = sorted(each for each in folders if not _HIDDEN.fullmatch(each) and each not in bundles)
            found += [here / name for name in names if Path(name).suffix.lower() in SUFFIXES]
        included: set[str] = set()
        models: list[Path] = []
        for each in sorted(found):
            head = b"" if each.is_dir() or each.suffix.lower() in (".zip", ".mjz") else _head(each)
            if each.suffix.lower() == ".xml":
                names = re.findall(rb"""<include\s+file\s*=\s*["']([^"']+)""", head)
                included |= {os.path.normpath(each.parent / os.fsdecode(name)) for name in names}
            if (
                not head
                or each.suffix.lower() in (".urdf", ".xacro")
                or (_MODEL if each.suffix.lower() == ".xml" else _RECIPE).search(head)
            ):
                models.append(each)
        yield from (each for each in models if os.path.normpath(each) not in included)


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(_HEAD)
    except OSError:
        return b" "


@dataclass(frozen=True, slots=True)
class Linted:
    """The result for one file: its findings, without those that a comment ignores, and the number of ignored ones."""

    path: Path
    found: tuple[Diagnostic, ...]
    ignored: int = 0


def lint(path: Path, context: Context, session: Session, selected: Sequence[Rule]) -> Linted:
    """Return the findings of rules about the model of a file; errors of the model itself are reported to the context.

    `path` is an MJCF or URDF file, a recipe or a bundle. If MuJoCo refuses the model, the rules that need it are left
    out.
    """
    with ExitStack() as opened:
        unit, is_part, compiles = _model(path, context, session, opened=opened)
        if unit is None:
            return Linted(path, ())
        findings = list(
            found(Subject(unit.root, unit, is_part=is_part), [each for each in selected if not each.in_mujoco])
        )
        if compiles:
            findings += _in_mujoco(
                unit, context, session, selected=[each for each in selected if each.in_mujoco], is_part=is_part
            )
        places = {element: at for at, element in enumerate(unit.root.iter("*"))}
        findings.sort(key=lambda each: -1 if each[1].element is None else places[each[1].element])
        every = [_diagnostic(each, finding, unit) for each, finding in findings]
        kept = tuple(each for each in every if not _is_ignored(each, unit))
        return Linted(path, kept, len(every) - len(kept))


def _model(path: Path, context: Context, session: Session, opened: ExitStack) -> tuple[Unit | None, bool, bool]:
    """Return the model of a file, whether others may complete it, and whether the session keeps it compiled."""
    operand = read_operand(str(path), context, opened)
    if operand is None:
        return None, True, False
    if operand.kind is not Kind.MJCF:
        side = load(operand, _KEPT, session)
        operand.report(context.sink)
        is_part = path.suffix.lower() in (".urdf", ".xacro")
        return (None, is_part, False) if side is None or side.traced is None else (side.traced.model, is_part, True)
    unit = parse_file(path, context.sink, file=context.shown(path))
    if unit is None or not all_admitted(unit, context.sink, context.shown):
        return None, True, False
    text = write(unit.root)
    compiled = engine.compile(path.parent, path.name, text=text.decode(), keep=_KEPT, session=session)
    if not compiled.ok:
        _refused(compiled, unit, text, context=context)
    return unit, True, compiled.ok


def _refused(compiled: engine.Compiled, unit: Unit, text: bytes, context: Context) -> None:
    error, crash = compiled.error or "", compiled.crash
    if crash is not None:
        context.sink.error(CRASHES.get(crash, "mujoco-crash"), f"`{unit.file}`: {error}", Span(unit.file, 1, 1))
        return
    fault = parse(error)
    element = None if fault.line is None else element_at(unit.root, text, fault.line)
    at = Span(unit.file, 1, 1)
    report_message(translate(fault.message, element), element, unit, context=context, at=at)


def _in_mujoco(
    unit: Unit, context: Context, session: Session, selected: Sequence[Rule], is_part: bool
) -> Iterator[tuple[Rule, Finding]]:
    if not selected:
        return
    by_code = {each.code: each for each in selected}
    asked = {"text": write(unit.root).decode(), "codes": list(by_code), "is_part": is_part}
    answer = engine.call(session, in_child, [_KEPT], argument=asked)
    if not answer.ok:
        code = CRASHES.get(answer.crash or "", "mujoco-crash")
        context.sink.error(code, f"`{unit.file}`: {answer.error or answer.crash}", Span(unit.file, 1, 1))
        return
    elements = list(unit.root.iter("*"))
    for code, at, attribute, message, help, edit in answer.value:
        element = None if at is None else elements[at]
        change = None if edit is None else Edit(tuple((name, value) for name, value in edit[0]), edit[1])
        yield by_code[code], Finding(element, message, attribute, help=help, edit=change)


def _diagnostic(rule: Rule, finding: Finding, unit: Unit) -> Diagnostic:
    element, span = finding.element, Span(unit.file, 1, 1)
    if element is not None:
        span = unit.origins.span(element, unit.file, finding.attribute)
    fix = None if element is None or finding.edit is None else fix_of(element, finding.edit, unit)
    return Diagnostic(rule.code, finding.message, span, severity=Severity.WARNING, help=finding.help, fix=fix)


def fix_of(element: Node, edit: Edit, unit: Unit) -> Fix | None:
    """Return the change of the file's text, or None if the element is not written in a file as it is in the model."""
    owner, line = unit.origins.owner(element, unit.file), line_of(element)
    text = unit.origins.text(owner) if isinstance(owner, str) else None
    if text is None or line is None or element in unit.origins.settings or not isinstance(owner, str):
        return None
    tag, written = str(element.tag), {str(name): str(value) for name, value in element.items()}

    def replaced(first: Stretch, replacement: str, *, start: int, last: Stretch | None = None) -> Fix:
        last = last or first
        return Fix(replacement, None, Span(owner, first.line, start, end_line=last.line, end_column=last.end_column))

    if edit.removes:
        ends = text.whole(tag, line, written)
        return None if ends is None else replaced(ends[0], "", start=ends[0].column, last=ends[1])
    at = text.element(tag, line, written)
    if at is None:
        return None
    if not any(name in written for name, _ in edit.attributes):
        added = "".join(f' {name}="{value}"' for name, value in edit.attributes)
        return replaced(at, added, start=at.end_column)
    if len(edit.attributes) != 1:
        return None
    name, value = edit.attributes[0]
    at = text.attribute(tag, line, written, name=name)
    key = text.attribute(tag, line, written, name=name, key=True)
    if at is None or key is None or (value is None and at.line != key.line):
        return None
    if value is not None:
        return replaced(at, value, start=at.column)
    to_quote = at._replace(end_column=at.end_column + 1)
    return replaced(to_quote, "", start=max(key.column - 1, 1))


def _is_ignored(diagnostic: Diagnostic, unit: Unit) -> bool:
    """Return whether a comment on the line, in the lines of comments above it, or for the file ignores the finding."""
    if diagnostic.span is None or (text := unit.origins.text(diagnostic.span.file)) is None:
        return False
    lines = text.text.split("\n")
    for line in lines:
        if (found := _IGNORED.search(line)) and found[1] == "ignore-file" and _names(found[2], diagnostic.code):
            return True
    at = diagnostic.span.line - 1
    while 0 <= at < len(lines):
        found = _IGNORED.search(lines[at])
        if found and found[1] == "ignore" and _names(found[2], diagnostic.code):
            return True
        at -= 1
        if at < 0 or not lines[at].strip().startswith(("<!--", "#")):
            return False
    return False


def _names(codes: str, code: str) -> bool:
    return code in re.split(r"[\s,]+", codes.strip())


def lint_all(
    paths: Sequence[Path], context: Context, selected: Sequence[Rule], jobs: int, done: Callable[[Path], None]
) -> list[tuple[Linted, Context]]:
    """Lint files with `jobs` processes of MuJoCo; each result has a context with the errors of its model."""
    from concurrent.futures import ThreadPoolExecutor
    from queue import SimpleQueue

    with ExitStack() as opened:
        free: SimpleQueue[Session] = SimpleQueue()
        for _ in range(max(1, min(jobs, len(paths)))):
            free.put(opened.enter_context(Session()))

        def one(path: Path) -> tuple[Linted, Context]:
            own, session = replace(context, sink=Sink(), recipes={}, concrete={}), free.get()
            try:
                return lint(path, own, session, selected=selected), own
            finally:
                free.put(session)
                done(path)

        with ThreadPoolExecutor(jobs) as executor:
            return list(executor.map(one, paths))


def merged(found: Collection[Diagnostic]) -> Iterator[tuple[Diagnostic, Cause]]:
    """Yield findings with a common cause: the findings of a rule in a file become one block."""
    for each in found:
        yield each, Cause(f"{each.code} {each.span.file if each.span else ''}", each.message)
