"""Read, expand and validate a recipe file with given values, and find the files that it uses.

A run does this once for each file and values: a plan, the matrix, its samples and a recipe that is nested twice request
the same. The section `trust` says which files models and fetched recipes may read on this machine. It is read first,
because other files are read by it, so it allows no expressions and no conditions.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping as AbcMapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from mjcompose.base import extensions
from mjcompose.base.access import Door
from mjcompose.base.diagnostic import DiagnosticError, Path as Place, Span
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.files import (
    MJCF_FILES,
    RECIPES,
    URDF_FILES,
    Refused,
    TooLarge,
    read_argument,
    read_regular,
    unsaved_text,
)
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import exists_note
from mjcompose.base.words import number_text
from mjcompose.language.check import KINDS, SEVERITY
from mjcompose.language.datasheets import SHEETS, library
from mjcompose.language.edit import VERBS, Edit
from mjcompose.language.expand import Concrete, expand
from mjcompose.language.recipe import Recipe
from mjcompose.language.validate import validate_what_remains
from mjcompose.language.value import RecipeElement
from mjcompose.plan.plan import Plan
from mjcompose.plan.steps import SETTINGS, AddElement, AppendElement
from mjcompose.sources import ros
from mjcompose.sources.context import Context, ReadRecipe
from mjcompose.sources.fetching import Fetching, model_files, nearest
from mjcompose.sources.kinds import EXTENDED
from mjcompose.sources.lock import resolve as resolve_sources
from mjcompose.sources.reference import CompilerSettings, Origin, Source, SourceError, Trust
from mjcompose.text.load import load, refuse_size
from mjcompose.text.merge import merge
from mjcompose.text.node import (
    Mapping,
    Node,
    Scalar,
    Sequence,
    check_characters,
    find,
    is_template,
    locate,
    resolve,
    to_python,
)
from mjcompose.tree.files import CUBE, file_attributes, join, written_path
from mjcompose.tree.parse import Assumed, model_of_mesh, parse_file, parse_text
from mjcompose.tree.unit import Unit
from mjcompose.urdf.robot import SCHEMES
from mjcompose.urdf.xacro import files_named, is_template as is_template_urdf

if TYPE_CHECKING:
    from mjcompose.plan.measured import Measurements, Replaced

Given = AbcMapping[str, Node]
"""Values of parameters and variants by name, each with the place that sets it."""

Result = TypeVar("Result")
_KEPT = 256
"""The most results that a run keeps: a matrix may have many more cells."""


class ValidRecipe(NamedTuple):
    """A recipe without faulty pieces, whose names are `lost`, its tree, and its expansion, None for no mapping.

    `measured` is the file of measurements that it uses, whose numbers are among its edits; `written` is the tree
    without them.
    """

    recipe: Recipe
    document: Mapping
    concrete: Concrete | None
    lost: frozenset[str]
    measured: Measurements | None = None
    written: Mapping | None = None


def expanded_recipe(path: Path, given: Given, context: Context) -> Concrete | None:
    """Return the concrete recipe, or None if it is not a mapping. The context reports errors on each call."""

    def work(own: Context) -> Concrete | None:
        node = read_recipe(path, own)
        return expand(node, given, own.sink) if isinstance(node, Mapping) else None

    return _once(("expanded", path, _values(given)), context, work)


def validated_recipe(path: Path, given: Given, context: Context) -> ValidRecipe | None:
    """Return the valid recipe, or None if the file is unreadable. The context reports errors on each call."""

    def work(own: Context) -> ValidRecipe | None:
        concrete = expanded_recipe(path, given, own)
        node = read_recipe(path, replace(own, sink=Sink())) if concrete is None else concrete.document
        gone, lost = (frozenset(), frozenset()) if concrete is None else (concrete.gone, concrete.lost)
        valid = None if node is None else validate_what_remains(node, own.sink, gone)
        if valid is None:
            return None
        read = ValidRecipe(valid.recipe, valid.document, concrete, lost=valid.lost | lost)
        return read if valid.recipe.measured is None or own.as_designed else _with_measurements(read, own)

    return _once(("validated", path, _values(given)), context, work)


def _with_measurements(read: ValidRecipe, context: Context) -> ValidRecipe | None:
    """Return the recipe with the measured numbers among its edits; without them after reported errors."""
    from mjcompose.plan.measured import read_measurements, with_edits  # few recipes have them

    span = locate(read.document, ("measured",))
    found = read_measurements(read.recipe.measured, read.document, folder_of(span, context), context)
    if found is None:
        return read
    valid = validate_what_remains(with_edits(read.document, found), context.sink)
    if valid is None:
        return None
    return read._replace(
        recipe=valid.recipe,
        document=valid.document,
        lost=read.lost | valid.lost,
        measured=found,
        written=read.document,
    )


def with_replaced_numbers(read: ValidRecipe, replaced: Replaced, sink: Sink) -> ValidRecipe | None:
    """Return a recipe with other numbers instead of those in its file of measurements."""
    from mjcompose.plan.measured import with_edits

    assert read.written is not None and read.measured is not None
    valid = validate_what_remains(with_edits(read.written, read.measured, replaced), sink)
    return None if valid is None else read._replace(recipe=valid.recipe, document=valid.document)


def _values(given: Given) -> tuple[tuple[str, str], ...]:
    return tuple(sorted((name, repr(node)) for name, node in given.items()))


def _once(key: tuple[object, ...], context: Context, work: Callable[[Context], Result]) -> Result:
    """Return the result of the work, computed only if it is not kept; the context reports its diagnostics."""
    known = context.concrete.pop(key, None)
    if known is None:
        own = replace(context, sink=Sink())
        known = work(own), tuple(own.sink.diagnostics)
        while len(context.concrete) >= _KEPT:
            del context.concrete[next(iter(context.concrete))]
    context.concrete[key] = known
    context.sink.extend(known[1])
    value: Result = known[0]
    return value


_COLUMN = 60


def expanded_text(plan: Plan) -> str:
    """Return YAML, each line with the file and line of its value, and its turn of a `for`, as a comment."""
    read = [
        f"# in {file}: angle: {each.angle or 'none'}, eulerseq: {each.eulerseq}"
        for file, each in plan.angle_context.others.items()
    ]
    lines = _lines(plan.document, "")
    written = [f"{text:<{_COLUMN}}  # {span.file}:{span.line}{span.origin}" for text, span in lines]
    return "\n".join([*read, *written])


def _lines(node: Mapping, indent: str) -> Iterator[tuple[str, Span]]:
    for name, (key, value) in node.entries.items():
        yield from _entry(f"{indent}{_scalar_text(name)}:", value, indent + "  ", span=key.span)


def _entry(start: str, value: Node, indent: str, span: Span) -> Iterator[tuple[str, Span]]:
    if isinstance(value, Scalar) or _is_short(value):
        yield f"{start} {_flow(value)}", value.span
    elif isinstance(value, Mapping):
        yield start, span
        yield from _lines(value, indent)
    else:
        yield start, span
        for item in value.items:
            if isinstance(item, Mapping) and not _is_short(item):
                (first, place), *rest = list(_lines(item, indent + "  "))
                yield f"{indent}- {first.lstrip()}", place
                yield from rest
            else:
                yield f"{indent}- {_flow(item)}", item.span


def _is_short(node: Node) -> bool:
    """Return whether a node contains only values from one line of one file, and from one turn of a `for`."""
    if isinstance(node, Scalar):
        return True
    inside = list(node.items) if isinstance(node, Sequence) else [value for _, value in node.entries.values()]
    places = {(each.span.file, each.span.line) for each in inside}
    turns = {each.span.turn for each in inside if each.span.turn}
    alike = len(places) <= 1 and len(turns) <= 1
    return alike and all(isinstance(each, Scalar) or _is_short(each) for each in inside)


def _flow(node: Node) -> str:
    if isinstance(node, Sequence):
        return f"[{', '.join(_flow(item) for item in node.items)}]"
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{_scalar_text(name)}: {_flow(value)}' for name, (_, value) in node.entries.items())}}}"
    if isinstance(node.value, str):
        return _scalar_text(node.value)
    if node.value is None or isinstance(node.value, bool):
        return "null" if node.value is None else str(node.value).lower()
    return number_text(node.value)


def _scalar_text(text: str) -> str:
    plain = text and text == text.strip() and not set(text) & set("{}[],&*#?|<>=!%@`\"'\n\t\\") and text[0] not in "-:"
    if plain and ": " not in text and not text.endswith(":") and isinstance(resolve(text), str):
        return text
    return json.dumps(text, ensure_ascii=False)


EXTENDS = "extends"
_EMPTY = "write `recipe: 1` as its first line; `mjcompose new NAME.yaml` writes a recipe to begin with"


def read_recipe(path: Path, context: Context) -> Node | None:
    """Return the tree of a recipe merged with everything that it extends, read once in a run, or None after errors."""
    fetching = context.fetching = context.fetching or Fetching()
    fetching.outer = fetching.outer or path
    known = context.recipes.get(path)
    if known is None:
        own = replace(context, sink=Sink())
        before = fetching.trust
        extended: list[tuple[Source, Span]] = []
        said: dict[str, Mapping] = {}
        node = _read(path, own, (), extended=extended, said=said)
        known = ReadRecipe(node, tuple(own.sink.diagnostics), tuple(extended), said=said, trust=fetching.trust)
        fetching.trust = before
        context.recipes[path] = known
    if path == fetching.outer:  # nested recipes cannot set trust
        fetching.trust = fetching.trust.with_more(known.trust)
    context.sink.extend(known.found)
    return known.node


def _read(
    path: Path, context: Context, chain: tuple[Path, ...], extended: list[tuple[Source, Span]], said: dict[str, Mapping]
) -> Node | None:
    node = _read_alone(path, context)
    if not isinstance(node, Mapping):
        return node
    _take_trust(node, path, context, top=chain[0] if chain else path)
    settings = {name: node.entries[name] for name in SETTINGS if name in node.entries}
    said[context.shown(path)] = Mapping(settings, node.span)
    if EXTENDS not in node.entries:
        return node
    _, named = node.entries[EXTENDS]
    upper = Mapping({name: entry for name, entry in node.entries.items() if name != EXTENDS}, node.span)
    source = _extended(named, path, context, chain=(*chain, path))
    if source is None:
        return None
    extended.append((source, named.span))
    lower = _read(source.path, context, (*chain, path), extended=extended, said=said)
    if not isinstance(lower, Mapping):
        if lower is not None:
            context.sink.error("wrong-type", "`extends` names a file that is not a recipe", named.span)
        return None
    return merge(lower, upper, context.sink)


def _read_alone(path: Path, context: Context) -> Node | None:
    """Return the root of one file, or None after an error. The packages that it names are loaded."""
    before = context.sink.error_count
    text = _text(path, context)
    node = None if text is None else load(text, context.shown(path), context.sink, empty=_EMPTY)
    if text is None or node is None:
        return None
    if b"\\" in text:  # without escapes YAML has no odd characters
        check_characters(node, context.sink)
    if isinstance(node, Mapping) and (b"check" in text or b"edit" in text):
        _load_extensions(node, context.fetching.around(path) if context.fetching else None, context.sink)
    return None if context.sink.error_count > before else node


def _take_trust(node: Mapping, path: Path, context: Context, top: Path) -> None:
    """Apply the `trust` of a local recipe, if the `top` of its `extends` chain is the outermost recipe."""
    fetching = context.fetching
    if TRUST not in node.entries or fetching is None:
        return
    origin = fetching.around(path)
    if origin is not None:  # it cannot grant trust to itself
        message = f"`{TRUST}` in a recipe of `{origin.id}` has no effect: only your own recipe can grant trust"
        help = f"write what you trust in your own recipe, and remove this `{TRUST}`"
        context.sink.error("source-outside", message, node.entries[TRUST][0].span, help=help)
        return
    trust = read_trust(node, path.parent, context.sink)
    if top == fetching.outer:
        fetching.trust = fetching.trust.with_more(trust)


def folder_of(span: Span, context: Context) -> Path:
    """Return the folder that a path written at a place is relative to."""
    return (context.folder / span.file).parent


def _extended(named: Node, path: Path, context: Context, chain: tuple[Path, ...]) -> Source | None:
    sink = context.sink
    if not isinstance(named, Scalar) or not isinstance(named.value, str):
        sink.error("wrong-type", "`extends` names another recipe", named.span, help="write `extends: ./other.yaml`")
        return None
    if is_template(named.value):
        help = "write the path itself; `variants` can choose between pieces of recipe"
        sink.error("expression", "`extends` is read before any parameter is known", named.span, help=help)
        return None
    try:
        source = resolve_sources(
            named.value,
            relative_to=path.parent,
            environment=context.environment,
            fetching=context.fetching,
            runs_code=not context.attaching,
        )
    except SourceError as error:
        sink.add(error.at(named.span))
        return None
    if source.format != "recipe":
        message = f"`extends` names `{named.value}`, which is not a recipe"
        sink.error("source-kind", message, named.span, help=f"start from it: `base: {named.value}`")
        return None
    most = in_force().nesting
    real = os.path.realpath(source.path)
    if len(chain) > most:
        sink.error("limit-exceeded", f"more than {most} recipes extend one another", named.span, help=advice("nesting"))
        return None
    if any(os.path.realpath(each) == real for each in chain):
        message = f"recipes extend one another: {' → '.join([*(each.name for each in chain), source.path.name])}"
        sink.error("source-cycle", message, named.span, help="remove one of these `extends`")
        return None
    return source


def _text(path: Path, context: Context) -> bytes | None:
    kept = unsaved_text(path)
    if kept is not None:
        return kept
    shown = context.shown(path)
    try:
        is_argument = context.fetching is not None and path == context.fetching.outer
        text = (read_argument if is_argument else read_regular)(path, in_force().recipe_size)
    except Refused as error:
        context.sink.error("file-unreadable", f"`{shown}` {error.why}", help="name a file")
        return None
    except TooLarge:
        refuse_size(shown, context.sink)
        return None
    except OSError as error:
        _unreadable(path, shown, error, context=context)
        return None
    if text.lstrip().startswith(b"<"):
        model = path.name if path.suffix in (*MJCF_FILES, *URDF_FILES) else path.with_suffix(".xml").name
        help = f"write a recipe that names it, `base: ./{model}`; `mjcompose import` writes one"
        context.sink.error("source-kind", f"`{shown}` is a model, not a recipe", Span(shown, 1, 1), help=help)
        return None
    return text


def _unreadable(path: Path, shown: str, error: OSError, context: Context) -> None:
    folder = path if os.path.isdir(path) else path.parent
    recipes = [each for each in model_files(folder, 1) if each.endswith(RECIPES)]
    if os.path.isdir(path):
        notes = [exists_note("recipe", recipes)]
        help: str | None = "name a file in it; `mjcompose new` writes a recipe to begin with"
        if len(recipes) == 1:
            help = f"did you mean `{context.shown(folder / recipes[0])}`?"
        context.sink.error("file-unreadable", f"`{shown}` is a folder, not a recipe", notes=notes, help=help)
    elif isinstance(error, FileNotFoundError):
        near = nearest(path.name, recipes)
        help = f"did you mean `{context.shown(folder / near)}`?" if near else None
        if not recipes:
            help = f"`mjcompose new {shown}` writes a recipe to begin with"
        notes = [exists_note("recipe", recipes)] if recipes else []
        context.sink.error("file-not-found", f"the recipe `{shown}` does not exist", notes=notes, help=help)
    else:
        context.sink.error("file-unreadable", f"`{shown}` cannot be read: {(error.strerror or str(error)).lower()}")


TRUST = "trust"
FILES = "files"


def read_trust(node: Mapping, folder: Path, sink: Sink) -> Trust:
    """Return the section of a recipe in `folder`; faulty entries are reported, and then nothing is allowed."""
    from mjcompose.language.variation import TrustKeys, read  # few recipes have it

    written = to_python(node.entries[TRUST][1])
    keys: TrustKeys | None = read(TrustKeys, written, node, at=(TRUST,), sink=sink)
    texts = written.get(FILES) if isinstance(written, dict) else None
    files = []
    for index, text in enumerate(texts if isinstance(texts, list) else ()):
        if not isinstance(text, str) or not text or is_template(text):
            continue  # which is reported
        if os.path.isdir(folder / text):
            files.append(Path(os.path.realpath(folder / text)))
        else:
            help = "`~` is not expanded: write the whole path" if text.startswith("~") else None
            span = locate(node, (TRUST, FILES, index))
            sink.error("file-not-found", f"the folder `{text}` of `{TRUST}.{FILES}` does not exist", span, help=help)
    return Trust() if keys is None else Trust(tuple(files), keys.references)


_MESH = re.compile(r"""\bfilename\s*=\s*["']([^"']+)["']""")
_FILE = re.compile(r"""\bfile\w*\s*=\s*["']([^"']+)["']""")


def assumed_of(source: Source, span: Span | None = None) -> Assumed:
    """Return the settings that a recipe gives for the file of a source, which it names at `span`."""
    return _assumed(source.compiler, span or Span(str(source.path), 1, 1))


def read_source(source: Source, sink: Sink, *, file: str | None = None, span: Span | None = None) -> Unit | None:
    """Return the unit of a source of MJCF or of a mesh, or None after errors, which go to `sink`.

    `file` is its name in messages, and `span` is the place where it is requested.
    """
    if source.format != "mesh":
        assumed = assumed_of(source, span)
        return parse_file(source.path, sink, file=file, span=span, door=source.door, assumed=assumed)
    path = source.path
    shown = file or str(path)
    unit = parse_text(model_of_mesh(path), sink, file=shown, directory=path.parent, label=path.stem, door=source.door)
    if unit is not None:
        unit.origins.own(unit.root, Span(shown, 1, 1))
    return unit


def _assumed(settings: CompilerSettings, at: Span) -> Assumed:
    return [(name, value, at) for name, value in settings]


def files_of_source(source: Source) -> Iterator[Path]:
    """Yield the files of a model that exist and that it may read; others are reported where they are read."""
    if source.format == "mesh":
        files: Iterable[Path] = [source.path]
    elif source.format == "urdf":
        files = _of_urdf(source)
    else:
        files = _of_mjcf(source.path, source.door, set(), source.compiler)
    yield from filter(os.path.isfile, [*filter(source.door.sees, files), *source.licenses])


def files_of_recipe(plan: Plan, context: Context) -> Iterator[Path]:
    """Yield the files that a recipe itself names in its elements and may name."""
    folder = context.folder
    if plan.measured is not None:
        yield plan.measured.path
    for check in plan.checks:
        beside = folder_of(locate(plan.document, check.at), context)
        yield from (beside / name for name in check.files if context.door_of_text(beside).sees(beside / name))
    for step in plan.steps:
        if isinstance(step, AddElement | AppendElement):
            for at, name in _named(step.element):
                beside = folder / locate(plan.document, at).file  # this recipe, or one that it extends
                path = Path(join(str(beside.parent), name))
                if context.door_of_text(beside.parent).sees(path) and os.path.isfile(path):
                    yield path


def _named(element: RecipeElement) -> Iterator[tuple[Place, str]]:
    if element.xml is not None:
        yield from (((*element.at, "xml"), name) for name in _FILE.findall(element.xml))
    for attribute in ("file", *CUBE):
        value = element.attributes.get(attribute)
        if isinstance(value, str):
            yield (*element.at, attribute), value
    for child in element.children:
        yield from _named(child)


def _of_mjcf(path: Path, door: Door, seen: set[Path], settings: CompilerSettings = ()) -> Iterator[Path]:
    if path in seen:
        return
    seen.add(path)
    yield path
    assumed = _assumed(settings, Span(str(path), 1, 1))
    unit = parse_file(path, Sink(), door=door, assumed=assumed) if door.sees(path) else None
    if unit is None:
        return
    yield from map(Path, unit.origins.texts)  # the included files too
    for element, _, name in file_attributes(unit.root):
        yield Path(join(str(unit.directory), written_path(unit.settings, element, name)))
    for model in unit.root.iterfind("asset/model"):
        inner = model.get("file")
        if inner:
            yield from _of_mjcf(Path(join(str(unit.directory), inner)), door, seen)


def _of_urdf(source: Source) -> Iterator[Path]:
    yield source.path
    try:
        text = source.door.read(source.path).decode("utf-8", "replace")
    except OSError:
        return
    given = dict(source.packages)
    if is_template_urdf(source.path, text.encode()):
        yield from files_named(source.path, text.encode(), source.door, packages=ros.all_folders(source.path, given))
        return
    packages = ros.folders(ros.packages_in(text), source.path, given)
    for name in _MESH.findall(text):
        scheme = next((each for each in SCHEMES if name.startswith(each)), "")
        package, _, inside = name.removeprefix(scheme).partition("/")
        if scheme:
            if package in packages:
                yield packages[package] / inside
        else:
            name = name.removeprefix("file://")
            yield source.path.parent / name
            yield source.path.parent / Path(name).name


_TABLES: dict[str, ExtensionTable[Any]] = {"checks": KINDS, "verbs": VERBS, "datasheets": SHEETS}
_OURS = {"checks": {*KINDS.own, SEVERITY, "when", "for"}, "verbs": {*Edit.key_names()}}


def _load_extensions(node: Mapping, origin: Origin | None, sink: Sink) -> None:
    """Load the extensions for the words of one file. They are errors if the file was fetched with `origin`."""
    for group, word, span in _foreign(node):
        try:
            if origin is not None and origin.is_fetched:
                if extensions.is_registered(group, word):
                    raise extensions.refuse(group, word, origin.id)
            elif word not in (table := _TABLES[group]) and extensions.is_registered(group, word):
                table[word]
        except DiagnosticError as error:
            sink.add(error.at(span))


def load_all() -> list[DiagnosticError]:
    """Load the extensions of all installed packages, for editors; return the failures."""
    return [error for table in [*_TABLES.values(), EXTENDED] for error in table.load_all()]


def packages_of(plan: Plan) -> dict[str, str]:
    """Return the packages whose code the recipes of a plan name, with their versions."""
    if not extensions.LOADED:
        return {}
    words = [(group, word) for each in plan.plans() for group, word, _ in _foreign(each.document)]
    words += [("sources", source.kind.name) for source in plan.sources()]
    words += [("sources", source.origin.kind.name) for source in plan.sources() if source.origin is not None]
    return extensions.versions(words)


def _foreign(node: Node) -> Iterator[tuple[str, str, Span]]:
    """Yield each word that may belong to another package, with its group and its place."""
    waiting: list[Node] = [node]
    while waiting:
        each = waiting.pop()
        if isinstance(each, Sequence):
            waiting += each.items
        if not isinstance(each, Mapping):
            continue
        for name, (_, value) in each.entries.items():
            if name == "check" and isinstance(value, Mapping):
                for _, check in value.entries.values():
                    yield from _foreign_words("checks", check)
            elif name == "edit" and isinstance(value, Sequence):
                for entry in value.items:
                    yield from _foreign_words("verbs", entry)
                    sheet = find(entry, ("datasheet", "model"))
                    if isinstance(sheet, Scalar) and sheet.text not in library():
                        yield "datasheets", sheet.text, sheet.span
            waiting.append(value)


def _foreign_words(group: str, node: Node) -> Iterator[tuple[str, str, Span]]:
    if isinstance(node, Mapping):
        yield from ((group, word, key.span) for word, (key, _) in node.entries.items() if word not in _OURS[group])
