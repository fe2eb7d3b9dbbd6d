"""`cache` and `lock`: the store of fetched sources and built models, and the lock file of a recipe."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.diagnostic import Note
from mjcompose.base.limits import parse_size
from mjcompose.base.report import as_lines, json_text
from mjcompose.base.scratch import sweep_temporary
from mjcompose.base.words import counted
from mjcompose.cli.options import RECIPE, RecipeOptions, ReportOptions, formats
from mjcompose.cli.reporting import FINDINGS, USAGE, say
from mjcompose.cli.run import Answer, Group, Run, Stop, command, flag, group, option
from mjcompose.sources.blobs import blobs_in

if TYPE_CHECKING:
    from mjcompose.sources.store import Store


_FIX = "run `mjcompose cache verify --fix`, which removes it; the next command that needs it fetches it again"


@click.group(
    help="""Inspect and clean the store of fetched sources and built models.

    The environment variable MJCOMPOSE_CACHE sets its folder, MJCOMPOSE_CACHE_SIZE its maximum size.
    """
)
def cache() -> None:
    pass


class InfoOptions(Group):
    form: str = formats("text", "json")


@command(InfoOptions, within=cache, help="Print the location, the size and the contents of the store.")
def info(options: InfoOptions, run: Run) -> Answer:
    store = _store(run)
    entries = store.entries()
    built = list(blobs_in(store.folder))
    size_built = sum(blob.size for blob in built)
    size = size_built + sum(entry.size for entry in entries)

    def lines() -> Iterator[str]:
        yield f"{store.folder}: {_bytes(size)} of at most {_bytes(store.limit)}, {_count(entries)}"
        if built:
            yield f"  {_bytes(size_built):>9}  built models, {len(built)} files"
        for entry in reversed(entries):
            yield f"  {_bytes(entry.size):>9}  {entry.kind} {entry.key[:12]}  {entry.origin}"
        unfinished = store.unfinished()
        if unfinished:
            yield f"  {len(unfinished)} unfinished, being fetched now or interrupted"

    rows = [
        {"kind": each.kind, "key": each.key, "source": each.origin, "size": each.size, "files": len(each.files)}
        for each in entries
    ]
    data = {
        "folder": str(store.folder),
        "size": size,
        "limit": store.limit,
        "entries": rows,
        "builds": {"size": size_built, "files": len(built)},
    }
    return Answer(lambda: as_lines(lines()), data, is_outcome=True)


class PruneOptions(Group):
    size: str | None = option(
        "--size", metavar="SIZE", help="Keep at most this much, such as 500M or 2G. Default: the store's maximum size."
    )
    everything: bool = flag("--all", help="Remove everything.")
    reporting: ReportOptions = group(ReportOptions)


@command(
    PruneOptions,
    within=cache,
    help="""Remove least recently used entries, and files of killed processes.

    Without options, entries used in the last hour stay, because a build may be reading them.
    """,
)
def prune(options: PruneOptions, run: Run) -> Answer:
    from mjcompose.sources.store import GRACE

    store = _store(run)
    size = options.size
    everything = options.everything
    sweep_temporary()
    limit = 0 if everything else store.limit if size is None else parse_size(size)
    if limit is None:
        raise click.UsageError(f"`{size}` is not a size: write it as 500M or 2G")
    with run.stopping(FINDINGS):
        removed = store.prune(limit, grace=GRACE if size is None and not everything else 0)
    size_removed = sum(entry.size for entry in removed)
    words = f"removed {_count(removed)}, {_bytes(size_removed)}"
    return Answer(words, {"removed": len(removed), "size": size_removed}, is_outcome=True)


class CacheVerifyOptions(Group):
    fix: bool = flag("--fix", help="Remove damaged files. They are fetched again when they are needed.")
    reporting: ReportOptions = group(ReportOptions)


@command(
    CacheVerifyOptions,
    within=cache,
    help="""Hash every file in the store again, and report damaged files.

    Damaged files of built models are always removed. They are built again when they are needed.
    """,
)
def verify(options: CacheVerifyOptions, run: Run) -> Answer | None:
    store = _store(run)
    sink = run.context.sink
    entries = store.entries()
    built = list(blobs_in(store.folder))
    for blob in built:
        if blob.is_damaged:
            blob.path.unlink(missing_ok=True)
            _say_removed(blob.path, run.form)
    headless = store.headless(entries)
    for folder in headless:
        if options.fix:
            store.remove_headless(folder)
            _say_removed(folder, run.form)
        else:
            sink.error("store-unusable", f"`{folder}` is damaged, and its origin is unknown", help=_FIX)
    for entry in entries:
        damage = store.damage(entry)
        if not damage:
            continue
        if options.fix:
            with run.stopping(FINDINGS):
                store.remove_content(entry.content)
            _say_removed(entry.folder, run.form)
            continue
        notes = [Note(line.replace("was locked", "was stored")) for line in damage[:8]]
        sink.error("store-unusable", f"`{entry.folder}`, from `{entry.origin}`, is damaged", notes=notes, help=_FIX)
    if sink.has_errors:
        return None
    looked_at = [*entries, *headless, *built]
    return Answer(f"looked at {_count(looked_at)}", {"looked_at": len(looked_at)}, is_outcome=True)


def _say_removed(path: Path, form: str) -> None:
    say(json_text({"removed": str(path)}) if form == "json" else f"removed {path}: it was damaged", form=form)


def _store(run: Run) -> Store:
    from mjcompose.sources.store import Store

    form = run.form
    run.form = "text"  # of an error
    with run.stopping(USAGE):
        store = Store.of(run.context.environment)
    run.form = form
    return store


def _count(entries: Sequence[object]) -> str:
    return counted(len(entries), "entry")


def _bytes(size: float) -> str:
    for unit in ("B", "KiB", "MiB"):
        if size < 1024:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1024
    return f"{size:.1f} GiB"


class LockOptions(RecipeOptions):
    recipe: Path = RECIPE
    upgrade: bool = flag(
        "--upgrade",
        help="Lock all sources as they are now: the newest commits of branches, and"
        " archives as served now. Lock the interface, too.",
    )
    upgrade_interface: bool = flag(
        "--upgrade-interface", help="Lock the interface as it is now: names, order, sizes, units and ranges."
    )
    upgrade_sources: tuple[str, ...] = option(
        "--upgrade-source",
        multiple=True,
        metavar="NAME",
        help="Lock this source as it is now: the prefix of a part, `base`, or a source as named in the lock.",
    )


@command(
    LockOptions,
    help="""Lock the sources of RECIPE: write their commits, hashes and licenses to a file next to it.

    The lock of ARM.yaml is ARM.lock. Sources that are already locked keep their entries, unless you upgrade them. New
    sources are added, your own files are hashed again, and sources that are no longer used are removed. If the recipe
    has an `interface`, the lock has its names, sizes, units and ranges.
    """,
)
def lock(options: LockOptions, run: Run) -> Answer:
    from mjcompose.tools.lock import write_lock

    names = () if options.upgrade else options.upgrade_sources or None
    given = options.choices.given(run)
    made = write_lock(options.recipe, names, run.context, given=given, interface=options.upgrade_interface)
    if made is None and any(each.code == "unknown-name" for each in run.context.sink.errors):
        raise Stop(USAGE)
    path, changes = run.need(made, options.recipe)
    words = as_lines([*(f"  {line}" for line in changes), f"wrote {path}" if changes else f"{path} is up to date"])
    return Answer(words, {"lock": path, "changes": changes}, is_outcome=True)
