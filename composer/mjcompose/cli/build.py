"""`mjcompose build`: build the model of a recipe and write it."""

from __future__ import annotations

import os
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import click

from mjcompose.base.diagnostic import hide
from mjcompose.base.extensions import is_registered
from mjcompose.bundle.bundle import OutputError, OutputForm, is_address
from mjcompose.cli.cells import BuildingOptions, check_readers, check_several
from mjcompose.cli.options import RECIPE_OR_STDIN, caching, did_you_mean, output
from mjcompose.cli.output import OutputSpec, Picturing, Task, kind_of_output
from mjcompose.cli.reporting import FINDINGS, USAGE, noted_files, noted_outputs
from mjcompose.cli.run import PATH, Run, command, flag, option
from mjcompose.language.target_names import MUJOCO, NAMES as TARGETS_NAMES


class _Target(click.Choice):  # type: ignore[type-arg]  # before click 8.2 it is not generic
    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value in self.choices:
            return str(value)

        if is_registered("targets", value):
            return str(value)
        hint = did_you_mean(value, self.choices)
        raise click.BadParameter(f"the target `{value}` does not exist.{hint} Targets: {', '.join(self.choices)}.")


class BuildCommandOptions(BuildingOptions):
    recipe: Path = RECIPE_OR_STDIN
    out: str | None = output(
        "Where to write the model: DIR/, FILE.zip, FILE.mjz, FILE.xml (text without assets, '-' is standard output),"
        " FILE.mjb or FILE.usdz (also .usd, .usda, .usdc). {name} is replaced by the name of the model, {hash} by two"
        " digits of its hash, which spreads many models over folders. In the name of an MJB, {mujoco} is replaced by"
        " the version of MuJoCo; no other version can read the file. Default: build/{name}.zip."
    )
    samples: str | None = option(
        "--sample-table",
        metavar="FILE",
        help="Write drawn values to this table, *.csv or *.parquet. Default with --all: samples.csv next to the"
        " models.",
    )
    gives: str = option(
        "--as",
        type=click.Choice(["models", "worlds", "union"]),
        default="models",
        help="models, the default: each sample is a model. worlds: one model, and a table in it of the numbers that"
        " differ between the cells and samples; with --all, one model for each cell. union: with --worlds, one model"
        " with the parts of all cells and samples.",
    )
    table: Path | None = option(
        "--worlds",
        type=PATH,
        metavar="FILE",
        help="Build every cell and sample as one model and this table of the numbers that differ, *.npz or *.parquet.",
    )
    parquet: bool = flag(
        "--parquet", help="With --all: also write models.parquet and samples.parquet, next to the CSV files."
    )
    shared_assets: bool = flag(
        "--shared-assets", help="Write the assets of all cells to one folder: DIR/assets/ for -o 'DIR/{name}/'."
    )
    no_compile: bool = flag("--no-compile", help="Do not compile the result in MuJoCo.")
    dedup: bool = flag(
        "--dedup",
        help="Merge identical meshes, textures, materials and height fields of several"
        " parts; the manifest lists the merged names.",
    )
    picture: bool = flag(
        "--picture", help="Also write a picture, NAME.png, next to the model and list it in the manifest."
    )
    target: str | None = option(
        "--target",
        type=_Target(TARGETS_NAMES),
        callback=lambda _context, _, name: None if name == MUJOCO else name,
        help="The program to write the model for. Features that it lacks are reported. Default: mujoco.",
    )
    depfile: Path | None = option(
        "--depfile",
        type=PATH,
        metavar="FILE",
        help="Also write the paths of all inputs to this file, in the syntax of Make and Ninja.",
    )
    sbom: Path | None = option(
        "--sbom",
        type=PATH,
        metavar="FILE",
        help="Also write the parts of the model, with their hashes and licenses, to this file, as CycloneDX 1.6.",
    )
    licenses: bool = flag("--licenses", help="Print the license of every part.")
    why: bool = flag("--why", help="Print why a model was built, or why it was taken from the cache.")

    @property
    def one(self) -> bool:
        return self.cells.one and self.table is None


