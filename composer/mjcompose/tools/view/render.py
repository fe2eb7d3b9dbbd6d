"""A picture, a film or a contact sheet as a file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.limits import Limits, allow, in_force
from mjcompose.base.processes import Died, Pool, cores
from mjcompose.base.runtime import interruptible
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, unknown_name
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import staged_file
from mjcompose.compose.load import Library
from mjcompose.language.expand import Cell
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.pictures import NEEDS_OPENGL, draw, sheet
from mjcompose.pipeline.cache.cell_run import context_for_worker
from mjcompose.plan.read import Given
from mjcompose.sides.operand import Operand, OperandKind
from mjcompose.sides.side import load_cell
from mjcompose.sources.context import Context


def check_given(operand: Operand, given: Given) -> bool:
    """Return whether the target accepts values; report that a model has no parameters."""
    if operand.kind is OperandKind.RECIPE:
        return True
    for name, node in given.items():
        message = f"`{operand.label}` is not a recipe and has no parameter `{name}`"
        operand.context.sink.error("unknown-name", message, node.span)
    return not given


Color = tuple[int, int, int, int]
TRANSPARENT: Color = (0, 0, 0, 0)
COLORS: dict[str, Color] = {
    "white": (255, 255, 255, 1),
    "black": (0, 0, 0, 1),
    "grey": (235, 235, 235, 1),
    "transparent": TRANSPARENT,
}
MOST_PIXELS = 8192


class Format(StrEnum):
    """The file formats of pictures and films, by suffix."""

    PNG = ".png"
    GIF = ".gif"
    MP4 = ".mp4"


class RenderRequest(Struct):
    """The settings of a picture or film.

    `size` is the width and height in pixels, and `background` is RGB of 255 and an opacity of 0 or 1. None keeps the
    model's own background. `key` and `camera` are names. Without a `key`, the picture shows the first keyframe; without
    a `camera`, it shows the whole model, or the element `look`, given by kind and name. `labels` are kinds of elements
    whose names are shown. `play` is the number of seconds of physics in a film, or None for a film without physics.
    """

    size: tuple[int, int] = (1920, 1440)
    key: str | None = None
    camera: str | None = None
    background: Color | None = None
    turntable: bool = False
    play: float | None = None
    look: tuple[str, str] | None = None
    explode: bool = False
    labels: tuple[str, ...] = ()


FILM = (960, 720)
LOOKS = ("body", "geom", "site", "joint")
LABELS = ("body", "geom", "site", "joint")


def look_of(text: str) -> tuple[str, str] | None:
    """Return the kind and the name in `KIND/NAME`; None for anything else.

    >>> look_of("body/arm/base")
    ('body', 'arm/base')
    """
    kind, _, name = text.partition("/")
    return (kind, name) if kind in LOOKS and name else None


def format_of(out: Path, wish: RenderRequest) -> Format:
    """Return the format for a file's name. Raises `OutputError` if it is unknown or does not fit the wish."""
    suffix = out.suffix.lower()
    known = [each.value for each in Format]
    if suffix not in known:
        near = did_you_mean(suffix, known, "-o " + str(out.with_suffix("")) + "{}") if suffix else None
        help = near or f"write for instance `-o {out.with_suffix('.png')}`"
        raise OutputError("output-kind", f"`{out}` is not a .png, .gif or .mp4 file", help)
    moves = wish.turntable or wish.play is not None
    if suffix == Format.PNG and moves:
        help = f"write `-o {out.with_suffix('.gif')}`"
        raise OutputError("output-kind", f"`{out}` is one picture, and the options are for a film", help)
    if suffix != Format.PNG and not moves:
        help = f"add `--turntable` or `--play SECONDS`, or write `-o {out.with_suffix('.png')}`"
        raise OutputError("output-kind", f"`{out}` is a film, and nothing moves in it", help)
    if suffix != Format.PNG and wish.background == TRANSPARENT:
        raise OutputError("output-kind", "a film has no transparent background", "omit `--background`")
    return Format(suffix)


def color_of(text: str) -> Color | None:
    """Return a color by its name or as `#RRGGBB`; None for anything else.

    >>> color_of("#ff8000")
    (255, 128, 0, 1)
    """
    if re.fullmatch("#[0-9A-Fa-f]{6}", text) is None:
        return COLORS.get(text)
    red, green, blue = bytes.fromhex(text[1:])
    return red, green, blue, 1


def size_of(text: str) -> tuple[int, int] | None:
    """Parse `WIDTHxHEIGHT` in pixels, from 16 to 8192; return None for anything else.

    >>> size_of("640x480")
    (640, 480)
    """
    found = re.fullmatch("([0-9]+)x([0-9]+)", text.lower())
    width, height = (int(found[1]), int(found[2])) if found else (0, 0)
    return (width, height) if min(width, height) >= 16 and max(width, height) <= MOST_PIXELS else None


class _NotDrawn(Exception):
    """Nothing is written, which was reported; an older picture stays."""


_FAULTS = {
    "no OpenGL": ("no-rendering", "no picture can be made without OpenGL", NEEDS_OPENGL),
    "no encoder": (
        "no-video",
        "no MP4 can be written without PyAV",
        'install it with `pip install "mjcompose[video]"`, or write a `.gif`',
    ),
    "stopped": (
        "unstable",
        "the film ends early",
        "give `--play` fewer seconds; a smaller `timestep` in `<option>` often helps",
    ),
}


