"""Other projects' tests and models, with mjcompose: `make foreign`, or `python tests/foreign/run.py`.

dm_control's own tests of `dm_control.mjcf` run with `mjcompose.mjcf`, and examples of ours with `dm_control.mjcf`. Every
MJCF model in the tests and data of packages about MuJoCo is read, written and compiled; the suites' models are also
composed, each twice, turned and tilted. robosuite's own compositions are made again from its files, also by the recipe
of the page on moving from robosuite. `intended.toml` and `strings.toml` list the intended differences, and the run fails
at any other difference. The packages come from PyPI, by pip or uv, into a folder that is kept; a package that cannot be
had is skipped, with the reason.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import TypeVar

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE.parent), str(ROOT)]

from fidelity import isolated  # noqa: E402
from fidelity.summary import between_markers  # noqa: E402
from foreign import imports_changed, lift, merging, outcomes, rewriting, strings, turned  # noqa: E402
from foreign.fetching import Unavailable, fetched, pins  # noqa: E402
from foreign.strings import Source, Verdict  # noqa: E402

T = TypeVar("T")

PAGE = ROOT / "docs" / "contributing" / "fidelity.md"
MARKERS = ("<!-- foreign: begin -->", "<!-- foreign: end -->")
# The folder of each package that has models, below what is fetched.
MODELS = {
    "mujoco-warp": "mujoco_warp",
    "mujoco-mjx": "mujoco/mjx",
    "brax": "brax",
    "dm_control": "dm_control",
    "metaworld": "metaworld",
    "robosuite": "robosuite",
    "gym-quadruped": "gym_quadruped",
    "mani-skill": "mani_skill",
    "playground": "mujoco_playground",
    "myosuite": "myosuite",
    "flygym": "flygym",
    "newton": "newton",
}
# Those whose models are composed, too.
SUITES = frozenset(MODELS) - {"mujoco-mjx", "brax", "dm_control"}


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    options.cache = options.cache.resolve()
    if options.write:
        options.sample = None
    if not version("mujoco").startswith("4."):
        _say(f"skipped: the lists of differences are of MuJoCo 4, this is {version('mujoco')}")
        return 0
    start = time.monotonic()
    with ThreadPoolExecutor(4) as fetching:
        list(fetching.map(lambda name: _prefetch(name, options.cache), pins()))
    if options.fetch:
        return 0
    rows: list[str] = []
    surprises: list[str] = []
    for part in (_tests, _models, _compositions):
        for row, told in part(options):
            _say(row)
            rows.append(row)
            surprises += told
    for line in surprises:
        _say(f"  {line}")
    _say(f"{time.monotonic() - start:.0f} s, {len(surprises) or 'no'} surprises")
    if options.write and not surprises:
        text = "\n".join(f"- {row}" for row in rows)
        page = between_markers(PAGE.read_text(encoding="utf-8"), text, *MARKERS)
        PAGE.write_text(page, encoding="utf-8")
    return 1 if surprises else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--cache", type=Path, default=ROOT / "build" / "foreign", metavar="FOLDER", help="where packages are kept"
    )
    parser.add_argument(
        "--sample",
        type=int,
        metavar="N",
        help="of each suite at most N models, evenly spread; all where it is not given",
    )
    parser.add_argument("--fetch", action="store_true", help="fetch the packages, and no more")
    parser.add_argument("--write", action="store_true", help="put the numbers into docs/contributing/fidelity.md")
    return parser


def _tests(options: argparse.Namespace) -> Iterator[tuple[str, list[str]]]:
    """dm_control's own tests, and examples that need only another import."""
    title = f"dm_control {_pinned('dm_control')}, its own tests of `mjcf`"
    try:
        package = fetched("dm_control", options.cache) / "dm_control" / "mjcf"
        absl = fetched("absl-py", options.cache)
    except Unavailable as reason:
        yield f"{title}: skipped, {reason}", []
        return
    folder = options.cache / "rewritten"
    idle = rewriting.write_tests(package, folder)
    found = outcomes.run_tests(folder, [absl, HERE.parent, ROOT])
    groups = outcomes.intended()
    told = outcomes.surprises(found, groups)
    told += [f"no test needs the replacement of `{rename.before.pattern}`" for rename in idle]
    passed = sum(outcome.passed for outcome in found)
    meant = sum(not outcome.passed for outcome in found)
    yield (f"{title}: {len(found)} run, {passed} pass, {meant} fail for {len(groups)} intended differences", told)
    examples = [imports_changed.Example(file, (package.parents[1], absl)) for file in imports_changed.MADE]
    running = isolated.each(imports_changed.judge, examples, failed=imports_changed.failed, workers=_cores())
    verdicts = sorted(running, key=lambda each: each.id)
    row = f"dm_control {_pinned('dm_control')}, the examples of the page with its import: {len(verdicts)} models, {_counted(verdicts)[1]} equal by name and after 1 s of motion"
    yield row, strings.surprises(verdicts, {})


