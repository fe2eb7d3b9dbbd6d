"""`explain`, `tree`, `names` and `diff`: an element, an attribute or a code, a whole model, or two models."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.codes import CODES, address, code_of, in_terminal, page
from mjcompose.base.files import MJCF_FILES, RECIPES, STDIN
from mjcompose.bundle.staging import staged_file
from mjcompose.cli import completion
from mjcompose.cli.cells import CellOptions, ModelOptions
from mjcompose.cli.options import Amount, Choices, ReportOptions, TimeOptions, did_you_mean, output
from mjcompose.cli.reporting import FINDINGS, USAGE, progress, source_reader, use_color
from mjcompose.cli.run import RECIPE_PATH, Answer, Group, Run, Stop, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.base.sink import Sink
    from mjcompose.contrast.changes import Breaking, Diff
    from mjcompose.sides.names import NamesRecord
    from mjcompose.sides.side import Side


class ExplainOptions(ModelOptions):
    model: Path | None = argument(
        metavar="MODEL|CODE", type=RECIPE_PATH, required=False, shell_complete=completion.models_and_codes
    )
    query: str | None = argument(required=False, shell_complete=completion.elements)
    attribute: str | None = argument(required=False, shell_complete=completion.attributes)
    why_not: str | None = option(
        "--why-not", metavar="QUERY", help="Say why an element or attribute is not in the model, and name the cause."
    )
    codes: bool = flag("--codes", help="List all error codes.")


@command(
    ExplainOptions,
    help="""Show where an element or attribute of MODEL, a recipe or an MJCF file, came from and what changed it.

    With only an error CODE such as `bare-angle`, print what the error means and how to fix it.

    \b
    QUERY selects the element or attribute:
      'geom gripper/pad'            a kind and a name, or a unique name alone
      'geom gripper/pad friction'   one attribute: its value and every default class that may set it
      'geom gripper/**'             all elements that match, as does a kind alone
      'geom#3'                      an element without a name, by its index in MuJoCo
      'option timestep'             a setting
      'gripper.xml:12'              the element on that line
    """,
)
def explain(options: ExplainOptions, run: Run) -> Answer:
    from mjcompose.lint.rule import rules

    model = options.model
    query = options.query
    if options.codes or (model is not None and not model.suffix):
        rules()  # which adds its codes
    if options.codes:
        width = max(map(len, CODES))
        return Answer("\n".join(f"{code:{width}}  {summary}" for code, summary in CODES.items()), dict(CODES))
    if model is None:
        raise click.UsageError("Missing argument 'MODEL|CODE'.")
    if query is None and options.why_not is None:
        return _page(model)
    if query is not None and options.why_not is not None:
        raise click.UsageError("Give QUERY or --why-not QUERY, not both.")
    _check_model(model)
    from mjcompose.trace.absence import explain_absence
    from mjcompose.trace.explanation import as_data, render
    from mjcompose.trace.query import read
    from mjcompose.trace.traced import explain

    context = run.context
    text = str(options.why_not) if query is None else query
    selection = read(text, options.attribute, context.sink)
    if selection is None:
        raise Stop(USAGE)
    given = options.choices.given(run)
    options.cell.check(model, is_recipe=model.suffix.lower() not in MJCF_FILES)
    given, sample = options.cell.values(model, given, run=run, verb="explain")
    answer = explain if options.why_not is None else explain_absence
    explained = answer(model, selection, context, sample=sample, given=given)
    if explained is None:
        raise Stop(run.code_of_failure(model))
    source = source_reader(context.folder)
    color = use_color(out=True)
    has_errors = context.sink.has_errors
    # `check` and `build` report warnings.
    return Answer(lambda: render(explained, source, color), lambda: as_data(explained), reports=has_errors)


_WIDEST = 100


def _page(word: Path) -> Answer:
    code = code_of(str(word))
    if code is None:
        raise click.UsageError(_no_code(word))
    text = page(code)
    url = address(code)
    width = min(shutil.get_terminal_size((_WIDEST, 24)).columns, _WIDEST)

    words = in_terminal(text, width, use_color(out=True)) + ("" if url is None else f"\n\n{url}")
    data = {"explains": "code", "code": code, "summary": CODES[code], "page": text, "url": url}
    return Answer(words, data, is_ascii=False)


def _check_model(model: Path) -> None:
    """Raise UsageError for a code instead of a model: no other arguments apply to a code."""
    if code_of(str(model)) is not None and not os.path.exists(model):
        raise click.UsageError(
            f"`{model}` is a code, not a model. Write `mjcompose explain {code_of(str(model))}` alone."
        )


def _no_code(word: Path) -> str:
    if os.path.exists(word) or word.suffix or len(word.parts) > 1:
        return (
            "Missing argument 'QUERY'. Say which element:"
            f" `mjcompose explain {word} 'joint NAME'`. `mjcompose tree {word}` lists them."
        )
    hint = did_you_mean(str(word), CODES, " `mjcompose explain --codes` lists them.")
    return f"`{word}` is neither a code nor a file that exists.{hint}"


class TreeOptions(ModelOptions):
    model: str = argument(type=type(RECIPE_PATH)(path_type=str), shell_complete=completion.files)
    places: bool = flag("--places", help="List the places where a part can be attached, as written in a recipe.")
    depth: int | None = option("--depth", type=click.IntRange(min=1), metavar="N", help="Show only N levels of bodies.")


@command(
    TreeOptions,
    help="""Show the parts, bodies and joints of MODEL: a recipe, a bundle, a model file, or a reference to one.

    Poses are in the reference configuration. Joint ranges are in degrees and meters, in JSON in radians and meters.
    """,
)
def tree(options: TreeOptions, run: Run) -> Answer:
    from mjcompose.tools.outline import as_data, outline, render, render_places

    model = Path(options.model)
    is_recipe = options.model == STDIN or model.suffix.lower() in RECIPES
    given = options.choices.given(run)
    options.cell.check(model, is_recipe=is_recipe)
    given, sample = options.cell.values(model, given, run=run, verb="show")
    found = run.need(outline(options.model, run.context, given, sample=sample), model)
    show = render_places if options.places else render
    depth = options.depth
    color = use_color(out=True)
    # `check` and `build` report warnings of a recipe.
    return Answer(lambda: show(found, depth, color), lambda: as_data(found, depth), code=0, reports=not is_recipe)


class NamesOptions(Group):
    model: str = argument(shell_complete=completion.files)
    python: bool = flag("--python", help="Write a Python module.")
    cpp: bool = flag("--cpp", help="Write a C++17 header.")
    json: bool = flag("--json", help="Write JSON.")
    lerobot: bool = flag("--lerobot", help="Write the features of a data set of LeRobot as JSON.")
    out: str | None = output("Where to write it. Default: standard output.")
    choices: Choices = group(Choices)
    cell: CellOptions = group(CellOptions)
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    NamesOptions,
    help="""Write the names of joints, actuators, sensors and keyframes of MODEL,
    with addresses, units, ranges and values. --lerobot writes the features of a data set for its motors and cameras.

    MODEL is a bundle, a recipe or a model file. It may be in a git revision: `main:arm.yaml`. The result needs no
    other file, and equal models give equal bytes.
    """,
)
def names(options: NamesOptions, run: Run) -> Answer:
    from mjcompose.tools import names as tool

    if options.python + options.cpp + options.json + options.lerobot != 1:
        raise click.UsageError("Give one of --python, --cpp, --json and --lerobot.")
    is_recipe = Path(options.model).suffix.lower() in RECIPES
    options.cell.check(options.model, is_recipe=is_recipe)
    given = options.choices.given(run)
    found = tool.names(options.model, run.context, given, pick=options.cell.pick, sample=options.cell.sample)
    text = None if found is None else _names_as_text(found, options, run.context.sink)
    if text is None:
        raise Stop(run.code_of_failure(Path(options.model.partition(":")[2] or options.model)))
    if options.out in (None, "-"):
        return Answer(text.removesuffix("\n"), code=0, reports=options.lerobot)

    with run.stopping(FINDINGS), staged_file(run.context.folder / str(options.out), "--output") as stage:
        stage.write_text(text, encoding="utf-8")
    return Answer(f"wrote {options.out}", {"path": options.out}, is_outcome=True, code=0, reports=options.lerobot)


def _names_as_text(names: NamesRecord, options: NamesOptions, sink: Sink) -> str | None:
    """Return the names in the form of the options, or None after reported errors."""
    from mjcompose.tools import features, names as tool

    if options.lerobot:
        found = features.features(names, sink)
        return None if found is None else features.to_json(found)
    return (tool.to_python if options.python else tool.to_cpp if options.cpp else tool.to_json)(names)


_DIFFERENT = 1
_CODES = {"major": 2, "minor": 1}
_KINDS = (
    "body joint geom site camera light texture material mesh hfield skin flex tendon equality pair exclude actuator"
    " sensor numeric text tuple plugin key option visual statistic count address"
).split()


def _no_all(_context: click.Context, _option: click.Parameter, is_given: bool) -> None:
    if is_given:
        raise click.UsageError(
            "No such option '--all'. '--computed' lists also numbers that MuJoCo computes from others; "
            "'--pick CELL' compares one cell of a matrix."
        )


class DiffOptions(Group):
    a: str = argument()
    b: str = argument()
    choices: Choices = group(Choices)
    cell: CellOptions = group(CellOptions)
    only: tuple[str, ...] = option(
        "--only",
        multiple=True,
        type=click.Choice(_KINDS),
        metavar="KIND",
        help="Compare only this kind of element, or `option`, `visual`, `statistic`, `count`, `address`.",
    )
    tolerance: float = option(
        "--tolerance",
        type=Amount(min=0),
        default=0.0,
        show_default=True,
        help="Treat numbers as equal if their relative difference is smaller than this.",
    )
    computed: bool = flag("--computed", help="Also list numbers that MuJoCo computes from others.")
    breaking: bool = flag(
        "--breaking",
        help="Sort the changes: major breaks the interface, minor changes the motion,"
        " patch only the looks. Exit codes: 2 major, 1 minor, 0 patch or none.",
    )
    all: None = option("--all", is_flag=True, hidden=True, is_eager=True, callback=_no_all)
    renders: Path | None = option(
        "--renders",
        type=click.Path(path_type=Path, file_okay=False),
        metavar="DIR",
        help="Write pictures of both models here: of the whole model, and from each camera that both have.",
    )
    html: Path | None = option(
        "--html",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help="Write an HTML page that shows both models, with the differences in color.",
    )
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    DiffOptions,
    help="""Report the differences between model A and model B, grouped by the line that causes them.

    A and B are recipes, MJCF files or bundles (folder, .zip, .mjz). They may be in a git revision: `main:arm.yaml`.
    Exit codes: 0 no difference, 1 differences, 2 a model cannot be read or built. With --breaking, 2 is also a major
    change.
    """,
)
def diff(options: DiffOptions, run: Run) -> Answer:
    from mjcompose.contrast.text import as_data, breaking_as_data, render, render_breaking, render_markdown
    from mjcompose.mujoco.engine import Session
    from mjcompose.tools.diff.diff import diff

    context = run.context
    levels: list[Breaking | None] = []

    def show(first: Side, second: Side, compared: Diff) -> None:
        from mjcompose.tools.diff.diff import breaking
        from mjcompose.tools.view.page import write_comparison

        if options.breaking:
            levels.append(breaking(first, second, compared, session=session, context=context))
        if options.html is not None:
            write_comparison(first, second, compared, out=options.html, context=context, session=session)

    given = options.choices.given(run)
    progress(f"comparing {options.a} with {options.b}")
    with Session(rendering=options.renders is not None) as session:
        found = diff(
            options.a,
            options.b,
            context,
            session=session,
            tolerance=options.tolerance,
            only=options.only,
            everything=options.computed,
            given=given,
            pick=options.cell.pick,
            sample=options.cell.sample,
            renders=options.renders,
            show=show,
        )
    if found is None:
        raise Stop(USAGE)
    aside = None if options.html is None else f"wrote {options.html}: open it in a browser"
    if options.breaking:
        by_level = levels[0]
        if by_level is None:
            raise Stop(USAGE)
        code = _CODES.get(by_level.levels[0].name, 0) if by_level.levels else 0
        is_comment = run.form in ("markdown", "github")
        words = render_breaking(by_level, markdown=is_comment)
        data = breaking_as_data(by_level)
        return Answer(words, data, code=code, reports=False, aside=aside)

    return Answer(
        lambda: render(found),
        lambda: as_data(found),
        markdown=lambda: render_markdown(found).removesuffix("\n"),
        code=0 if found.same else _DIFFERENT,
        reports=False,
        aside=aside,
    )
