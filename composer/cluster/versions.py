"""The versions that a worker must share with this process for its models to be the same bytes."""

from __future__ import annotations

from collections.abc import Mapping

from composer.cache.inputs import PACKAGES
from composer.cluster import probe
from composer.cluster.address import Client
from composer.cluster.error import ClusterError

_HELP = {
    "mjcompose": 'install the same mjcompose there: `pip install "mjcompose[cluster]"`, or the same checkout',
    "Python": "run its workers with the same Python, of which only the last number may differ",
}


def check_versions(client: Client, workers: list[str], packages: tuple[str, ...] = ()) -> None:
    """Raise ClusterError for the first worker with a relevant difference."""
    import cloudpickle

    pythons = client.get_versions(check=False)
    here = _minor(pythons["client"]["host"]["python"])
    for worker in workers:
        there = pythons["workers"].get(worker)
        if there is not None and (python := _minor(there["host"]["python"])) != here:
            raise _differs(worker, {"Python": (python, here)})
    names = tuple(dict.fromkeys((*PACKAGES, *packages)))
    cloudpickle.register_pickle_by_value(probe)
    try:
        answers = client.run(probe.versions, names, workers=workers, on_error="return")
    finally:
        cloudpickle.unregister_pickle_by_value(probe)
    mine = probe.versions(names)
    for worker, theirs in answers.items():
        if isinstance(theirs, OSError):
            continue  # it is gone
        if isinstance(theirs, BaseException):
            raise ClusterError("cluster-worker", f"the worker `{worker}` does not answer: {theirs}")
        different = {
            name: (theirs.get(name), mine.get(name))
            for name in ("mjcompose", *names, "zlib")
            if theirs.get(name) != mine.get(name)
        }
        if different:
            raise _differs(worker, different)


def _differs(worker: str, different: Mapping[str, tuple[str | None, str | None]]) -> ClusterError:
    name, (there, here) = next(iter(different.items()))
    has = f"has no `{name}`" if there is None else f"has {name} {there}, and here it is {here or 'absent'}"
    others = ", ".join(
        f"{other} {there or 'none'} instead of {here or 'none'}"
        for other, (there, here) in list(different.items())[1:]
    )
    return ClusterError(
        "cluster-worker",
        f"the worker `{worker}` {has}: it would not make the same models",
        _HELP.get(name, f"run `pip install '{name}=={here}'` there"),
        notes=(f"it differs in {others} too",) if others else (),
    )


def _minor(python: str) -> str:
    """Return a version without its last number, which changes no bytes.

    >>> _minor("3.11.7.final.0")
    '3.11'
    """
    return ".".join(python.split(".")[:2])
