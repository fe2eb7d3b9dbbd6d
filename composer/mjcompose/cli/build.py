"""`mjcompose build`: the model of a recipe, written where the user wants it."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

import click

from mjcompose.cli.options import (
    Choices,
    Shard,
    caching,
    caching_options,
    cells_options,
    check_several,
    check_target,
    choice_options,
    fetching,
    fetching_options,
    jobs_options,
    output_option,
    target_option,
    timeout_option,
)
from mjcompose.cli.output import (
    Picturing,
    Wanted,
    build_one,
    check_has_picture,
    finish,
    for_shared_assets,
    kind_of_output,
)
from mjcompose.cli.reporting import USAGE, is_strict, report, reporting_options, strict_option, verbose_option
from mjcompose.cli.watching import session_of_run, watch_option


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@output_option(
    "Where to write the model: DIR/, FILE.zip, FILE.mjz, FILE.xml (text without assets; '-' is standard output),"
    " FILE.mjb or FILE.usdz (also .usd, .usda, .usdc). {name} is replaced by the name of the model, {hash} by two"
    " digits of a hash of it, for very many models. In the name of an MJB, {mujoco} is replaced by the version of"
    " MuJoCo; no other version can read the file. Default: build/{name}.zip."
)
@choice_options
@cells_options
@jobs_options
@click.option(
    "--samples",
    metavar="FILE",
    help="Write drawn values to this table, *.csv or *.parquet. Default with --all: samples.csv next to the models.",
)
@click.option(
    "--as",
    "output",
    type=click.Choice(["models", "worlds", "union"]),
    default="models",
    help="models, the default: each sample is a model. worlds: one model, and a table in it of the numbers that"
    " differ between the samples. union: with --worlds, one model with the parts of all cells and samples.",
)
@click.option("--worlds", "table", type=click.Path(path_type=Path), metavar="FILE",
              help="Build every cell and sample as one model and this table of the numbers that differ, *.npz or"
              " *.parquet.")  # fmt: skip
@click.option(
    "--parquet",
    is_flag=True,
    help="With --all: also write models.parquet and samples.parquet, next to the CSV files.",
)
@click.option("--shared-assets", is_flag=True, help="Write the assets of all cells to one folder:"
              " DIR/assets/ for -o 'DIR/{name}/'.")  # fmt: skip
@click.option("--no-verify", is_flag=True, help="Do not compile the result in MuJoCo.")
@click.option("--dedup", is_flag=True, help="Merge identical meshes, textures, materials and height fields of"
              " several parts; the manifest lists the merged names.")  # fmt: skip
@click.option(
    "--picture",
    is_flag=True,
    help="Also write a picture, NAME.png, next to the model and list it in the manifest.",
)
@target_option
@click.option("--licenses", is_flag=True, help="Print the license of every part.")
@timeout_option
@caching_options
@fetching_options
@strict_option
@verbose_option
@reporting_options
@watch_option
def command(
    recipe: Path,
    out: str | None,
    choices: Choices,
    every: bool,
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    jobs: int | None,
    cluster: str | None,
    shard: Shard | None,
    samples: str | None,
    output: str,
    table: Path | None,
    parquet: bool,
    shared_assets: bool,
    no_verify: bool,
    dedup: bool,
    picture: bool,
    target: str | None,
    licenses: bool,
    no_cache: bool,
    why: bool,
    form: str,
) -> None:
    """Build the model of RECIPE: one MJCF file and its assets, compiled in MuJoCo before it is written."""
    from mjcompose.build.bundle.bundle import OutputError
    from mjcompose.build.cache.builder import Maker
    from mjcompose.build.cache.cache_key import BuildOptions
    from mjcompose.sources.context import Context

    one = not every and not picks and not only_samples and table is None
    check_several(one, jobs=jobs, shard=shard, cluster=cluster)
    if table is not None and (left := next((name for name, given in {
        "--shard": shard, "--cluster": cluster, "--samples": samples, "--parquet": parquet,
        "--shared-assets": shared_assets, "--picture": picture,
    }.items() if given), None)):  # fmt: skip
        raise click.UsageError(f"{left} is not for --worlds, which gives one bundle and one table.")
    if output == "union" and table is None:
        raise click.UsageError("--as union also needs --worlds FILE, the table of the numbers that differ.")
    if output == "worlds" and only_samples:
        raise click.UsageError("--sample selects a model, and with --as worlds all samples are in one.")
    if samples is not None and not samples.lower().endswith((".csv", ".parquet")):
        help = "`--sample NUMBER` builds one, and `randomize: {samples: NUMBER}` in the recipe says how many there are"
        raise click.UsageError(
            f"--samples names a table, FILE.csv or FILE.parquet, and `{samples}` is none: {help}."
        )
    how = fetching()
    context = Context(fetching=how, strict=is_strict())
    try:
        if shared_assets:
            out, kind = for_shared_assets(out, one=one)
        else:
            kind = kind_of_output(out)
        if picture:
            check_has_picture(out or "", kind)
        if parquet:
            from mjcompose.build.cache.run_table import check_parquet

            check_parquet()
        check_target(target, kind, is_verified=not no_verify)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        report(context, form)
        sys.exit(USAGE)
    wanted = Wanted(
        "build/{name}.zip" if out is None else out,
        kind,
        not no_verify,
        deduplicated=dedup,
        form=form,
        why=why,
        licenses=licenses,
    )
    order = BuildOptions(
        wanted.verified, dedup, wanted.text_beside(context.folder), choices=choices.named(context),
        locked=how.locked, offline=how.offline, pictured=picture, target=target, worlds=output == "worlds",
    )  # fmt: skip
    with caching(context, no_cache) as cache, ExitStack() as opened:
        if picture:
            wanted = replace(wanted, picturing=Picturing(opened))
        maker = Maker(
            recipe, order, cache, context=context, form=kind, place=partial(wanted.place, context.folder)
        )
        reasons: tuple[str, ...] = ()
        if one:
            known, reasons = maker.recall(maker.key(), context)
            if known is not None:
                sys.exit(finish(known, maker, wanted, context=context, session=None))
        given = choices.values(context)
        if context.sink.has_errors:
            report(context, form)
            sys.exit(USAGE)
        with session_of_run(remembers=not one) as session:
            if table is not None:
                from mjcompose.cli.build_cells import build_worlds

                sys.exit(
                    build_worlds(
                        maker,
                        wanted,
                        given,
                        picks=picks,
                        only_samples=only_samples,
                        table=table,
                        context=context,
                        session=session,
                        jobs=jobs,
                        unites=output == "union",
                    )
                )
            if not one:
                from mjcompose.cli.build_cells import build_cells

                sys.exit(
                    build_cells(
                        maker,
                        wanted,
                        given,
                        picks=picks,
                        only_samples=only_samples,
                        context=context,
                        session=session,
                        table=samples,
                        jobs=jobs,
                        shard=shard,
                        cluster=cluster,
                        parquet=parquet,
                    )
                )
            if wanted.verified:
                session.begin()
            sys.exit(build_one(maker, wanted, given, context=context, session=session, why=reasons))
