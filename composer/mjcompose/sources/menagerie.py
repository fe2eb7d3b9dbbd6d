"""Model references to MuJoCo Menagerie, through the package `mujoco-menagerie`."""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources import license
from mjcompose.sources.fetching import Fetching, Lookup, not_at_hand
from mjcompose.sources.reference import (
    Form,
    Library,
    Origin,
    Reference,
    Source,
    SourceError,
    SourceKind,
    bare,
    malformed,
    never,
    no_host,
)

_PACKAGE = "mujoco-menagerie"
_FORM = Form(
    "menagerie:ROBOT/ENTRY",
    "a robot of MuJoCo Menagerie, through the `mujoco-menagerie` package; without `/ENTRY` the robot's own model",
)
_WITHOUT_NETWORK = "without a network, set `MENAGERIE_ROOT` to a folder that holds the robots"


def _parse(text: str) -> Reference:
    robot, slash, entry = bare(text, _FORM).partition("/")
    if not robot or (slash and not entry):
        raise malformed(text, _FORM, "does not say " + ("the entry" if robot else "the robot"))
    return Reference(text, KIND, robot, path=entry)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the model of a robot of Menagerie by its entry; without one the robot's own model, never its scene.

    The package downloads a robot on first use and keeps it. If `MENAGERIE_ROOT` is set in the environment, it is a
    folder with one subfolder for each robot, and nothing is downloaded. `MENAGERIE_CACHE_DIR` and
    `MENAGERIE_BASE_URL` have the same meaning as in the package. Raises SourceError.
    """
    environment, fetching = lookup.environment, lookup.fetching
    try:
        library: Any = import_module("mujoco_menagerie")
    except ImportError:
        message = f"`{reference.text}` needs the Python package `{_PACKAGE}`, which is not installed"
        raise SourceError("source-not-found", message, help='run `pip install "mjcompose[menagerie]"`') from None
    robot = _robot(library, reference)
    entry = _entry(robot, reference)
    folder = _folder(library, robot, reference, environment=environment, fetching=fetching)
    path = folder / entry.file
    if not os.path.isfile(path):
        message = f"`{folder}` has no `{entry.file}`, which `{reference.text}` stands for"
        notes = (exists_note("XML file", sorted(each.name for each in folder.glob("*.xml"))).message,)
        raise SourceError("source-not-found", message, notes=notes)
    # The files in a given folder need not be those of the installed version.
    is_own = not environment.get("MENAGERIE_ROOT")
    return Source(
        path, reference.kind, reference.text, package=_PACKAGE, version=library.__version__ if is_own else None,
        licenses=license.find(path, folder),
        origin=Origin(
            reference.id, reference.kind, folder,
            commit=library.commit() if is_own else None, tree=robot.oid if is_own else None,
        ),
    )  # fmt: skip


def _robot(library: Any, reference: Reference) -> Any:
    names: list[str] = library.names()
    if reference.name in names:
        return library.get(reference.name)
    within = [name for name in names if reference.name.lower() in name]
    likely = closest(reference.name, names, 3) + within
    rest = f"/{reference.path}" if reference.path else ""
    message = f"MuJoCo Menagerie has no robot `{reference.name}`"
    help = f"write `menagerie:{likely[0]}{rest}`" if likely else None
    raise SourceError("source-not-found", message, notes=(exists_note("robot", [*likely, *names]).message,), help=help)


def _entry(robot: Any, reference: Reference) -> Any:
    wanted = reference.path or robot.default_model
    for entry in robot.entry_points:
        if entry.name == wanted:
            return entry
    names = [entry.name for entry in robot.entry_points]
    likely = closest(wanted.removesuffix(".xml"), names)
    message = f"the robot `{robot.name}` of MuJoCo Menagerie has no entry `{wanted}`"
    help = f"write `menagerie:{robot.name}/{likely[0]}`" if likely else None
    raise SourceError("source-not-found", message, notes=(exists_note("entry", names).message,), help=help)


def _check_server(url: str, reference: Reference) -> None:
    """Fail at once if the server's name cannot be resolved: the package would retry for ten seconds."""
    import socket
    from urllib.parse import urlsplit
    from urllib.request import getproxies, proxy_bypass  # slow to import, and only a download needs it

    host = urlsplit(url).hostname
    if not host or (set(getproxies()) & {"http", "https", "all"} and not proxy_bypass(host)):
        return  # a folder, or a proxy that resolves the name
    try:
        socket.getaddrinfo(host, None)
    except OSError as error:
        message = f"`{reference.text}` could not be fetched: the name of its server cannot be resolved"
        notes = (f"{host}: {(error.strerror or str(error)).lower()}",)
        raise SourceError("source-not-found", message, notes=notes, help=_WITHOUT_NETWORK) from None


def _folder(library: Any, robot: Any, reference: Reference, environment: Mapping[str, str], fetching: Fetching) -> Path:
    root = environment.get("MENAGERIE_ROOT")
    if root:
        folder = Path(root, robot.name)
        if os.path.isdir(folder):
            return folder
        existing = sorted(each.name for each in Path(root).glob("*/")) if os.path.isdir(root) else []
        message = f"the robot `{robot.name}` is not in the folder that `MENAGERIE_ROOT` names"
        notes = (f"looked for `{folder}`", exists_note("folder", existing, near=robot.name).message)
        raise SourceError("source-not-found", message, notes=notes)
    cache = library.Cache(
        dir=environment.get("MENAGERIE_CACHE_DIR"), base_url=environment.get("MENAGERIE_BASE_URL"), root=None
    )
    cache.root = None
    if not cache.is_cached(robot):
        if fetching.offline:
            raise not_at_hand(reference, f"the cache of `{_PACKAGE}`")
        fetching.progress(f"fetching {reference.id}")
        _check_server(cache.base_url, reference)
    try:
        return Path(robot.path(cache))
    except (library.MenagerieError, OSError) as fault:
        message = f"`{reference.text}` could not be fetched"
        raise SourceError("source-not-found", message, notes=(str(fault),), help=_WITHOUT_NETWORK) from fault


KIND = SourceKind(
    name="menagerie", forms=(_FORM,), local_schemes=(), separator="/", is_local=False, is_fetched=False,
    runs_code=False, pins=frozenset({"commit", "tree", "package", "version"}),
    # The last two determine the folder of the package's downloads.
    variables=("MENAGERIE_ROOT", "MENAGERIE_CACHE_DIR", "MENAGERIE_BASE_URL", "XDG_CACHE_HOME", "HOME"),
    libraries=(Library(_PACKAGE, "menagerie"),), parse=_parse, resolve=_resolve, host=no_host, is_of_this_machine=never,
)  # fmt: skip
