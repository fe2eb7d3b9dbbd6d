"""`mjcompose build`: the model of a recipe, written where the user wants it."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import click

from composer.cli.caching import caching, caching_options
from composer.cli.choices import Choices, choice_options
from composer.cli.fetching import fetching, fetching_options
from composer.cli.matrix import cells_options
from composer.cli.output import output_option
from composer.cli.reporting import USAGE, report, reporting_options
from composer.cli.timeout import timeout_option
from composer.cli.wanted import Wanted, for_shared_assets, kind_of_output
from composer.cli.writing import build_one, finish


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@output_option(
    "DIR/, FILE.zip, FILE.mjz, FILE.xml (text alone, '-' for standard output), FILE.mjb or FILE.usdz (also .usd, .usda,"
    " .usdc). {name} is the name of the model, and {mujoco} in that of an MJB the version of MuJoCo, the only one that"
    " reads it. Default: build/{name}.zip."
)
@choice_options
@cells_options
@click.option(
    "--samples",
    metavar="FILE",
    help="The table of what was drawn, *.csv or *.parquet; with --all: samples.csv beside the models.",
)
@click.option("--shared-assets", is_flag=True, help="Keep the assets of all cells in one folder: with"
              " -o 'DIR/{name}/' that is DIR/assets/.")  # fmt: skip
@click.option("--no-verify", is_flag=True, help="Do not compile the result in MuJoCo.")
@click.option("--dedup", is_flag=True, help="Keep identical meshes, textures, materials and height fields of"
              " several parts once; the manifest says which name stands for which.")  # fmt: skip
@click.option("--licenses", is_flag=True, help="Print the licence of every part.")
@timeout_option
@caching_options
@fetching_options
@reporting_options
def command(
    recipe: Path,
    out: str | None,
    choices: Choices,
    every: bool,
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    samples: str | None,
    shared_assets: bool,
    no_verify: bool,
    dedup: bool,
    licenses: bool,
    timeout: float,
    no_cache: bool,
    why: bool,
    form: str,
) -> None:
    """Build the model of RECIPE: one MJCF file and its assets, compiled in MuJoCo before it is written."""
    from composer.bundle.output_error import OutputError
    from composer.cache.builder import Maker
    from composer.cache.cache_key import BuildOptions
    from composer.context import Context

    how = fetching()
    context = Context(fetching=how)
    one = not every and not picks and not only_samples
    try:
        if shared_assets:
            out, kind = for_shared_assets(out, one=one)
        else:
            kind = kind_of_output(out)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        report(context, form)
        sys.exit(USAGE)
    wanted = Wanted(
        "build/{name}.zip" if out is None else out, kind, not no_verify, dedup, form, why, licenses
    )
    order = BuildOptions(
        wanted.verified, dedup, wanted.text_beside(context.folder), choices.named(context),
        how.locked, how.offline,
    )  # fmt: skip
    with caching(context, no_cache) as cache:
        maker = Maker(recipe, order, cache, context, kind, partial(wanted.place, context.folder))
        reasons: tuple[str, ...] = ()
        if one:
            known, reasons = maker.recall(maker.key(), context)
            if known is not None:
                sys.exit(finish(known, maker, wanted, context, None))
        given = choices.values(context)
        if context.sink.has_errors:
            report(context, form)
            sys.exit(USAGE)
        from composer.engine import Limits, Session

        with Session(Limits(seconds=timeout)) as session:
            if not one:
                from composer.cli.build_cells import build_cells

                sys.exit(build_cells(maker, wanted, given, picks, only_samples, context, session, samples))
            sys.exit(build_one(maker, wanted, given, context, session, reasons))
