"""Read a recipe file to its located tree, merged over the recipes that it extends."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from composer.context import Context, ReadRecipe
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import exists_note
from composer.document import load
from composer.document.characters import check_characters
from composer.document.decode import refuse_size
from composer.document.merge import merge
from composer.document.node import Mapping, Node, Scalar
from composer.expr.opening import is_template
from composer.limits import advice, in_force
from composer.plan.angle_context import SETTINGS
from composer.plan.trust import TRUST, read_trust, refuse_trust
from composer.reading.refused import Refused
from composer.reading.regular import TooLarge, read_argument, read_regular
from composer.reading.unsaved import unsaved_text
from composer.sources.error import SourceError
from composer.sources.fetching import Fetching
from composer.sources.resolve import resolve
from composer.sources.source import Source
from composer.sources.suggest import model_files, nearest

EXTENDS = "extends"
_EMPTY = "write `recipe: 1` as its first line; `mjcompose new NAME.yaml` writes a recipe to begin with"


def read_recipe(path: Path, context: Context) -> Node | None:
    """Return the tree of a recipe merged with all that it extends, or None after errors.

    Errors go to the context's sink. Each recipe is read once in a run.
    """
    fetching = context.fetching = context.fetching or Fetching()
    fetching.outer = fetching.outer or path
    known = context.recipes.get(path)
    if known is None:
        own = replace(context, sink=Sink())
        before, extended = fetching.trust, list[tuple[Source, Span]]()
        said: dict[str, Mapping] = {}
        node = _read(path, own, (), extended=extended, said=said)
        known = ReadRecipe(
            node, tuple(own.sink.diagnostics), tuple(extended), said=said, trust=fetching.trust
        )
        fetching.trust = before
        context.recipes[path] = known
    if path == fetching.outer:  # nested recipes cannot set trust
        fetching.trust = fetching.trust.with_more(known.trust)
    for diagnostic in known.found:
        context.sink.add(diagnostic)
    return known.node


def _read(
    path: Path,
    context: Context,
    chain: tuple[Path, ...],
    extended: list[tuple[Source, Span]],
    said: dict[str, Mapping],
) -> Node | None:
    before = context.sink.error_count
    text = _text(path, context)
    node = None if text is None else load(text, context.shown(path), context.sink, empty=_EMPTY)
    if (
        node is not None and text is not None and b"\\" in text
    ):  # without escapes YAML has none of them either
        check_characters(node, context.sink)
    if node is None or context.sink.error_count > before:
        return None
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
            context.sink.error("wrong-type", "what is extended is not a recipe", named.span)
        return None
    return merge(lower, upper, context.sink)


def _take_trust(node: Mapping, path: Path, context: Context, top: Path) -> None:
    """Apply the `trust` of a local recipe, if the `top` of its `extends` chain is the outermost recipe."""
    fetching = context.fetching
    if TRUST not in node.entries or fetching is None:
        return
    if (origin := fetching.around(path)) is not None:
        refuse_trust(node, origin, context.sink)
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
        sink.error(
            "wrong-type", "`extends` names another recipe", named.span, help="write `extends: ./other.yaml`"
        )
        return None
    if is_template(named.value):
        message = "`extends` is read before any parameter is known"
        help = "write the path itself; `variants` can choose between pieces of recipe"
        sink.error("expression", message, named.span, help=help)
        return None
    try:
        source = resolve(
            named.value, relative_to=path.parent, environment=context.environment, fetching=context.fetching
        )
    except SourceError as error:
        sink.add(error.at(named.span))
        return None
    if source.format != "recipe":
        sink.error(
            "source-kind", f"`{named.value}` is not a recipe, which is all that can be extended", named.span,
            help=f"start from it: `base: {named.value}`",
        )  # fmt: skip
        return None
    most = in_force().nesting
    if len(chain) > most:
        sink.error("limit-exceeded", f"more than {most} recipes extend one another", named.span,
                   help=advice("nesting"))  # fmt: skip
        return None
    real = os.path.realpath(source.path)
    if any(os.path.realpath(each) == real for each in chain):
        ring = " → ".join([*(each.name for each in chain), source.path.name])
        sink.error("source-cycle", f"recipes extend one another: {ring}", named.span,
                   help="take one of these `extends` out")  # fmt: skip
        return None
    return source


def _text(path: Path, context: Context) -> bytes | None:
    if (kept := unsaved_text(path)) is not None:
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
        context.sink.error(
            "source-kind",
            f"`{shown}` is XML and no recipe",
            Span(shown, 1, 1),
            help=f"a recipe names its models: `base: ./{path.with_suffix('.xml').name}`",
        )
        return None
    return text


def _unreadable(path: Path, shown: str, error: OSError, context: Context) -> None:
    folder = path if os.path.isdir(path) else path.parent
    recipes = [each for each in model_files(folder, 1) if each.endswith((".yaml", ".yml"))]
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
        reason = (error.strerror or str(error)).lower()
        context.sink.error("file-unreadable", f"`{shown}` cannot be read: {reason}")