def render(
    kept: str,
    out: Path,
    wish: RenderRequest,
    context: Context,
    session: Session,
    read: Iterable[Path] = (),
    option: str = "-o",
) -> bool:
    """Write a picture or film of a kept model, but never over a file that was `read`; return False after an error."""
    with suppress(_NotDrawn), context.sink:
        suffix = format_of(out, wish)
        with staged_file(context.folder / out, option, inputs=read) as stage:
            picture = stage.with_name(stage.name + suffix)
            try:
                if not drawn(kept, {**asdict(wish), "out": str(picture)}, context, session=session):
                    raise _NotDrawn
                picture.replace(stage)
            finally:
                picture.unlink(missing_ok=True)
        return True
    return False


def drawn(kept: str, asked: dict[str, Any], context: Context, session: Session) -> bool:
    """Draw a kept model in the child; return False after an error, which is reported."""
    answer = engine.call(session, draw, [kept], argument=asked)
    if not answer.ok:
        context.sink.error("no-rendering", f"no picture could be made: {answer.error or answer.crash}")
        return False
    said: dict[str, Any] = {"no OpenGL": session.no_opengl} if session.no_opengl else answer.value
    for fault, (code, message, help) in _FAULTS.items():
        if fault in said:
            context.sink.error(code, f"{message}: {said[fault]}", help=help)
            return False
    if "unknown" in said:
        kind = said["unknown"]
        word = "keyframe" if kind == "key" else kind
        name = str(asked.get(kind))
        written = f"--{kind} {{}}"
        if asked["look"] is not None and kind == asked["look"][0]:
            name = asked["look"][1]
            written = f"--look {kind}/{{}}"
        context.sink.add(unknown_name(word, name, said["known"], written=written))
        return False
    return True


TILE = (640, 480)
_KEPT = "tile"
_CELLS_A_PROCESS = 2
_ENDS = ("no-rendering", "mujoco-missing")  # errors that apply to all cells if they apply to one
_MODULES = ("mjcompose.tools.view.render",)
Drawn = tuple[bool, tuple[Diagnostic, ...], tuple[Path, ...]]
"""Whether a cell was drawn, its diagnostics, and the files that were read for it."""


class _Job(Struct):
    """Everything that a process needs to draw cells into a folder. Can be pickled."""

    operand: Operand
    wish: RenderRequest
    given: Given
    folder: Path
    limits: Limits

    @contextmanager
    def opened(self) -> Iterator[Callable[[tuple[int, Cell]], Drawn]]:
        with allow(**asdict(self.limits)), engine.Session(rendering=True) as session:
            yield partial(self.draw, session, {})

    def draw(self, session: engine.Session, library: Library, task: tuple[int, Cell]) -> Drawn:
        number, cell = task
        own = replace(self.operand, context=replace(self.operand.context, sink=Sink()))
        with interruptible():
            side = load_cell(own, _KEPT, session, given=self.given, cell=cell, library=library)
            asked = {**asdict(self.wish), "out": str(self.tile(number)), "tile": str(cell.name)}
            is_drawn = side is not None and drawn(_KEPT, asked, own.context, session=session)
        return is_drawn, tuple(own.context.sink.sorted()), () if side is None else side.inputs

    def tile(self, number: int) -> Path:
        return self.folder / f"{number}.npy"


def render_sheet(
    operand: Operand,
    cells: Sequence[Cell],
    out: Path,
    wish: RenderRequest,
    session: engine.Session,
    given: Given,
    tell: Callable[[str], None],
    jobs: int | None = None,
) -> int:
    """Write one picture of all `cells`, each with its name below it; return their number.

    Cells that cannot be built are left out, and their errors are reported. If none is left, nothing is written. `tell`
    is called with the name of each finished cell. `jobs` is the number of processes; by default, it uses as many as pay
    off.
    """
    context = operand.context
    tiles: list[str] = []
    read: set[Path] = set()
    workers = min(len(cells), jobs or min(cores(), max(1, len(cells) // _CELLS_A_PROCESS))) - 1
    with scratch("pictures") as folder, Pool[tuple[int, Cell], Drawn](workers, _MODULES) as pool:
        handed = replace(operand, context=context_for_worker(context))
        job = _Job(handed, wish, given, folder=folder, limits=in_force())
        results = pool.results(job.opened, enumerate(cells), partial(job.draw, session, {}))
        for number, (cell, result) in enumerate(zip(cells, results, strict=True)):
            tell(cell.name)
            if isinstance(result, Died):
                message = f"the process that drew this model {result.how}, twice"
                help = "if memory ran out, give `--jobs` a smaller number; `--jobs 1` uses no other process"
                result = False, (Diagnostic("worker-died", message, cell.span, help=help),), ()
            is_drawn, found, inputs = result
            read.update(inputs)
            tiles += [str(job.tile(number))] if is_drawn else []
            for each in found:
                context.sink.add_of_cell(cell.label, each)
            if any(each.code in _ENDS for each in found):
                break
        pool.end()
        with context.sink:
            if tiles:
                with staged_file(context.folder / out, "-o", inputs=read) as stage:
                    engine.call(session, sheet, (), argument={"tiles": tiles, "out": str(stage)})
                return len(tiles)
        return 0