def _models(options: argparse.Namespace) -> Iterator[tuple[str, list[str]]]:
    """Models in the tests and data of packages."""
    for name in ("mujoco", *MODELS):
        try:
            package = _package(name, options.cache)
        except Unavailable as reason:
            yield f"{name}: skipped, {reason}", []
            continue
        sources = strings.found_in(package, name)
        chosen = _spread(sources, options.sample)
        # What is only read is quick: all models of a package that is no suite are.
        verdicts = _judged(strings.judge, chosen if name in SUITES - {"mujoco-warp"} else sources)
        loaded, same = _counted(verdicts)
        told = strings.surprises(verdicts, _of(name, strings.intended(), verdicts, sources))
        row = f"{name} {_pinned(name)}: {len(verdicts)} models, {loaded} load, {same} are the same"
        if name in SUITES:
            verdicts = _judged(turned.judge, chosen)
            loaded, same = _counted(verdicts)
            told += strings.surprises(verdicts, _of(name, strings.intended("turned"), verdicts, sources))
            row += f", {same} of {loaded} composed"
        yield row, told


def _compositions(options: argparse.Namespace) -> Iterator[tuple[str, list[str]]]:
    """What robosuite composes itself."""
    title = f"robosuite {_pinned('robosuite')}, its own merging of robot, mount and grippers"
    try:
        folder = fetched("robosuite", options.cache)
    except Unavailable as reason:
        yield f"{title}: skipped, {reason}", []
        return
    robots = _spread(merging.ROBOTS, options.sample)
    running = isolated.each(
        merging.judge, [merging.Merging(robot, folder) for robot in robots], failed=merging.failed, workers=_cores()
    )
    verdicts = sorted(running, key=lambda each: each.id)
    refused = {
        place: why for place, why in strings.intended("merged").items() if place in {each.id for each in verdicts}
    }
    row = f"{title}: {len(verdicts)} robots, {_counted(verdicts)[1]} equal by name and after 1 s of motion"
    yield row, strings.surprises(verdicts, refused)
    with tempfile.TemporaryDirectory() as place:
        cells = _spread(lift.build_all(folder, Path(place)), options.sample)
        running = isolated.each(lift.judge, cells, failed=lift.failed, workers=_cores())
        verdicts = sorted(running, key=lambda each: each.id)
    row = f"robosuite {_pinned('robosuite')}, the recipe of the page: {len(verdicts)} cells, {_counted(verdicts)[1]} are robosuite's model, and move as it does"
    yield row, strings.surprises(verdicts, {})


def _judged(judge: Callable[[Source], Verdict], sources: Sequence[Source]) -> list[Verdict]:
    running = isolated.each(judge, sources, failed=strings.failed, workers=_cores())
    return sorted(running, key=lambda each: each.id)


def _counted(verdicts: Sequence[Verdict]) -> tuple[int, int]:
    """How many load, and how many of these are as they should be."""
    loaded = [each for each in verdicts if each.loads]
    return len(loaded), sum(not each.said for each in loaded)


def _of(
    name: str, expected: Mapping[str, str], verdicts: Sequence[Verdict], sources: Sequence[Source]
) -> Mapping[str, str]:
    """The lines of a list that are of a package, without those of models that were left out of the sample."""
    left_out = {each.id for each in sources} - {each.id for each in verdicts}
    mine = {place: reason for place, reason in expected.items() if place.startswith(f"{name}/")}
    return {place: reason for place, reason in mine.items() if place not in left_out}


def _spread(every: Sequence[T], most: int | None) -> Sequence[T]:
    """At most that many, evenly spread."""
    return every if most is None else every[:: max(1, -(-len(every) // most))]


def _prefetch(name: str, cache: Path) -> None:
    with suppress(Unavailable):  # whoever needs it says why it is not there
        fetched(name, cache)


def _package(name: str, cache: Path) -> Path:
    if name in MODELS:
        return fetched(name, cache) / MODELS[name]
    spec = find_spec(name)
    assert spec is not None and spec.origin is not None
    return Path(spec.origin).parent


def _pinned(name: str) -> str:
    return pins()[name].partition("==")[2] if name in pins() else version(name)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _say(line: str) -> None:
    print(line, flush=True)  # noqa: T201


if __name__ == "__main__":
    sys.exit(main())