@command(
    BuildCommandOptions,
    help="Build the model of RECIPE: one MJCF file and its assets, compiled in MuJoCo before it is written.",
)
def build(options: BuildCommandOptions, run: Run) -> int:
    code = _build(options, run)
    if code or (options.depfile is None and options.sbom is None):
        return code
    from mjcompose.cli.build_records import write_depfile, write_sbom

    context = run.new_context()
    if options.depfile is not None:
        inputs = [*noted_files(), *options.choices.files(context)]
        write_depfile(options.depfile, noted_outputs(), inputs, context=context)
    if options.sbom is not None and not context.sink.has_errors:
        write_sbom(options.sbom, noted_outputs()[0], context)
    run.report(context)
    return FINDINGS if context.sink.has_errors else 0


def _build(options: BuildCommandOptions, run: Run) -> int:
    from mjcompose.pipeline.cache.builder import Maker
    from mjcompose.pipeline.cache.cache_key import BuildOptions

    _check_usage(options)
    spec = _output_spec(options, run)
    context = run.context
    how = context.fetching
    assert how is not None
    one, joins, draws = _worlds(options, run)
    order = BuildOptions(
        spec.verified,
        options.dedup,
        spec.text_beside(context.folder),
        choices=options.choices.named(context),
        locked=how.locked,
        offline=how.offline,
        pictured=options.picture,
        target=options.target,
        worlds=draws,
    )
    with caching(context, options.no_cache) as cache, ExitStack() as opened:
        if options.picture:
            spec = replace(spec, picturing=Picturing(opened))
        place = partial(spec.place, context.folder)
        maker = Maker(options.recipe, order, cache, context=context, form=spec.kind, place=place)
        reasons: tuple[str, ...] = ()
        if one:
            known, reasons = maker.recall(maker.key(), context)
            if known is not None:
                return Task(maker, spec, run).finish(known)
        given = options.choices.given(run)
        with run.session(remembers=not one) as session:
            task = Task(maker, spec, run, given=given, session=session)
            if options.table is not None or joins:
                from mjcompose.cli.build_cells import build_worlds

                return build_worlds(task, options, options.table)
            if not one:
                from mjcompose.cli.build_cells import build_cells

                return build_cells(task, options)
            if spec.verified:
                session.begin()
            return task.build_one(reasons)


def _worlds(options: BuildCommandOptions, run: Run) -> tuple[bool, bool, bool]:
    """Return whether one model is built, whether cells become its worlds, and whether samples do."""
    if options.gives != "worlds" or options.cells.every:
        return options.one, False, options.gives == "worlds"
    from mjcompose.pipeline.cache.cells import worlds_of

    context = run.new_context()
    found = worlds_of(options.recipe, context, options.choices.given(run))
    joins = found.cells > 0 and options.table is None
    return options.one and not joins, joins, found.draws or not found.cells


def _check_usage(options: BuildCommandOptions) -> None:
    check_readers(options.recipe, options.workers.cluster)
    workers = options.workers
    samples = options.samples
    check_several(options.one, jobs=workers.jobs, shard=workers.shard, cluster=workers.cluster)
    if options.table is not None:
        _check_usage_of_worlds(options)
    if options.gives == "union" and options.table is None:
        raise click.UsageError("--as union also needs --worlds FILE, the table of the numbers that differ.")
    if options.gives == "worlds" and options.cells.only_samples:
        raise click.UsageError("--sample selects a model, and with --as worlds, all samples are in one model.")
    if samples is not None and not samples.lower().endswith((".csv", ".parquet")):
        help = "`--sample NUMBER` builds one, and `randomize: {samples: NUMBER}` in the recipe sets their number"
        raise click.UsageError(f"--sample-table names a table, FILE.csv or FILE.parquet, not `{samples}`: {help}.")
    if options.depfile is not None and (options.out == "-" or workers.shard is not None):
        raise click.UsageError("--depfile names the outputs of a whole build: remove -o - and --shard.")
    if options.sbom is not None and not (options.one and _is_bundle_here(options.out)):
        raise click.UsageError("--sbom is for one model that is written to DIR/, FILE.zip or FILE.mjz on this machine.")
    if samples is not None and options.one:
        raise click.UsageError("--sample-table is for --all, --pick and --sample: here is one model.")


