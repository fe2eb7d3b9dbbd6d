"""`mjcompose lock`: record the sources of a recipe in a file next to it."""

from __future__ import annotations

from pathlib import Path

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.options import RECIPE, RecipeOptions
from mjcompose.cli.reporting import USAGE
from mjcompose.cli.run import Answer, Run, Stop, command, flag, option


@dataclass(frozen=True, slots=True)
class Options(RecipeOptions):
    recipe: Path = RECIPE
    upgrade: bool = flag("--upgrade", help="Lock all sources as they are now: the newest commits of branches, and"
                         " archives as served now.")  # fmt: skip
    upgrade_sources: tuple[str, ...] = option(
        "--upgrade-source", multiple=True, metavar="NAME",
        help="Lock this source as it is now: the prefix of a part, `base`, or a source as named in the lock.",
    )  # fmt: skip


@command(Options)
def lock(options: Options, run: Run) -> Answer:
    """Lock the sources of RECIPE: write their commits, hashes and licenses to a file next to it.

    The lock of ARM.yaml is ARM.lock. Sources that are already locked keep their entries, unless you upgrade them. New
    sources are added, your own files are hashed again, and sources that are no longer used are removed.
    """
    from mjcompose.tools.lock import write_lock

    names = () if options.upgrade else options.upgrade_sources or None
    made = write_lock(options.recipe, names, run.context, given=options.choices.given(run))
    if made is None and any(each.code == "unknown-name" for each in run.context.sink.errors):
        raise Stop(USAGE)
    path, changes = run.need(made, options.recipe)
    done = f"wrote {path}" if changes else f"{path} is up to date"
    words = "\n".join([*(f"  {line}" for line in changes), done])
    return Answer(words, {"lock": path, "changes": changes}, is_outcome=True)
