"""`mjcompose completion SHELL`: the line that enables completion, and completions from the recipe."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.shell_completion import BashComplete, CompletionItem, add_completion_class, split_arg_string

from mjcompose.base.codes import CODES
from mjcompose.base.limits import NAMES
from mjcompose.cli.run import Answer, Group, Run, argument, command
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

    from mjcompose.text.node import Node

_LINES = {
    "bash": 'eval "$(_MJCOMPOSE_COMPLETE=bash_source mjcompose)"',
    "zsh": 'eval "$(_MJCOMPOSE_COMPLETE=zsh_source mjcompose)"',
    "fish": "_MJCOMPOSE_COMPLETE=fish_source mjcompose | source",
}


class CompletionOptions(Group):
    shell: str = argument(type=click.Choice(tuple(_LINES)))


@command(
    CompletionOptions,
    help="Print the line that enables completion of commands, options, cells and names; put it in SHELL's start file.",
)
def completion(options: CompletionOptions, run: Run) -> Answer:
    return Answer(_LINES[options.shell])


Complete = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def _completing(offered: Callable[[Path, Context], Iterable[str]], listed: bool = False) -> Complete:
    """Return a completion among `offered`; with `listed`, the last item of a comma-separated list is completed."""

    def complete(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
        from mjcompose.sources.fetching import Fetching

        recipe = _recipe(ctx)
        if recipe is None:
            return []
        try:
            names = list(dict.fromkeys(offered(recipe, Context(fetching=Fetching(offline=True)))))
        except Exception:
            return []  # there is no room for a message on a line that is being typed
        before, comma, begun = incomplete.rpartition(",") if listed else ("", "", incomplete)
        fitting = (name for name in names if name.startswith(begun) and ("=" in name or not comma))
        return [CompletionItem(before + comma + name) for name in fitting]

    return complete


def _recipe(ctx: click.Context) -> Path | None:
    for name in ("recipe", "recipes", "model", "target", "a"):
        given = ctx.params.get(name)
        if given:
            return Path(given[0] if isinstance(given, tuple) else given)
    # If an option lacks its value, click does not parse the arguments.
    return Path(ctx.args[0]) if ctx.args else None


def _cells(recipe: Path, context: Context) -> Iterator[str]:
    from mjcompose.pipeline.cache.cells import cells_of
    from mjcompose.text.node import Scalar

    found = cells_of(recipe, context)
    for cell in found:
        if cell.cell is not None:
            yield cell.cell
        yield cell.name
    for cell in found:
        yield from (f"{axis}={node.text}" for axis, node in cell.given.items() if isinstance(node, Scalar))


def _samples(recipe: Path, context: Context) -> Iterator[str]:
    from mjcompose.pipeline.cache.cells import cells_of

    yield from (str(cell.sample) for cell in cells_of(recipe, context) if cell.is_sample)


def _parameters(recipe: Path, context: Context) -> Iterator[str]:
    """Yield variants and parameters, with their values if they have choices."""
    from mjcompose.text.node import Mapping, Scalar, Sequence, find

    for name, written in _entries(recipe, context, "params").items():
        is_mapping = isinstance(written, Mapping)
        choices = find(written, ("choices",)) if is_mapping else None
        default = find(written, ("default",)) if is_mapping else written
        if isinstance(choices, Sequence):
            yield from (f"{name}={each.text}" for each in choices.items if isinstance(each, Scalar))
        elif isinstance(default, Scalar) and isinstance(default.value, bool):
            yield from (f"{name}=true", f"{name}=false")
        else:
            yield f"{name}="
    for axis, pieces in _entries(recipe, context, "variants").items():
        yield from (f"{axis}={name}" for name in (pieces.entries if isinstance(pieces, Mapping) else ()))


def _entries(recipe: Path, context: Context, section: str) -> dict[str, Node]:
    from mjcompose.plan.read import read_recipe
    from mjcompose.text.node import Mapping, find

    document = read_recipe(context.folder / recipe, context)
    found = find(document, (section,)) if isinstance(document, Mapping) else None
    if not isinstance(found, Mapping):
        return {}
    return {name: node for name, (_, node) in found.entries.items()}


def _named(*tags: str) -> Callable[[Path, Context], Iterable[str]]:
    """Return a function for the names of all elements, or of the elements with a tag."""
    return lambda recipe, context: sorted(
        {name for each in _model(recipe, context) if (not tags or each.tag in tags) and (name := each.get("name"))}
    )


def _model(recipe: Path, context: Context) -> Iterator[Element]:
    from mjcompose.trace.traced import trace

    traced = trace(recipe, context)
    if traced is not None:
        yield from traced.model.root.iter()


def attributes(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Complete the attributes of the element in an `explain` query: `'geom left/pad'`, or only its name."""

    def offered(recipe: Path, context: Context) -> Iterator[str]:
        from mjcompose.tree.select import kind_of

        tag, _, name = str(ctx.params["query"]).rpartition(" ")
        for each in _model(recipe, context):
            if each.get("name") == name and tag in ("", each.tag):
                yield from kind_of(each).attributes

    return _completing(offered)(ctx, parameter, incomplete)


def files(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(incomplete, type="file")]


def models_and_codes(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    from mjcompose.lint.rule import rules

    rules()  # which adds its codes
    codes = [CompletionItem(code) for code in CODES if code.startswith(incomplete)]
    return [*codes, *files(ctx, parameter, incomplete)]


def commands(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    group = ctx.find_root().command
    assert isinstance(group, click.Group)
    return [CompletionItem(name) for name in group.list_commands(ctx) if name.startswith(incomplete)]


def limits(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(f"{name}=") for name in NAMES if name.startswith(incomplete)]


cells = _completing(_cells, listed=True)
samples, parameters, elements, keys, cameras = map(
    _completing, (_samples, _parameters, _named(), _named("key"), _named("camera"))
)


class Bash(BashComplete):
    """Completion for a bash that ends words at `=`: completes `NAME=VALUE` as a whole."""

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
    add_completion_class(Bash)
