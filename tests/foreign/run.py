"""Other projects' tests and models, with mjcompose: `make foreign`, or `python tests/foreign/run.py`.

dm_control's own tests of `dm_control.mjcf` run with `composer.mjcf`, and every MJCF model in the tests and data of packages
about MuJoCo is read, written and compiled. What is meant to be otherwise stands in `intended.toml` and `strings.toml`; the
run fails where anything else differs. The packages come from PyPI, by pip or uv, into a folder that is kept; one that
cannot be had is skipped, with the reason.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE.parent), str(ROOT)]

from fidelity import isolated  # noqa: E402
from fidelity.summary import between_markers  # noqa: E402
from foreign import outcomes, rewriting, strings  # noqa: E402
from foreign.fetching import Unavailable, fetched, pins  # noqa: E402

PAGE = ROOT / "docs" / "fidelity.md"
MARKERS = ("<!-- foreign: begin -->", "<!-- foreign: end -->")
# The folder of each package that has models, below what is fetched.
MODELS = {
    "mujoco-warp": "mujoco_warp",
    "mujoco-mjx": "mujoco/mjx",
    "brax": "brax",
    "dm_control": "dm_control",
}


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    options.cache = options.cache.resolve()
    if not version("mujoco").startswith("4."):
        _say(f"skipped: the lists of differences are of MuJoCo 4, this is {version('mujoco')}")
        return 0
    start = time.monotonic()
    rows: list[str] = []
    surprises: list[str] = []
    for part in (_tests, _models):
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
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--cache",
        type=Path,
        default=ROOT / "build" / "foreign",
        metavar="FOLDER",
        help="where packages are kept",
    )
    parser.add_argument("--write", action="store_true", help="put the numbers into docs/fidelity.md")
    return parser


def _tests(options: argparse.Namespace) -> Iterator[tuple[str, list[str]]]:
    """dm_control's own tests."""
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
    yield (
        f"{title}: {len(found)} run, {passed} pass, {meant} fail for {len(groups)} intended differences",
        told,
    )


def _models(options: argparse.Namespace) -> Iterator[tuple[str, list[str]]]:
    """Models in the tests and data of packages."""
    expected = strings.intended()
    for name in ("mujoco", *MODELS):
        try:
            package = _package(name, options.cache)
        except Unavailable as reason:
            yield f"{name}: skipped, {reason}", []
            continue
        sources = strings.found_in(package, name)
        running = isolated.each(strings.judge, sources, failed=strings.failed, workers=_cores())
        verdicts = sorted(running, key=lambda each: each.id)
        mine = {place: reason for place, reason in expected.items() if place.startswith(f"{name}/")}
        loaded = [each for each in verdicts if each.loads]
        same = sum(not each.said for each in loaded)
        row = f"{name} {_pinned(name)}: {len(verdicts)} models, {len(loaded)} load, {same} stay the same to the bit"
        yield row, strings.surprises(verdicts, mine)


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
