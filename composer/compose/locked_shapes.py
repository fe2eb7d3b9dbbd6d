"""What is made of meshes, for a lock: every result that the models of some plans need, and their files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from composer import engine
from composer.bundle.output_error import unwritable
from composer.bundle.staging import staged_file
from composer.compose.compose import Composer
from composer.compose.load import Library
from composer.compose.shape_store import kept_beside
from composer.context import Context
from composer.link.measure import measure_with
from composer.plan.allowed import acknowledge
from composer.plan.plan import Plan
from composer.reading.regular import read_regular


def made_for(plans: Iterable[Plan], context: Context) -> dict[str, bytes]:
    """The results that plans need, by key; what is not kept yet is made now. Faults go to the context's sink."""
    found: dict[str, bytes] = {}
    library: Library = {}
    working = [plan for plan in plans if plan.works_on_meshes]
    if not working:
        return found
    assert context.fetching is not None
    context.fetching.remakes_shapes = True
    try:
        with engine.Session() as session:
            for plan in working:
                measure = measure_with(context, session=session)
                composer = Composer(context, measure, session, library=library)
                composer.compose(plan)
                acknowledge(plan, context.sink, context.shown, whole=False)
                if composer.workshop is not None:
                    found |= composer.workshop.store.used
    finally:
        context.fetching.remakes_shapes = False
    return found


def write_beside(folder: Path, shapes: Mapping[str, bytes]) -> None:
    """Let a folder beside a recipe have these results and no others. Raises OutputError."""
    before = kept_beside(folder)
    if not shapes and not before:
        return
    try:
        folder.mkdir(exist_ok=True)
        for key, content in shapes.items():
            path = folder / f"{key}.json"
            if key not in before or read_regular(path) != content:
                with staged_file(path, rewrites=True) as stage:
                    stage.write_bytes(content)
        for key in before.keys() - shapes.keys():
            before[key].unlink(missing_ok=True)
        if not shapes and not any(folder.iterdir()):
            folder.rmdir()
    except OSError as error:
        raise unwritable(str(folder), error) from error
