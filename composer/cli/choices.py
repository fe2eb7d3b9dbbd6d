"""Options that select among the builds of a recipe: parameters, variants, cells of the matrix."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from composer.cli import completing
from composer.dataclass import dataclass

if TYPE_CHECKING:
    from composer.context import Context
    from composer.document import Node


@dataclass(frozen=True, slots=True)
class Choices:
    """The values of `--set`, `--set-file` and `--variant`."""

    sets: tuple[str, ...] = ()
    set_files: tuple[Path, ...] = ()
    variants: tuple[str, ...] = ()
    _read: dict[Path, bytes] = field(default_factory=dict, compare=False, repr=False)

    def values(self, context: Context) -> dict[str, Node]:
        """Return the values by name, with options overriding files; errors go to the context's sink."""
        found: dict[str, Node] = {}
        if not (self.sets or self.set_files or self.variants):
            return found  # without importing anything
        from composer.diagnostics.span import Span
        from composer.document import Mapping, Scalar, load

        for file in self.set_files:
            shown = context.shown(file)
            try:
                text = self._text(file, context)
            except OSError as error:
                reason = (error.strerror or str(error)).lower()
                context.sink.error("file-unreadable", f"`{shown}` cannot be read: {reason}")
                continue
            node = load(text, shown, context.sink)
            if isinstance(node, Mapping):
                found.update({name: value for name, (_, value) in node.entries.items()})
            elif node is not None:
                context.sink.error(
                    "wrong-type", "a file of values is a mapping from names to values", node.span
                )
        for option, written in [("--set", each) for each in self.sets] + [
            ("--variant", each) for each in self.variants
        ]:
            name, equals, text_of_value = written.partition("=")
            if not equals or not name:
                context.sink.error("wrong-type", f"`{option} {written}` is not NAME=VALUE",
                                   help=f"write for instance `{option} {name or 'reach'}=0.5`")  # fmt: skip
                continue
            span = Span(f"{option} {name}", 1, 1)
            if option == "--variant" or not text_of_value:
                found[name] = Scalar(text_of_value, span, text_of_value, plain=False)
            elif (value := load(text_of_value, span.file, context.sink)) is not None:
                found[name] = value
        return found

    def _text(self, file: Path, context: Context) -> bytes:
        """Return the bytes of a file, which is read once: it may be a pipe. Raises OSError."""
        if file not in self._read:
            from composer.limits import in_force
            from composer.reading.regular import read_argument

            self._read[file] = read_argument(context.folder / file, in_force().recipe_size)
        return self._read[file]

    def named(self, context: Context) -> dict[str, str]:
        """Return the values as text, by their names for the user, for comparison in the build cache.

        Nothing is validated.
        """
        from composer.cache.reasons import content_of, name_of

        found: dict[str, str] = {}
        for file in self.set_files:
            content = "unreadable"
            with contextlib.suppress(OSError):
                content = content_of(self._text(file, context))
            found[name_of(file)] = content
        if len(self.set_files) > 1:  # a value of a later file counts
            found["the order of `--set-file`"] = ", ".join(map(str, self.set_files))
        for what, written in [
            *(("", each) for each in self.sets),
            *(("variant ", each) for each in self.variants),
        ]:
            name, equals, value = written.partition("=")
            found[f"{what}`{name}`"] = value if equals else "nothing"
        return found


def choice_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--set`, `--set-file` and `--variant`; the command gets them as `choices`."""

    @functools.wraps(command)
    def choosing(
        *args: Any, sets: tuple[str, ...], set_files: tuple[Path, ...], variants: tuple[str, ...], **rest: Any
    ) -> Any:
        return command(*args, choices=Choices(sets, set_files, variants), **rest)

    for option in reversed((
        click.option("--set", "sets", multiple=True, metavar="NAME=VALUE", help="Set the value of a parameter.",
                     shell_complete=completing.parameters),
        click.option("--set-file", "set_files", multiple=True, type=click.Path(path_type=Path), metavar="FILE",
                     help="Read the values of parameters and variants from this YAML file."),
        click.option("--variant", "variants", multiple=True, metavar="AXIS=VALUE",
                     help="Select the value of a variant.",
                     shell_complete=completing.variants),
    )):  # fmt: skip
        choosing = option(choosing)
    return choosing
