"""`mjcompose lsp`: the language server, which an editor starts."""

from __future__ import annotations

import click

_EXTRA = ("pygls", "lsprotocol", "cattrs", "attrs", "attr")


@click.command()
@click.option("--stdio", is_flag=True, help="Talk over standard input and output, which it always does: many editors"
              " say it.")  # fmt: skip
def command(stdio: bool) -> None:
    """Serve an editor: faults, completion and more, while a recipe is being written.

    An editor starts it and talks the Language Server Protocol to it, over standard input and output; docs/editors.md
    has the settings for each. It completes the names inside the models, shows where each came from and what it is, goes
    to its line, renames parts, and says what `check` would say. Nothing is fetched and nothing is written.

    It needs the extra `lsp`: pip install "mjcompose[lsp]".
    """
    try:
        from composer.lsp.server import serve
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in _EXTRA:
            raise
        raise click.UsageError(
            "The language server needs `mjcompose[lsp]`, which is not installed: there is no Python package"
            f' `{error.name}`. Run `pip install "mjcompose[lsp]"`.'
        ) from None
    serve()
