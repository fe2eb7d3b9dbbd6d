"""`mjcompose tree`: the parts, bodies and joints of a model, and the places for attaching parts."""

from __future__ import annotations

from pathlib import Path

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.base.files import STDIN
from mjcompose.cli import completion
from mjcompose.cli.cells import ModelOptions
from mjcompose.cli.reporting import use_color
from mjcompose.cli.run import RECIPE_PATH, Answer, Run, argument, command, flag, option


@dataclass(frozen=True, slots=True)
class Options(ModelOptions):
    model: str = argument(type=type(RECIPE_PATH)(path_type=str), shell_complete=completion.files)
    places: bool = flag("--places", help="List the places where a part can be attached, as written in a recipe.")
    depth: int | None = option("--depth", type=click.IntRange(min=1), metavar="N", help="Show only N levels of bodies.")


@command(Options)
def tree(options: Options, run: Run) -> Answer:
    """Show the parts, bodies and joints of MODEL: a recipe, a bundle, a model file, or a reference to one.

    Poses are in the reference configuration. Joint ranges are in degrees and meters, in JSON in radians and meters.
    """
    from mjcompose.tools.outline import as_data, outline, render, render_places

    model = Path(options.model)
    is_recipe = options.model == STDIN or model.suffix.lower() in (".yaml", ".yml")
    given = options.choices.given(run)
    options.cell.check(model, is_recipe=is_recipe)
    given, sample = options.cell.values(model, given, run=run, verb="show")
    found = run.need(outline(options.model, run.context, given, sample=sample), model)
    show = render_places if options.places else render
    return Answer(
        lambda: show(found, options.depth, use_color(out=True)),
        lambda: as_data(found, options.depth),
        code=0,
        reports=not is_recipe,  # `check` and `build` report warnings of a recipe
    )