def _check_usage_of_worlds(options: BuildCommandOptions) -> None:
    values = {
        "--shard": options.workers.shard,
        "--cluster": options.workers.cluster,
        "--sample-table": options.samples,
        "--parquet": options.parquet,
        "--shared-assets": options.shared_assets,
        "--picture": options.picture,
    }
    for name, value in values.items():
        if value:
            raise click.UsageError(f"{name} is not for --worlds, which gives one bundle and one table.")


def _is_bundle_here(out: str | None) -> bool:
    """Return whether the output is a folder or an archive on this machine."""
    return (out is None or out.endswith(("/", ".zip", ".mjz"))) and not is_address(out)


def _output_spec(options: BuildCommandOptions, run: Run) -> OutputSpec:
    out = options.out
    with run.stopping(USAGE):
        out, kind = _for_shared_assets(out, options.one) if options.shared_assets else (out, kind_of_output(out))
        if options.picture:
            _check_has_picture(out or "", kind)
        if options.parquet:
            from mjcompose.cli.build_cells import check_parquet

            check_parquet()
        _check_target(options, kind)
    spec = OutputSpec("build/{name}.zip" if out is None else out, kind, not options.no_compile, form=run.form)
    derived = out is None or "{" in out
    return replace(spec, why=options.why, licenses=options.licenses, derived=derived)


_NO_SHARING = {
    "archive": "a zip cannot refer to files outside of it",
    "text": "text alone names the sources' own files, and none is copied",
    "mjb": "MuJoCo's binary form has its assets in it",
    "usd": "USD has meshes in its layers",
}


def _for_shared_assets(out: str | None, one: bool) -> tuple[str, OutputForm]:
    out = "build/{name}/" if out is None else out
    help = "write `--all -o 'build/{name}/'`"
    if one:
        raise OutputError("output-kind", "one model cannot share its assets", help)
    kind = kind_of_output(out, models=2)
    if kind is not OutputForm.FOLDER:
        raise OutputError("output-kind", f"`--shared-assets` is for folders: {_NO_SHARING[kind]}", help)
    above, _, last = os.path.dirname(out.rstrip("/")).rpartition("/")
    if "{name}" in above + last or "{hash}" in above or ("{hash}" in last and last != "{hash}"):
        raise OutputError("output-kind", f"the folders `{out}` are not next to each other", help)
    return out, OutputForm.SHARED


def _check_has_picture(out: str, kind: OutputForm) -> None:
    if is_address(out):
        help = "write to this machine and copy the files from there, or remove `--picture`"
        message = f"`--picture` is for outputs on this machine, and `{hide(out)}` is an address"
        raise OutputError("output-kind", message, help)
    why = {"mjb": "MuJoCo's binary form", "usd": "USD"}.get(kind)
    if out == "-" or why is not None:
        message = f"`--picture` is for bundles and MJCF files, and `{out}` is {why or 'standard output'}"
        raise OutputError("output-kind", message, "write a folder, a `.zip` or an `.xml`, or remove `--picture`")


_MORE = {"isaac": ("usd",)}
"""Other kinds of output that a target reads: Isaac Sim opens USD without its importer."""


def _check_target(options: BuildCommandOptions, kind: str) -> None:
    target = options.target
    if target is None:
        return
    if kind not in ("folder", "archive", *_MORE.get(target, ())):
        help = f"write a folder, `--target {target} -o build/{target}/`, or an archive"
        raise OutputError("output-kind", f"a model for `{target}` is several files, and the output is one", help)
    if options.no_compile:
        raise OutputError("output-kind", "`--target` needs the compiled model", "remove `--no-compile`")
