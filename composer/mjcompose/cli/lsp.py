"""`mjcompose lsp`: the language server, which an editor starts."""

from __future__ import annotations

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.run import Run, command, flag

_EXTRA = ("pygls", "lsprotocol", "cattrs", "attrs", "attr")


@dataclass(frozen=True, slots=True)
class Options:
    stdio: bool = flag("--stdio", help="Use standard input and output. This is always the case; the option exists"
                       " because many editors pass it.")  # fmt: skip


@command(Options)
def lsp(options: Options, run: Run) -> None:
    """Run the language server, which gives an editor errors, completion and more while you write a recipe.

    An editor starts it and uses the Language Server Protocol over standard input and output. docs/how-to/editors.md
    has the settings for each editor. The server completes names in the models, shows the element and its origin, jumps
    to its line, renames parts, and reports the same errors as `check`. It fetches nothing and writes nothing.

    It needs the extra `lsp`: pip install "mjcompose[lsp]".
    """
    try:
        from mjcompose.lsp.server import serve
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in _EXTRA:
            raise
        raise click.UsageError(
            "The language server needs `mjcompose[lsp]`, which is not installed: there is no Python package"
            f' `{error.name}`. Run `pip install "mjcompose[lsp]"`.'
        ) from None
    serve()
