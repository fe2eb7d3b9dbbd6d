"""Builds that are killed: `make kills`, or `python tests/kills/run.py --kills 1000`.

A build of every kind of output is ended with `kill -9` at a random moment, in a project whose sources change from one build to
the next and whose store is empty now and then. After each kill every output is that of the edition before or of the
one after, as a whole, and nothing that the build started is alive a second later; the store holds no damaged file; and
the next build succeeds, gives what it gives undisturbed, and sweeps what the killed one left.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1])]

from kills.project import EDITIONS, OUTPUTS, Output, Project, Undisturbed, undisturbed  # noqa: E402

_CHECKED = 5
"""Every so many kills the store is hashed, and the builds that were killed are run again."""
_GONE = 1.0
"""Seconds in which all that a killed build started has ended."""


def kill(
    project: Project, outputs: Sequence[Output], count: int, seed: int, *, say: Callable[[str], None]
) -> Counter[str]:
    """End that many builds; gives how many outputs were old, new or not there. Raises AssertionError for the rest."""
    random = Random(seed)
    seen = Counter[str]()
    killed: set[str] = set()
    whole = {output.name: undisturbed(project, output) for output in outputs}
    for number in range(1, count + 1):
        output = random.choice(outputs)
        if random.random() < 0.3:
            _forget(project)
        edition = random.choice(EDITIONS)
        project.edit(edition)
        killed.add(output.name)
        _kill_one(project, output.words, random.uniform(0.02, 1.1 * whole[output.name].seconds))
        known = whole[output.name].digests
        for path, found in project.written(output).items():
            editions = [each for each, paths in known.items() if paths.get(path) == found]
            assert editions or _is_assets(project, path), f"{path} is neither old nor new after kill {number}"
            seen["new" if edition in editions else "old"] += 1
        if number % _CHECKED == 0 or number == count:
            again = [each for each in outputs if each.name in killed]
            _go_on(project, again, random.choice(EDITIONS), whole)
            seen["next builds"] += len(again)
            killed.clear()
        if number % 50 == 0:
            say(f"{number} kills: {dict(seen)}")
    return seen


def _forget(project: Project) -> None:
    """Empty the store, read-only as its files are."""
    shutil.rmtree(project.folder / "store", ignore_errors=True)
    (project.folder / "store").mkdir(exist_ok=True)


def _kill_one(project: Project, words: tuple[str, ...], seconds: float) -> None:
    process = project.start(words)
    time.sleep(seconds)
    process.kill()
    process.wait()
    assert process.stdout is not None
    process.stdout.close()
    end = time.monotonic() + _GONE
    try:
        while time.monotonic() < end:
            os.killpg(process.pid, 0)
            time.sleep(0.02)
    except ProcessLookupError:
        return
    os.killpg(process.pid, signal.SIGKILL)
    raise AssertionError("what a killed build started is alive a second later")


def _is_assets(project: Project, path: str) -> bool:
    """Whether it is a folder of shared assets in which every file is what its name says."""
    folder = project.folder / path
    if folder.name != "assets":
        return False
    from hashlib import sha256

    files = [each for each in folder.iterdir() if not each.name.startswith(".")]
    return all(each.stem.endswith(sha256(each.read_bytes()).hexdigest()[:16]) for each in files)


def _go_on(project: Project, outputs: list[Output], edition: str, whole: dict[str, Undisturbed]) -> None:
    """The next builds succeed and give what they give undisturbed; nothing in the store is damaged, nothing grows."""
    project.edit(edition)
    for output in outputs:
        code, said = project.run(output.words)
        assert code == 0, said
        written = project.written(output)
        for path, found in whole[output.name].digests[edition].items():
            assert path.endswith("/assets") or written.get(path) == found, f"{path} is not what it is undisturbed"
    code, said = project.run(("cache", "verify"))
    assert code == 0, said
    code, said = project.run(("cache", "prune"))
    assert code == 0, said
    assert not project.left_over(), project.left_over()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()

    def say(line: str) -> None:
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()

    with tempfile.TemporaryDirectory(prefix="mjcompose-kills-", ignore_cleanup_errors=True) as folder:
        project = Project(Path(folder))
        project.make()
        start = time.monotonic()
        seen = kill(project, OUTPUTS, options.kills, options.seed, say=say)
        say(f"{options.kills} kills in {time.monotonic() - start:.0f} s: all whole: {dict(seen)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
