"""Model references to MuJoCo Menagerie: through its package, or in a folder that `MENAGERIE_ROOT` names."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources import license, reference as forms
from mjcompose.sources.fetching import Fetching, Lookup, not_at_hand
from mjcompose.sources.reference import Form, Library, Origin, Reference, Source, SourceError, SourceKind, malformed

_PACKAGE = "mujoco-menagerie"
_FORM = Form(
    "menagerie:ROBOT/ENTRY",
    "a robot of MuJoCo Menagerie, through the `mujoco-menagerie` package; without `/ENTRY`, the robot's own model",
)
_ROOT = "MENAGERIE_ROOT"
_WITHOUT_NETWORK = "without a network, set `MENAGERIE_ROOT` to a folder that holds the robots"


def _parse(text: str) -> Reference:
    robot, slash, entry = forms.bare(text, _FORM).partition("/")
    if not robot or (slash and not entry):
        raise malformed(text, _FORM, "does not say " + ("the entry" if robot else "the robot"))
    return Reference(text, MENAGERIE, robot, path=entry)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the model of a robot of Menagerie by its entry; without an entry, the robot's own model, never its scene.

    If `MENAGERIE_ROOT` is set in the environment, it is a folder with one subfolder for each robot: nothing is
    downloaded, and the package is not needed. Otherwise the package downloads a robot on first use and keeps it.
    `MENAGERIE_CACHE_DIR` and `MENAGERIE_BASE_URL` have the same meaning as in the package. Raises SourceError.
    """
    library = _library()
    root = lookup.environment.get(_ROOT)
    if root:
        return _in_root(library, Path(root), reference)
    if library is None:
        message = f"`{reference.text}` needs the Python package `{_PACKAGE}`, which is not installed"
        notes = (f"or set `{_ROOT}` to a folder with the robots, such as a clone of MuJoCo Menagerie",)
        raise SourceError("source-not-found", message, notes=notes, help='run `pip install "mjcompose[menagerie]"`')
    return _from_package(library, reference, lookup)


def known_models(environment: Mapping[str, str]) -> Iterator[tuple[str, str, bool]]:
    """Yield the robots and entries that a reference can name, and whether the entry is the robot's own model."""
    library = _library()
    root = environment.get(_ROOT)
    if root:
        for robot in _robots_in(Path(root)):
            entries = _entries_in(Path(root, robot))
            own_model = _own_model(library, robot, entries)
            yield from ((robot, entry, entry == own_model) for entry in entries)
    elif library is not None:
        for robot in library.names():
            known = library.get(robot)
            yield from ((robot, entry.name, entry.name == known.default_model) for entry in known.entry_points)


def _robots_in(root: Path) -> list[str]:
    return sorted(robot.name for robot in root.glob("*/")) if os.path.isdir(root) else []


def _entries_in(folder: Path) -> list[str]:
    return sorted(file.stem for file in folder.glob("*.xml"))


def _library() -> Any | None:
    try:
        return import_module("mujoco_menagerie")
    except ImportError:
        return None


def _in_root(library: Any | None, root: Path, reference: Reference) -> Source:
    """Return a model of a folder of one's own; its files need not belong to the installed version of the package."""
    robots = _robots_in(root)
    name = reference.name
    folder = root / name
    if name not in robots:
        _check_robot(robots if library is None else [*robots, *library.names()], reference)
        message = f"the robot `{name}` is not in the folder that `{_ROOT}` names"
        notes = (f"looked for `{folder}`", exists_note("folder", robots, near=name).message)
        raise SourceError("source-not-found", message, notes=notes)
    entries = _entries_in(folder)
    entry = reference.path or _own_model(library, name, entries)
    if not entry:
        message = f"`{reference.text}` does not say which model of `{folder}`"
        existing = exists_note("entry", entries).message
        help = f"write `menagerie:{name}/{entries[0]}`" if entries else None
        raise SourceError("source-not-found", message, notes=(existing,), help=help)
    _check_entry(name, entry, entries)
    return _source(reference, folder / f"{entry}.xml", folder)


def _own_model(library: Any | None, robot: str, entries: list[str]) -> str | None:
    """Return the entry of the robot alone: as the package says it, or the only one that is not a scene."""
    if library is not None and robot in library.names():
        own_model: str = library.get(robot).default_model
        return own_model
    models = [entry for entry in entries if not entry.startswith("scene")]
    return models[0] if len(models) == 1 else None


def _from_package(library: Any, reference: Reference, lookup: Lookup) -> Source:
    _check_robot(library.names(), reference)
    robot = library.get(reference.name)
    files = {entry.name: entry.file for entry in robot.entry_points}
    entry = reference.path or robot.default_model
    _check_entry(robot.name, entry, list(files))
    folder = _download(library, robot, reference, lookup.environment, lookup.fetching)
    path = folder / files[entry]
    if not os.path.isfile(path):
        message = f"`{folder}` has no `{files[entry]}`, which `{reference.text}` stands for"
        notes = (exists_note("XML file", sorted(file.name for file in folder.glob("*.xml"))).message,)
        raise SourceError("source-not-found", message, notes=notes)
    return _source(reference, path, folder, library.__version__, library.commit(), robot.oid)


def _source(
    reference: Reference,
    path: Path,
    folder: Path,
    version: str | None = None,
    commit: str | None = None,
    tree: str | None = None,
) -> Source:
    return Source(
        path,
        reference.kind,
        reference.text,
        package=_PACKAGE,
        version=version,
        licenses=license.find(path, folder),
        origin=Origin(reference.id, reference.kind, folder, commit=commit, tree=tree),
    )


def _check_robot(names: list[str], reference: Reference) -> None:
    if reference.name in names:
        return
    likely = closest(reference.name, names, 3) + [name for name in names if reference.name.lower() in name]
    rest = f"/{reference.path}" if reference.path else ""
    message = f"MuJoCo Menagerie has no robot `{reference.name}`"
    help = f"write `menagerie:{likely[0]}{rest}`" if likely else None
    raise SourceError("source-not-found", message, notes=(exists_note("robot", [*likely, *names]).message,), help=help)


def _check_entry(robot: str, entry: str, entries: list[str]) -> None:
    if entry in entries:
        return
    likely = closest(entry.removesuffix(".xml"), entries)
    message = f"the robot `{robot}` of MuJoCo Menagerie has no entry `{entry}`"
    help = f"write `menagerie:{robot}/{likely[0]}`" if likely else None
    raise SourceError("source-not-found", message, notes=(exists_note("entry", entries).message,), help=help)


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


def _download(
    library: Any, robot: Any, reference: Reference, environment: Mapping[str, str], fetching: Fetching
) -> Path:
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


MENAGERIE = SourceKind(
    name="menagerie",
    forms=(_FORM,),
    local_schemes=(),
    separator="/",
    is_local=False,
    is_fetched=False,
    runs_code=False,
    pins=frozenset({"commit", "tree", "package", "version"}),
    # The last two determine the folder of the package's downloads.
    variables=("MENAGERIE_ROOT", "MENAGERIE_CACHE_DIR", "MENAGERIE_BASE_URL", "XDG_CACHE_HOME", "HOME"),
    libraries=(Library(_PACKAGE, "menagerie"),),
    parse=_parse,
    resolve=_resolve,
    host=forms.no_host,
    is_of_this_machine=forms.never,
)
