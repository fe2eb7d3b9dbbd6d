"""`mjcompose explain CODE`: the page of a code, and the list of codes."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import click

from composer.cli.reporting import use_color
from composer.diagnostics.codes import CODES
from composer.diagnostics.page import address, code_of, in_terminal, page
from composer.diagnostics.suggest import closest

_WIDEST = 100


def say_page(asked: Path, form: str) -> None:
    """Print the page of a code. Raises UsageError if it is not a code."""
    code = code_of(str(asked))
    if code is None:
        raise click.UsageError(_no_code(asked))
    text, url = page(code), address(code)
    if form == "json":
        data = {"explains": "code", "code": code, "summary": CODES[code], "page": text, "url": url}
        click.echo(json.dumps(data, indent=2, ensure_ascii=False))
        return
    color = use_color(out=True)
    width = min(shutil.get_terminal_size((_WIDEST, 24)).columns, _WIDEST)
    click.echo(in_terminal(text, width, color), color=color)
    if url is not None:
        click.echo(f"\n{url}")


def say_codes(form: str) -> None:
    """Print every code with its summary."""
    if form == "json":
        click.echo(json.dumps(CODES, indent=2))
        return
    width = max(map(len, CODES))
    for code, summary in CODES.items():
        click.echo(f"{code:{width}}  {summary}")


def check_model(model: Path) -> None:
    """Raise UsageError for a code in place of a model: no other arguments apply to a code."""
    if code_of(str(model)) is not None and not os.path.exists(model):
        raise click.UsageError(
            f"`{model}` is a code, not a model. Write `mjcompose explain {code_of(str(model))}` alone."
        )


def _no_code(asked: Path) -> str:
    if os.path.exists(asked) or asked.suffix or len(asked.parts) > 1:
        return (
            "Missing argument 'QUERY'. Say which element:"
            f" `mjcompose explain {asked} 'joint NAME'`. `mjcompose tree {asked}` lists them."
        )
    near = closest(str(asked), CODES)
    help = f"Did you mean `{near[0]}`?" if near else "`mjcompose explain --codes` lists them."
    return f"`{asked}` is neither a code nor a file that exists. {help}"
