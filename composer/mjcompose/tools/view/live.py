"""Run a server, watch its files, and open a browser."""

from __future__ import annotations

import html
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from threading import Event, Thread

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import Mark
from mjcompose.base.processes import open_in_browser
from mjcompose.base.scratch import scratch
from mjcompose.sources.context import Context
from mjcompose.tools.view.builder import FileWatch, Shown, Workshop, marks
from mjcompose.tools.view.server import PageServer

_PATIENCE = 0.5


class Service(Struct):
    """The address for a page, with flags for opening a browser and for changing recipes."""

    host: str = "127.0.0.1"
    port: int = 0
    opens: bool = True
    writes: bool = True


def started(workshop: Workshop, service: Service, context: Context) -> PageServer | None:
    """Return a listening server, or None if it cannot listen, which is reported."""
    try:
        return PageServer(workshop, service.host, service.port, writes=service.writes)
    except (OSError, OverflowError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        help = "omit `--port` for a free one" if service.port else "omit `--host`"
        message = f"the page cannot be served at {service.host}:{service.port}: {reason}"
        context.sink.error("no-server", message, help=help)
        return None


def serve(
    server: PageServer, opens: bool, say: Callable[[str], None], stop: Event, said: Callable[[Shown], None]
) -> None:
    """Build, serve, watch and build again until `stop` is set; `said` is called with the result of each build."""
    Thread(target=server.run, daemon=True).start()
    try:
        before = _build(server, said)
        for line in _invitation(server.address, opens):
            say(line)
        if not server.guard.is_private:
            say("others can reach this address, so the page is read-only")
        # In a thread of its own: a watch swallows the signals by which a terminal ends the command.
        failed: list[Exception] = []
        watching = Thread(target=lambda: failed.extend(_watch(server, before, stop, said=said)), daemon=True)
        with _opened(server.address) if opens and _no_browser() is None else nullcontext():
            watching.start()
            try:
                while watching.is_alive():
                    watching.join(_PATIENCE)
            finally:
                stop.set()
                server.workshop.session.end()  # a build that waits for MuJoCo
                watching.join(_PATIENCE)
        if failed:
            raise failed[0]
    finally:
        server.close()


def _watch(
    server: PageServer, before: dict[Path, Mark], stop: Event, said: Callable[[Shown], None]
) -> Iterator[Exception]:
    """Build again whenever a file changes, until `stop` is set; yield the exception that ends it sooner."""
    try:
        watch = FileWatch(stop)
        while watch.wait(before):
            before = _build(server, lambda shown: None if stop.is_set() else said(shown))
    except Exception as error:
        if not stop.is_set():
            yield error


@contextmanager
def _opened(address: str) -> Iterator[None]:
    """Open an address in the browser through a private file: other users can see the command line of a browser."""
    with scratch("view") as folder:
        page = folder / "open.html"
        shown = html.escape(address)
        with os.fdopen(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            file.write(
                "<!doctype html>\n<meta charset=utf-8>\n<title>mjcompose</title>\n"
                f'<meta http-equiv=refresh content="0; url={shown}">\n<a href="{shown}">{shown}</a>\n'
            )
        Thread(target=open_in_browser, args=(page.as_uri(),), daemon=True).start()
        yield


def _build(server: PageServer, said: Callable[[Shown], None]) -> dict[Path, Mark]:
    """Build and show the model; return the files that were read, with their marks from before the build."""
    workshop = server.workshop
    before = marks(workshop.inputs)
    shown = workshop.build()
    server.show(shown)
    said(shown)
    return {path: before.get(path, mark) for path, mark in marks(workshop.inputs).items()}


def _invitation(address: str, opens: bool) -> list[str]:
    reason = _no_browser() if opens else None
    port = address.split("/")[2].rpartition(":")[2]
    if reason == "ssh":
        host = [*os.environ.get("SSH_CONNECTION", "").split()[2:], "HOST"][0]
        ssh = f"ssh -L {port}:127.0.0.1:{port} {host}"
        return [address, f"on your own machine: {ssh}, then open the address there"]
    docker = f"with Docker start it with -p 127.0.0.1:{port}:{port}, and this with --host 0.0.0.0 --port {port}"
    return [address, *([f"in a container: forward the port {port}; {docker}"] if reason == "container" else [])]


def _no_browser() -> str | None:
    if os.environ.get("SSH_CONNECTION") or os.environ.get("SSH_TTY"):
        return "ssh"
    is_container = os.path.exists("/.dockerenv") or os.path.exists("/run/.containerenv")
    if is_container or os.environ.get("KUBERNETES_SERVICE_HOST"):
        return "container"
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return "no display"
    return None
