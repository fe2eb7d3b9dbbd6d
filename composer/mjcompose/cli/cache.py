"""`mjcompose cache`: look at what was fetched and built, make it smaller, see that it is whole."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

import click

from mjcompose.cli.reporting import FINDINGS, USAGE, format_options, report, reporting_options, say

if TYPE_CHECKING:
    from pathlib import Path

    from mjcompose.sources.context import Context
    from mjcompose.sources.reference import SourceError
    from mjcompose.sources.store import Store

_FIX = "run `mjcompose cache verify --fix`, which removes it; it is fetched again when it is needed"


@click.group()
def command() -> None:
    """Inspect and clean the store of fetched sources and built models.

    The environment variable MJCOMPOSE_CACHE sets its folder, MJCOMPOSE_CACHE_SIZE its maximum size.
    """


@command.command()
@format_options(("text", "json"))
def info(form: str) -> None:
    """Print the location, the size and the contents of the store."""
    from mjcompose.sources.blobs import blobs_in, mujocos_in

    store, _ = _store()
    entries = store.entries()
    built = list(blobs_in(store.folder))
    mujocos = sorted(mujocos_in(store.folder), key=lambda each: each.used, reverse=True)
    size_built = sum(blob.size for blob in built)
    size = size_built + sum(entry.size for entry in entries) + sum(each.size for each in mujocos)
    if form == "json":
        answer = [
            {
                "kind": each.kind,
                "key": each.key,
                "source": each.origin,
                "size": each.size,
                "files": len(each.files),
            }
            for each in entries
        ]
        click.echo(
            json.dumps(
                {
                    "folder": str(store.folder),
                    "size": size,
                    "limit": store.limit,
                    "entries": answer,
                    "builds": {"size": size_built, "files": len(built)},
                    "mujocos": [{"version": each.version, "size": each.size} for each in mujocos],
                }
            )
        )
        return
    click.echo(f"{store.folder}: {_bytes(size)} of at most {_bytes(store.limit)}, {_count(entries)}")
    if built:
        click.echo(f"  {_bytes(size_built):>9}  built models, {len(built)} files")
    for each in mujocos:
        click.echo(f"  {_bytes(each.size):>9}  MuJoCo {each.version}, for `migrate`")
    for entry in reversed(entries):
        click.echo(f"  {_bytes(entry.size):>9}  {entry.kind} {entry.key[:12]}  {entry.origin}")
    if unfinished := store.unfinished():
        click.echo(f"  {len(unfinished)} unfinished, being fetched now or broken off")


@command.command()
@click.option(
    "--size",
    metavar="SIZE",
    help="Keep at most this much, such as 500M or 2G. Default: the store's maximum size.",
)
@click.option("--all", "everything", is_flag=True, help="Remove everything.")
@reporting_options
def prune(size: str | None, everything: bool, form: str) -> None:
    """Remove least recently used entries, and files of killed processes.

    Without options, entries used in the last hour stay, because a build may be reading them.
    """
    from mjcompose.base.limits import parse_size
    from mjcompose.base.scratch import sweep_temporary
    from mjcompose.sources.reference import SourceError
    from mjcompose.sources.store import GRACE

    store, context = _store()
    sweep_temporary()
    limit = 0 if everything else store.limit if size is None else parse_size(size)
    if limit is None:
        raise click.UsageError(f"`{size}` is not a size: write it as 500M or 2G")
    try:
        removed = store.prune(limit, grace=GRACE if size is None and not everything else 0)
    except SourceError as error:
        _fail(error, context, form=form)
    size_removed = sum(entry.size for entry in removed)
    if form == "json":
        click.echo(json.dumps({"removed": len(removed), "size": size_removed}))
        return
    say(f"removed {_count(removed)}, {_bytes(size_removed)}")


@command.command()
@click.option(
    "--fix", is_flag=True, help="Remove damaged files. They are fetched again when they are needed."
)
@reporting_options
def verify(fix: bool, form: str) -> None:
    """Hash every file in the store again, and report damaged files.

    Damaged files of built models are always removed. They are built again when they are needed.
    """
    from mjcompose.base.diagnostic import Note
    from mjcompose.sources.blobs import blobs_in
    from mjcompose.sources.reference import SourceError

    store, context = _store()
    entries = store.entries()
    built = list(blobs_in(store.folder))
    for blob in built:
        if blob.is_damaged:
            blob.path.unlink(missing_ok=True)
            _say_removed(blob.path, form)
    for folder in (headless := store.headless(entries)):
        if fix:
            store.remove_headless(folder)
            _say_removed(folder, form)
        else:
            context.sink.error(
                "store-unusable",
                f"`{folder}` is damaged: nothing says what it is",
                help=_FIX,
            )
    for entry in entries:
        if not (damage := store.damage(entry)):
            continue
        if fix:
            try:
                store.remove(entry)
            except SourceError as error:
                _fail(error, context, form=form)
            _say_removed(entry.folder, form)
            continue
        context.sink.error(
            "store-unusable",
            f"`{entry.folder}`, from `{entry.origin}`, is damaged",
            notes=[Note(line.replace("was locked", "was stored")) for line in damage[:8]],
            help=_FIX,
        )
    report(context, form)
    if context.sink.has_errors:
        sys.exit(FINDINGS)
    looked_at = [*entries, *headless, *built]
    if form == "json":
        click.echo(json.dumps({"looked_at": len(looked_at)}))
        return
    say(f"looked at {_count(looked_at)}")


def _say_removed(path: Path, form: str) -> None:
    if form == "json":
        click.echo(json.dumps({"removed": str(path)}))
        return
    say(f"removed {path}: it was damaged")


def _store() -> tuple[Store, Context]:
    from mjcompose.sources.context import Context
    from mjcompose.sources.reference import SourceError
    from mjcompose.sources.store import Store

    context = Context()
    try:
        return Store.of(context.environment), context
    except SourceError as error:
        _fail(error, context, USAGE)


def _fail(error: SourceError, context: Context, code: int = FINDINGS, form: str = "text") -> NoReturn:
    context.sink.add(error.diagnostic)
    report(context, form)
    sys.exit(code)


def _count(entries: Sequence[object]) -> str:
    return "1 entry" if len(entries) == 1 else f"{len(entries)} entries"


def _bytes(size: float) -> str:
    for unit in ("B", "KiB", "MiB"):
        if size < 1024:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1024
    return f"{size:.1f} GiB"
