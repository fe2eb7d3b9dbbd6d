"""`mjcompose rebuild`: the model of a stamp again."""

from __future__ import annotations

import os
from pathlib import Path

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.options import FetchOptions, LimitOptions, ReportOptions
from mjcompose.cli.reporting import FINDINGS, USAGE
from mjcompose.cli.run import PATH, Answer, Run, Stop, argument, command, group, option


@dataclass(frozen=True, slots=True)
class Options:
    stamp: Path = argument(type=PATH)
    recipe: Path | None = argument(type=PATH, required=False)
    out: str | None = option(
        "-o", "--output", metavar="PATH", help="Where to write the model, as with `build`. Default: build/NAME.zip."
    )
    fetching: FetchOptions = group(FetchOptions)
    limits: LimitOptions = group(LimitOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def rebuild(options: Options, run: Run) -> Answer:
    """Build the model of STAMP again, to the byte, or say what differs and write nothing.

    STAMP is a JSON file with the result of `mjcompose.stamp(BUNDLE)`. RECIPE is its recipe, by default at the path that
    the stamp records, from the folder of the stamp.
    """
    from mjcompose.base.report import MjcomposeError
    from mjcompose.build.bundle.bundle import OutputError
    from mjcompose.build.bundle.write import write
    from mjcompose.tools.open.stamp import read_stamp
    from mjcompose.tools.open.stamp import rebuild as build_again

    context = run.context
    try:
        record = read_stamp(context.folder / options.stamp)
    except MjcomposeError as error:
        for each in error.diagnostics:
            context.sink.add(each)
        raise Stop(USAGE) from None
    recipe = Path(os.path.normpath(options.stamp.parent / record.recipe)) if options.recipe is None else options.recipe
    bundle = build_again(record, context.folder / recipe, context)
    if bundle is None:
        raise Stop(FINDINGS)
    out = options.out or f"build/{record.name}.zip"
    try:
        write(bundle, context.folder / out, environment=context.environment)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        raise Stop(FINDINGS) from None
    return Answer(f"wrote {out}: the bytes of the stamp", {"wrote": out, "sha256": bundle.sha256}, is_outcome=True)
