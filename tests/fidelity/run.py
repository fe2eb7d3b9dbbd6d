"""The whole fidelity table: `python tests/fidelity/run.py [--pairs] [--cases] [--robots N] [--made] [--roundtrip]`.

Without a choice of sets all are run. What needs the corpus is left out where MJCOMPOSE_CORPUS names none.
Exits with 1 where anything is not as it should be. The table goes to standard output, the progress to
standard error.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TypeVar

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent.parent)]

from fidelity import corpus as corpora, isolated, made, summary, table  # noqa: E402
from fidelity.corpus import Composition  # noqa: E402
from fidelity.judging import Verdict  # noqa: E402
from fidelity.made import Drawn, Made, judge  # noqa: E402
from fidelity.roundtrip import Trip, travel  # noqa: E402
from fidelity.settings import with_settings  # noqa: E402

ROBOTS = 22
PAGE = HERE.parent.parent / "docs" / "contributing" / "fidelity.md"
Result = TypeVar("Result")


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    folder = os.environ.get("MJCOMPOSE_CORPUS")
    corpus = Path(folder).resolve() if folder else None
    if corpus is None:
        print("MJCOMPOSE_CORPUS names no corpus: what needs one is left out", file=sys.stderr)  # noqa: T201
    rows: list[summary.Row] = []
    pages: list[str] = []
    fine = True
    written = tempfile.TemporaryDirectory()
    for title, compositions in _chosen(options, corpus, Path(written.name)):
        verdicts = _judge_all(title, compositions, options)
        rows += summary.of_compositions(title, verdicts)
        pages.append(table.markdown(title, table.HEAD, map(table.cells, verdicts), table.totals(verdicts)))
        fine &= all(verdict.fine for verdict in verdicts)
    for title, root, files in _files(options, corpus):
        trips = _travel_all(title, root, files, options)
        rows.append(summary.of_trips(title, trips))
        lines = table.trip_totals(trips)
        pages.append(table.markdown(title, table.TRIP_HEAD, map(table.trip_cells, trips), lines))
        fine &= all(trip.fine for trip in trips)
    text = summary.text(summary.together(rows))
    print(text)  # noqa: T201
    if options.write:
        page = Path(options.write)
        page.write_text(summary.between_markers(page.read_text(encoding="utf-8"), text), encoding="utf-8")
    if options.markdown:
        Path(options.markdown).write_text("\n".join(pages), encoding="utf-8")
    return 0 if fine else 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", action="store_true", help="the corpus's pairs")
    parser.add_argument("--cases", action="store_true", help="the corpus's feature cases")
    parser.add_argument("--robots", type=int, default=0, metavar="N", help="all ordered pairs of N robots")
    parser.add_argument(
        "--settings", type=int, default=0, metavar="N", help="every compiler setting on N models, in both places"
    )
    parser.add_argument("--made", action="store_true", help="small models made here")
    parser.add_argument("--roundtrip", action="store_true", help="parse, write and compile every model")
    parser.add_argument("--only", metavar="TEXT", default="", help="only what has this in its name")
    parser.add_argument("--sample", type=int, default=1, metavar="N", help="every Nth of each set")
    parser.add_argument("--workers", type=int, default=_cores(), metavar="N", help="processes at a time")
    parser.add_argument("--write", metavar="FILE", nargs="?", const=str(PAGE), help="put the table into a page")
    parser.add_argument("--markdown", metavar="FILE", help="write what came of each one there")
    return parser


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _everything(options: argparse.Namespace) -> bool:
    chosen = ("pairs", "cases", "robots", "made", "roundtrip", "settings")
    return not any(getattr(options, each) for each in chosen)


def _chosen(
    options: argparse.Namespace, corpus: Path | None, written: Path
) -> Iterator[tuple[str, list[Composition] | list[Made] | list[Drawn]]]:
    every = _everything(options)
    sets: list[tuple[str, Iterable[Composition] | Iterable[Made] | Iterable[Drawn]]] = []
    if corpus is not None:
        sets += _of_the_corpus(options, corpus, written)
    if options.made or every:
        sets += made.sets(written)
    for title, found in sets:
        yield title, [each for each in found if options.only in each.id][:: options.sample]


def _of_the_corpus(
    options: argparse.Namespace, corpus: Path, written: Path
) -> Iterator[tuple[str, Iterable[Composition]]]:
    every = _everything(options)
    robots = options.robots or (ROBOTS if every else 0)
    if options.pairs or every:
        yield "pairs of robots, tools and scenes", corpora.pairs(corpus)
    if options.cases or every:
        yield "feature cases", corpora.cases(corpus)
    if robots:
        yield f"ordered pairs of {robots} robots side by side", corpora.robots(corpus, robots)
    if options.settings:
        title = f"compiler settings on {options.settings} models"
        yield title, with_settings(corpus, written, options.settings)


def _files(options: argparse.Namespace, corpus: Path | None) -> Iterator[tuple[str, Path, list[Path]]]:
    if not (options.roundtrip or _everything(options)):
        return
    sets = [] if corpus is None else [("corpus", corpus, corpora.models(corpus))]
    sets += [(root.name, root, files) for root, files in corpora.packaged()]
    for title, root, files in sets:
        chosen = [path for path in files if options.only in str(path)][:: options.sample]
        yield f"parse → write → compile: {title}", root, chosen


def _judge_all(
    title: str, compositions: Sequence[Composition | Made | Drawn], options: argparse.Namespace
) -> list[Verdict]:
    def failed(composition: Composition | Made | Drawn, error: str) -> Verdict:
        return Verdict(composition.id, composition.refused, error=error)

    found: dict[str, Verdict] = {}
    running = isolated.each(judge, compositions, failed=failed, workers=options.workers)
    for verdict in _progress(title, running, len(compositions)):
        found[verdict.id] = verdict
        if not verdict.fine:
            _say(" | ".join(table.cells(verdict)))
    return [found[composition.id] for composition in compositions]


def _travel_all(title: str, root: Path, files: list[Path], options: argparse.Namespace) -> list[Trip]:
    def failed(path: Path, error: str) -> Trip:
        return Trip(path.relative_to(root).as_posix(), error=error)

    trips: list[Trip] = []
    running = isolated.each(partial(travel, root=root), files, failed=failed, workers=options.workers)
    for trip in _progress(title, running, len(files)):
        trips.append(trip)
        if not trip.fine:
            _say(" | ".join(table.trip_cells(trip)))
    return sorted(trips, key=lambda trip: trip.id)


def _progress(title: str, results: Iterable[Result], number: int) -> Iterator[Result]:
    """The results, and on standard error how far it is."""
    start = time.monotonic()
    live = sys.stderr.isatty()
    done = 0
    for done, result in enumerate(results, 1):
        yield result
        if live or done == number or done % 50 == 0:
            passed = time.monotonic() - start
            line = f"{title}: {done} of {number}, {passed:.0f} s"
            print(f"\r{line}" if live else line, end="" if live else "\n", file=sys.stderr, flush=True)  # noqa: T201
    if live and done:
        print(file=sys.stderr)  # noqa: T201


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)  # noqa: T201


if __name__ == "__main__":
    sys.exit(main())
