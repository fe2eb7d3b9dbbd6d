"""Hostile input, made up: `make fuzz`, or `python tests/fuzz/run.py --seconds 60 --targets recipe mjcf`.

Each target starts from the project's own recipes and models, and from those of the corpus that MJCOMPOSE_CORPUS names, and
changes them. A case is wrong where it raises, ends the process, takes more than 20 s or 2 GiB, or where MuJoCo compiles the
source and not what is composed of it, or the other way. What is found lies in build/fuzz/TARGET; a file that is put into
tests/fuzz/cases/TARGET is run by the tests from then on. The same seed makes the same cases.
"""

from __future__ import annotations

import argparse
import contextlib
import faulthandler
import hashlib
import multiprocessing
import os
import re
import signal
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE.parent), str(ROOT)]

from fuzz.execution import SECONDS, seeds_of, wrong_with  # noqa: E402
from fuzz.target import Tools, limits  # noqa: E402
from fuzz.targets.table import TARGETS  # noqa: E402
from mjcompose.mujoco.engine import Session  # noqa: E402

_MEMORY = 2 << 30
_STARTING = 180
"""Seconds that a worker has for its first case: on a busy machine it takes a minute to import all and start a server."""
_KEPT = 2
"""Cases of one kind that are kept."""


def _work(name: str, seed: int, seconds: float, current: Path, told: Connection) -> None:
    """Run cases of a target for some seconds; a message for each is `None`, or what is wrong and the case."""
    os.setpgrp()
    _limit_memory()
    os.environ |= {"MJCOMPOSE_TRACEBACK": "1", "MJCOMPOSE_CACHE": str(current.parent / "store")}
    stack = (current.parent / "stack").open("w+", encoding="utf-8")
    faulthandler.register(signal.SIGUSR1, stack)
    target = TARGETS[name]
    random = Random(f"{name} {seed}")
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    with Session(limits()) as session:
        tools = Tools(session)
        seeds = seeds_of(target, Path(corpus) if corpus else None)
        pool = [each.data for each in seeds]
        end = time.monotonic() + seconds
        with open(os.devnull, "w", encoding="utf-8") as nothing, contextlib.redirect_stdout(nothing):
            while time.monotonic() < end:
                begin = random.choice(seeds)
                data = begin.data
                for _ in range(random.choice((1, 1, 2, 3))):
                    data = target.mutate(data, random, pool)
                current.write_bytes(data)
                wrong = wrong_with(target, data, begin.beside, tools)
                told.send(None if wrong is None else (wrong, data))
    told.send(())


def _limit_memory() -> None:
    if sys.platform == "linux":
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))


def fuzz(name: str, seconds: float, seed: int, out: Path) -> tuple[int, Counter[str]]:
    """How many cases were run, and what was found how often; a worker that dies or hangs is followed by another."""
    target = TARGETS[name]
    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    current = folder / f"current{target.suffix}"
    count = 0
    found = Counter[str]()
    round_ = 0
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        here, there = multiprocessing.Pipe(duplex=False)
        arguments = (name, seed + round_ * 1_000_003, left, current, there)
        worker = multiprocessing.get_context("spawn").Process(target=_work, args=arguments)
        worker.start()
        there.close()
        patience = _STARTING
        while True:
            try:
                wrong = here.recv() if here.poll(patience) else (_hang(worker, current), current.read_bytes())
            except EOFError:
                worker.join()
                wrong = f"ended-{worker.exitcode}", current.read_bytes()
            patience = SECONDS * 2  # the check itself says so above 20 s, where it comes to an end
            if wrong == ():
                break
            count += 1
            if wrong is not None:
                kind = _kind(wrong[0])
                found[kind] += 1
                if found[kind] <= _KEPT:
                    _keep(wrong[1], folder / kind, wrong[0], target.suffix)
                if kind == "hang" or kind.startswith("ended"):
                    break
        _end(worker)
        round_ += 1
    current.unlink(missing_ok=True)
    (folder / "stack").unlink(missing_ok=True)
    return count, found


def _hang(worker: multiprocessing.process.BaseProcess, current: Path) -> str:
    """Where a worker hangs. It may be in the change that makes the next case, and not in the case that is kept."""
    stack = current.parent / "stack"
    if worker.pid is not None and stack.exists():
        with contextlib.suppress(ProcessLookupError):
            os.kill(worker.pid, signal.SIGUSR1)
        time.sleep(1)
        return f"hang\n{stack.read_text(encoding='utf-8')}"
    return "hang"


def _kind(wrong: str) -> str:
    first = wrong.splitlines()[0].partition(": ")[0]
    return re.sub(r"[^\w.-]+", "-", first)[:80]


def _keep(data: bytes, folder: Path, wrong: str, suffix: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    name = hashlib.sha256(data).hexdigest()[:10]
    (folder / f"{name}{suffix}").write_bytes(data)
    (folder / f"{name}.said").write_text(wrong, encoding="utf-8", errors="backslashreplace")


def _end(worker: multiprocessing.process.BaseProcess) -> None:
    """End a worker and all that it has started."""
    worker.join(5)
    if worker.is_alive() and worker.pid is not None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(worker.pid, signal.SIGKILL)
        worker.join()


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60, help="for each target (default: 60)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--targets", nargs="+", choices=sorted(TARGETS), default=list(TARGETS))
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "fuzz")
    options = parser.parse_args()
    options.out = options.out.resolve()
    total = 0

    def one(name: str) -> tuple[int, Counter[str]]:
        return fuzz(name, options.seconds, options.seed, options.out)

    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:  # each waits for a process of its own
        results = list(pool.map(one, options.targets))
    for name, (count, found) in zip(options.targets, results, strict=True):
        total += sum(found.values())
        told = ", ".join(f"{kind} ({number})" for kind, number in found.most_common()) or "nothing found"
        _say(f"{name}: {count} cases in {options.seconds:g} s: {told}")
    if total:
        _say(f"see {options.out}")
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
