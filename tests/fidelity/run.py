"""The whole fidelity table: `python tests/fidelity/run.py [--pairs] [--cases] [--robots N] [--settings N] [--roundtrip]`.

Needs MJCOMPOSE_CORPUS. Exits with 1 where anything is not as it should be. Without a choice of sets it runs
the pairs and the feature cases.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent.parent)]

from fidelity import corpus as corpora  # noqa: E402
from fidelity import isolated, table  # noqa: E402
from fidelity.building import stand_in  # noqa: E402
from fidelity.corpus import Composition  # noqa: E402
from fidelity.judging import Verdict, judge  # noqa: E402
from fidelity.roundtrip import Trip, travel  # noqa: E402
from fidelity.settings import with_settings  # noqa: E402

from composer.verify.keyframes import Roots  # noqa: E402


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    folder = os.environ.get("MJCOMPOSE_CORPUS")
    if not folder:
        print("MJCOMPOSE_CORPUS names no corpus", file=sys.stderr)  # noqa: T201
        return 2
    corpus = Path(folder).resolve()
    pages: list[str] = []
    fine = True
    with tempfile.TemporaryDirectory() as written:
        for title, compositions in _chosen(options, corpus, Path(written)):
            fine &= _judge_all(title, compositions, options, pages)
    if options.roundtrip:
        fine &= _travel_all(corpus, options, pages)
    if options.markdown:
        Path(options.markdown).write_text("\n".join(pages), encoding="utf-8")
    return 0 if fine else 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pairs", action="store_true", help="the corpus's pairs")
    parser.add_argument("--cases", action="store_true", help="the corpus's feature cases")
    parser.add_argument("--robots", type=int, default=0, metavar="N", help="all ordered pairs of N robots")
    parser.add_argument(
        "--settings", type=int, default=0, metavar="N", help="N models with compiler settings"
    )
    parser.add_argument("--roundtrip", action="store_true", help="parse, write and compile every model")
    parser.add_argument("--only", metavar="TEXT", help="only what has this in its name")
    parser.add_argument("--stand-in", action="store_true", help="MuJoCo's own attach in place of mjcompose")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes at a time (2)")
    parser.add_argument("--markdown", metavar="FILE", help="write the tables there as well")
    return parser


def _chosen(options: argparse.Namespace, corpus: Path, written: Path) -> list[tuple[str, list[Composition]]]:
    any_set = options.pairs or options.cases or options.robots or options.roundtrip or options.settings
    chosen = []
    if options.pairs or not any_set:
        chosen.append(("Pairs", corpora.pairs(corpus)))
    if options.cases or not any_set:
        chosen.append(("Feature cases", corpora.cases(corpus)))
    if options.robots:
        chosen.append(("Robots", list(corpora.robots(corpus, options.robots))))
    if options.settings:
        chosen.append(("Settings", list(with_settings(corpus, written, options.settings))))
    return [(title, [c for c in found if (options.only or "") in c.id]) for title, found in chosen]


def _judge_all(
    title: str, compositions: list[Composition], options: argparse.Namespace, pages: list[str]
) -> bool:
    work = partial(judge, builder=stand_in, roots=Roots.KEPT) if options.stand_in else judge
    verdicts: dict[str, Verdict] = {}
    for verdict in isolated.each(work, compositions, failed=_failed, workers=options.workers):
        verdicts[verdict.id] = verdict
        _say(" | ".join(table.cells(verdict)))
    ordered = [verdicts[composition.id] for composition in compositions]
    lines = table.totals(ordered)
    _say(f"\n{title}", *lines, "")
    pages.append(table.markdown(title, table.HEAD, map(table.cells, ordered), lines))
    return all(verdict.fine for verdict in ordered)


def _failed(composition: Composition, error: str) -> Verdict:
    return Verdict(composition.id, composition.refused, error=error)


def _travel_all(corpus: Path, options: argparse.Namespace, pages: list[str]) -> bool:
    models = [path for path in corpora.models(corpus) if (options.only or "") in str(path)]

    def failed(path: Path, error: str) -> Trip:
        return Trip(path.relative_to(corpus).as_posix(), error=error)

    trips: list[Trip] = []
    for trip in isolated.each(partial(travel, corpus=corpus), models, failed=failed, workers=options.workers):
        trips.append(trip)
        if not trip.fine:
            _say(" | ".join(table.trip_cells(trip)))
    trips.sort(key=lambda trip: trip.id)
    lines = table.trip_totals(trips)
    _say("\nRound trips", *lines)
    pages.append(table.markdown("Round trips", table.TRIP_HEAD, map(table.trip_cells, trips), lines))
    return all(trip.fine for trip in trips)


def _say(*lines: str) -> None:
    for line in lines:
        print(line, flush=True)  # noqa: T201


if __name__ == "__main__":
    sys.exit(main())
