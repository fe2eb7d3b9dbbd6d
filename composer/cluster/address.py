"""Connect a client of Dask to the argument of `--cluster`: `local`, the file of a scheduler, or its address."""

from __future__ import annotations

import logging
import os
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from composer.cluster.error import ClusterError
from composer.scratch import scratch

Client: TypeAlias = Any
"""A `distributed.Client`."""
LOCAL = "local"
_ADDRESS = re.compile(r"(?:(?:tcp|tls|ws|wss|ucx)://)?[^/\s]+:\d+")
_SECONDS_TO_CONNECT = 15
_IDLE = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "10s",
}
"""Without these settings, idle processes of Dask use a tenth of a core."""


@contextmanager
def client_of(text: str, workers: int) -> Iterator[Client]:
    """Yield a client of the cluster that a text names; `local` starts this many workers here. Raises ClusterError."""
    try:
        import distributed
    except ImportError:
        raise _missing("distributed") from None
    with _silence():
        if text == LOCAL:
            with (
                _local(distributed, workers) as cluster,
                distributed.Client(cluster, set_as_default=False) as client,
            ):
                yield client
            return
        client = connected(text)
        try:
            yield client
        finally:
            client.close(timeout=2)


def _missing(package: str) -> ClusterError:
    return ClusterError(
        "cluster-missing",
        f"`--cluster` needs the Python package `{package}`, which is not installed",
        'run `pip install "mjcompose[cluster]"`',
    )


@contextmanager
def _silence() -> Iterator[None]:
    """Silence Dask's messages: mjcompose reports errors itself, and Dask would repeat them from several threads."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)


def connected(text: str) -> Client:
    """Return a client of a running cluster. Raises ClusterError."""
    import distributed

    known: dict[str, str] = {}
    if os.path.exists(text):
        known["scheduler_file"] = text
    elif _ADDRESS.fullmatch(text):
        known["address"] = text
    else:
        raise ClusterError(
            "cluster-unreachable",
            f"`{text}` is not a cluster: it is neither a file nor an address",
            "write `local`, an address such as `tls://head:8786`, or the file that `dask scheduler"
            " --scheduler-file FILE` writes",
        )

    class Connection(distributed.Client):  # type: ignore[misc]  # its types are not checked
        def __del__(self) -> None:
            """Do nothing: Dask's method waits for half a minute if there was never a connection; others are closed."""

    try:
        return Connection(**known, timeout=_SECONDS_TO_CONNECT, set_as_default=False)
    except Exception as error:  # Dask does not check whether a file is that of a scheduler, and fails later
        raise ClusterError(
            "cluster-unreachable",
            f"no scheduler of Dask answers at `{text}`",
            "see that `dask scheduler` runs there, and that its port can be reached from here; `tls:` needs the keys of"
            " the cluster in Dask's configuration",
            notes=(" ".join(str(error).split()) or type(error).__name__,),
        ) from error


@contextmanager
def _local(distributed: Any, workers: int) -> Iterator[Any]:
    """Start workers on this machine. Only this process has their key, because anyone who connects can run programs."""
    from dask import config
    from distributed.security import Security

    try:
        security = Security.temporary()
    except ImportError:  # Dask installs without it
        raise _missing("cryptography") from None
    # Where it is killed, Dask leaves folders and lock files of its scheduler and workers; the next run sweeps ours.
    with scratch("dask") as folder, config.set({**_IDLE, "temporary-directory": str(folder)}), distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, memory_limit=0,
        security=security, silence_logs=logging.CRITICAL, worker_dashboard_address=None,
    ) as cluster:  # fmt: skip
        yield cluster
