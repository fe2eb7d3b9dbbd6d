"""What a shell may offer that only the recipe on the line knows: cells, parameters, variants, names of elements."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.shell_completion import BashComplete, CompletionItem, add_completion_class, split_arg_string

if TYPE_CHECKING:
    from composer.context import Context
    from composer.document.node import Node

Complete = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def _completing(offered: Callable[[Path, Context], Iterable[str]]) -> Complete:
    """What of `offered` begins as the word does; nothing where the recipe cannot be read, whatever the reason."""

    def complete(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
        from composer.context import Context
        from composer.sources.fetching import Fetching

        recipe = _recipe(ctx)
        if recipe is None:
            return []
        try:
            names = list(dict.fromkeys(offered(recipe, Context(fetching=Fetching(offline=True)))))
        except Exception:
            return []  # a line that is being typed is no place for a message
        return [CompletionItem(name) for name in names if name.startswith(incomplete)]

    return complete


def _recipe(ctx: click.Context) -> Path | None:
    """The recipe that stands on the line already."""
    for name in ("recipe", "recipes", "model", "a"):
        if given := ctx.params.get(name):
            return Path(given[0] if isinstance(given, tuple) else given)
    # Before an option without its value click leaves all arguments as they stand.
    return Path(ctx.args[0]) if ctx.args else None


def _cells(recipe: Path, context: Context) -> Iterator[str]:
    from composer.cache.cells import cells_of

    for cell in cells_of(recipe, context):
        if cell.cell is not None:
            yield cell.cell
        yield cell.name


def _parameters(recipe: Path, context: Context) -> Iterator[str]:
    yield from (f"{name}=" for name in _entries(recipe, context, "params"))


def _variants(recipe: Path, context: Context) -> Iterator[str]:
    from composer.document.node import Mapping

    for axis, pieces in _entries(recipe, context, "variants").items():
        yield from (f"{axis}={name}" for name in (pieces.entries if isinstance(pieces, Mapping) else ()))


def _entries(recipe: Path, context: Context, section: str) -> dict[str, Node]:
    from composer.document.node import Mapping, find
    from composer.plan.read import read_recipe

    document = read_recipe(context.folder / recipe, context)
    found = find(document, (section,)) if isinstance(document, Mapping) else None
    if not isinstance(found, Mapping):
        return {}
    return {name: node for name, (_, node) in found.entries.items()}


def _elements(recipe: Path, context: Context) -> Iterator[str]:
    from composer.explain.explain import trace

    traced = trace(recipe, context)
    if traced is not None:
        yield from sorted({name for each in traced.model.root.iter() if (name := each.get("name"))})


cells, parameters, variants, elements = map(_completing, (_cells, _parameters, _variants, _elements))


class Bash(BashComplete):
    """Completion for a bash that takes `=` for the end of a word, so that `NAME=VALUE` is seen whole."""

    source_template = BashComplete.source_template.replace(
        "COMP_CWORD=$COMP_CWORD", 'COMP_CWORD=$COMP_CWORD COMP_LINE="$COMP_LINE" COMP_POINT=$COMP_POINT'
    ).replace(
        "    return 0\n",
        "    [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace\n    return 0\n",
    )

    def get_completion_args(self) -> tuple[list[str], str]:
        line = os.environ["COMP_LINE"].encode()[: int(os.environ["COMP_POINT"])].decode("utf-8", "replace")
        words = split_arg_string(line)
        if not words or line[-1:].isspace():
            words.append("")
        self._broken = words[-1].rpartition("=")[0]
        return words[1:-1], words[-1]

    def format_completion(self, item: CompletionItem) -> str:
        value = item.value.removeprefix(f"{self._broken}=") if self._broken else item.value
        return f"{item.type},{value}"


def install() -> None:
    """Have click use these for the shells that need them."""
    add_completion_class(Bash)
