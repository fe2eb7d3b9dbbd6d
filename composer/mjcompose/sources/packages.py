"""Model references to installed Python packages, to MuJoCo Menagerie and to `robot_descriptions`."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from importlib import import_module
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from mjcompose.base.files import read_regular
from mjcompose.base.processes import PIPE, Overrun, Process, isolated, module_path
from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources import fetching as nearby, license, reference as forms
from mjcompose.sources.fetching import Fetching, Lookup, not_at_hand
from mjcompose.sources.reference import Form, Library, Origin, Reference, Source, SourceError, SourceKind, malformed

if TYPE_CHECKING:
    from importlib.metadata import Distribution


_PACKAGE_FORM = Form("package:NAME/path/in/package.xml", "a file inside an installed Python package")


def _parse_package(text: str) -> Reference:
    name, _, path = forms.bare(text, _PACKAGE_FORM).partition("/")
    if not name or not path.strip("/"):
        lacks = "the file inside the package" if name else "the package"
        raise malformed(text, _PACKAGE_FORM, f"does not say {lacks}")
    # Hyphens pass: a later error names the package for a distribution name as in `pip install`.
    if not all(part.replace("-", "_").isidentifier() for part in name.split(".")):
        raise malformed(text, _PACKAGE_FORM, f"names `{name}`, which cannot be a Python package")
    return Reference(text, PACKAGE, name, path=path)


def _resolve_package(reference: Reference, lookup: Lookup) -> Source:
    inside = PurePosixPath(reference.path)
    if inside.is_absolute() or ".." in inside.parts:
        raise SourceError("source-kind", f"the model reference `{reference.text}` leaves the package")
    roots = folders(reference.name)
    if not roots:
        raise _not_installed(reference)
    if not forms.has_format(inside):
        raise nearby.without_suffix(reference.text, _existing(reference, roots))
    for root in roots:
        wanted = root / inside
        if os.path.isfile(wanted):
            return _found(reference, wanted, root)
    raise nearby.not_found(reference.text, roots[0] / inside, _existing(reference, roots))


def folders(name: str) -> list[Path]:
    """Return the folders of an installed package, several for a namespace package, without importing it."""
    top, *rest = name.split(".")
    spec = _spec(top)
    if spec is None or spec.submodule_search_locations is None:
        return []
    candidates = (Path(location, *rest) for location in spec.submodule_search_locations)
    return [folder for folder in candidates if os.path.isdir(folder)]


def _spec(top: str) -> ModuleSpec | None:
    try:
        return find_spec(top)
    except (ImportError, ValueError):
        return None


def distribution(name: str) -> Distribution | None:
    """Return the distribution that installed the package `name`, according to its list of files."""
    from importlib import metadata

    top = name.partition(".")[0]
    with suppress(metadata.PackageNotFoundError):
        same_name = metadata.distribution(top)
        if any(file.parts[0] == top for file in same_name.files or ()):
            return same_name
    owners = metadata.packages_distributions().get(top, [])
    return metadata.distribution(owners[0]) if owners else None


def _found(reference: Reference, path: Path, root: Path) -> Source:
    owner = distribution(reference.name)
    licenses = license.find(path, root)
    if not licenses and owner is not None:
        licenses = tuple(sorted(_licenses_of(owner)))
    return Source(
        path,
        reference.kind,
        reference.text,
        package=owner.metadata["Name"] if owner is not None else reference.name,
        version=owner.version if owner is not None else None,
        licenses=licenses,
        origin=Origin(reference.id, reference.kind, root),
        license=None if owner is None else _license_of(owner),
    )


def _license_of(owner: Distribution) -> str | None:
    metadata = owner.metadata
    expression, written = ((metadata.get_all(name) or [None])[0] for name in ("License-Expression", "License"))
    return license.of_package(expression, written, metadata.get_all("Classifier") or ())


def _licenses_of(owner: Distribution) -> Iterator[Path]:
    for file in owner.files or ():
        is_license = license.is_license(file.name) or "licenses" in file.parts[1:-1]
        if is_license and file.parts[0].endswith((".dist-info", ".egg-info")):
            path = Path(str(owner.locate_file(file)))
            if os.path.isfile(path):
                yield path


def _existing(reference: Reference, roots: list[Path]) -> list[str]:
    return [f"package:{reference.name}/{each}" for root in roots for each in nearby.model_files(root, depth=6)]


def _not_installed(reference: Reference) -> SourceError:
    from importlib import metadata

    name = reference.name
    text = reference.text
    spec = _spec(name.partition(".")[0])
    if spec is not None and spec.submodule_search_locations is None:
        return SourceError("source-not-found", f"`{name}` is a Python module without a folder, in `{text}`")
    known = {top: owners for top, owners in metadata.packages_distributions().items() if top.isidentifier()}
    # The user may have written the distribution name, as in `pip install`, instead of the import name.
    named = [top for top, owners in known.items() if _normalised(name) in map(_normalised, owners)]
    near = named or closest(name, (top for top in known if not top.startswith("_")))
    fix = f"write `package:{near[0]}/{reference.path}`" if near else "install the package with the model"
    return SourceError("source-not-found", f"no Python package `{name}` is installed, in `{text}`", help=fix)


def _normalised(distribution_name: str) -> str:
    return re.sub(r"[-_.]+", "_", distribution_name).lower()


PACKAGE = SourceKind(
    name="package",
    forms=(_PACKAGE_FORM,),
    local_schemes=(),
    separator="/",
    is_local=False,
    is_fetched=False,
    runs_code=False,
    pins=frozenset({"package", "version"}),
    variables=("PYTHONPATH",),
    libraries=(),
    parse=_parse_package,
    resolve=_resolve_package,
    host=forms.no_host,
    is_of_this_machine=forms.always,
)


_MENAGERIE_PACKAGE = "mujoco-menagerie"
_MENAGERIE_FORM = Form(
    "menagerie:ROBOT/ENTRY",
    "a robot of MuJoCo Menagerie, through the `mujoco-menagerie` package; without `/ENTRY`, the robot's own model",
)
_WITHOUT_NETWORK = "without a network, set `MENAGERIE_ROOT` to a folder that holds the robots"


def _parse_menagerie(text: str) -> Reference:
    robot, slash, entry = forms.bare(text, _MENAGERIE_FORM).partition("/")
    if not robot or (slash and not entry):
        raise malformed(text, _MENAGERIE_FORM, "does not say " + ("the entry" if robot else "the robot"))
    return Reference(text, MENAGERIE, robot, path=entry)


def _resolve_menagerie(reference: Reference, lookup: Lookup) -> Source:
    """Return the model of a robot of Menagerie by its entry; without an entry, the robot's own model, never its scene.

    The package downloads a robot on first use and keeps it. If `MENAGERIE_ROOT` is set in the environment, it is a
    folder with one subfolder for each robot, and nothing is downloaded, but the package is still needed.
    `MENAGERIE_CACHE_DIR` and `MENAGERIE_BASE_URL` have the same meaning as in the package. Raises SourceError.
    """
    environment = lookup.environment
    fetching = lookup.fetching
    try:
        library: Any = import_module("mujoco_menagerie")
    except ImportError:
        message = f"`{reference.text}` needs the Python package `{_MENAGERIE_PACKAGE}`, which is not installed"
        notes = ("`MENAGERIE_ROOT` names the folder of the robots; the package knows their entries",)
        help = 'run `pip install "mjcompose[menagerie]"`'
        used = notes if environment.get("MENAGERIE_ROOT") else ()
        raise SourceError("source-not-found", message, notes=used, help=help) from None
    robot = _robot(library, reference)
    entry = _entry(robot, reference)
    folder = _folder(library, robot, reference, environment=environment, fetching=fetching)
    path = folder / entry.file
    if not os.path.isfile(path):
        message = f"`{folder}` has no `{entry.file}`, which `{reference.text}` stands for"
        notes = (exists_note("XML file", sorted(each.name for each in folder.glob("*.xml"))).message,)
        raise SourceError("source-not-found", message, notes=notes)
    # The files in a given folder need not belong to the installed version.
    is_own = not environment.get("MENAGERIE_ROOT")
    return Source(
        path,
        reference.kind,
        reference.text,
        package=_MENAGERIE_PACKAGE,
        version=library.__version__ if is_own else None,
        licenses=license.find(path, folder),
        origin=Origin(
            reference.id,
            reference.kind,
            folder,
            commit=library.commit() if is_own else None,
            tree=robot.oid if is_own else None,
        ),
    )


def _robot(library: Any, reference: Reference) -> Any:
    names: list[str] = library.names()
    if reference.name in names:
        return library.get(reference.name)
    likely = closest(reference.name, names, 3) + [name for name in names if reference.name.lower() in name]
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
            raise not_at_hand(reference, f"the cache of `{_MENAGERIE_PACKAGE}`")
        fetching.progress(f"fetching {reference.id}")
        _check_server(cache.base_url, reference)
    try:
        return Path(robot.path(cache))
    except (library.MenagerieError, OSError) as fault:
        message = f"`{reference.text}` could not be fetched"
        raise SourceError("source-not-found", message, notes=(str(fault),), help=_WITHOUT_NETWORK) from fault


MENAGERIE = SourceKind(
    name="menagerie",
    forms=(_MENAGERIE_FORM,),
    local_schemes=(),
    separator="/",
    is_local=False,
    is_fetched=False,
    runs_code=False,
    pins=frozenset({"commit", "tree", "package", "version"}),
    # The last two determine the folder of the package's downloads.
    variables=("MENAGERIE_ROOT", "MENAGERIE_CACHE_DIR", "MENAGERIE_BASE_URL", "XDG_CACHE_HOME", "HOME"),
    libraries=(Library(_MENAGERIE_PACKAGE, "menagerie"),),
    parse=_parse_menagerie,
    resolve=_resolve_menagerie,
    host=forms.no_host,
    is_of_this_machine=forms.never,
)


_DESCRIPTIONS_PACKAGE = "robot_descriptions"
_DESCRIPTIONS_FORM = Form("descriptions:NAME", "a model that the `robot_descriptions` package names")
_DESCRIPTIONS_CACHE = "ROBOT_DESCRIPTIONS_CACHE"
_TRANSPORTS = "GIT_ALLOW_PROTOCOL"
_CLONING = 1800.0
_MOST_PATHS = 1 << 20


def _parse_descriptions(text: str) -> Reference:
    name = forms.bare(text, _DESCRIPTIONS_FORM)
    if not name.isidentifier():
        raise malformed(text, _DESCRIPTIONS_FORM, "does not name a description")
    return Reference(text, DESCRIPTIONS, name, path="")


def _resolve_descriptions(reference: Reference, lookup: Lookup) -> Source:
    """Return the MJCF file of a description, or its URDF file if it has no MJCF. Raises SourceError.

    Importing a description runs the package's code, which clones a repository on first use.
    """
    roots = folders(_DESCRIPTIONS_PACKAGE)
    if not roots:
        message = f"`{reference.text}` needs the Python package `{_DESCRIPTIONS_PACKAGE}`, which is not installed"
        raise SourceError("source-not-found", message, help=f"run `pip install {_DESCRIPTIONS_PACKAGE}`")
    names = sorted(
        file.stem for root in roots for file in root.glob("*_description.py") if not file.name.startswith("_")
    )
    if reference.name not in names:
        raise _unknown(reference.name, names)
    description = _load(reference, lookup.fetching)
    path = _model_file(description, reference)
    owner = distribution(_DESCRIPTIONS_PACKAGE)
    written = description.get("REPOSITORY_PATH")
    repository = Path(written) if written else None
    commit = None if repository is None else _commit(repository)
    return Source(
        path,
        reference.kind,
        reference.text,
        package=_DESCRIPTIONS_PACKAGE,
        version=owner.version if owner is not None else None,
        licenses=license.find(path, repository),
        origin=Origin(reference.id, reference.kind, repository or path.parent, commit=commit),
    )


def _commit(repository: Path) -> str | None:
    """Return the commit that the package has checked out by its hash, or None for any other state."""
    try:
        head = read_regular(repository / ".git" / "HEAD", 1024).decode("ascii").strip()
    except (OSError, ValueError):
        return None
    return head if forms.is_commit(head) else None


def _load(reference: Reference, fetching: Fetching) -> Mapping[str, str | None]:
    """Return the paths of a description by their names in its module. Raises SourceError."""
    own = dict(os.environ)
    if fetching.offline:
        own[_TRANSPORTS] = "none"
    cache = own.get(_DESCRIPTIONS_CACHE)
    if cache:
        own[_DESCRIPTIONS_CACHE] = os.path.abspath(os.path.expanduser(cache))
    script = str(Path(__file__).with_name("description.py"))
    command = isolated(sys.executable, [script, json.dumps(module_path()), f"{_DESCRIPTIONS_PACKAGE}.{reference.name}"])
    try:
        with Process(command, env=own, stdout=PIPE) as process:
            out, _ = process.finish(seconds=_CLONING, most=_MOST_PATHS)
        answer: dict[str, str | None] = json.loads(out)
    except (OSError, Overrun, ValueError) as fault:
        answer = {"error": str(fault)}
    why = answer.get("error")
    if why is None:
        return answer
    if fetching.offline:
        raise not_at_hand(reference, f"the cache of `{_DESCRIPTIONS_PACKAGE}`")
    raise SourceError("source-not-found", f"`{reference.text}` could not be fetched", notes=(why,))


def _model_file(description: Mapping[str, str | None], reference: Reference) -> Path:
    for attribute in ("MJCF_PATH", "URDF_PATH"):
        written = description.get(attribute)
        if written is None:
            continue
        path = Path(written)
        if not os.path.isfile(path) or not forms.has_format(path):
            raise SourceError("source-not-found", f"`{reference.text}` stands for `{path}`, which is not a model file")
        return path
    raise SourceError("source-kind", f"`{reference.text}` has neither MJCF nor URDF")


def _unknown(name: str, names: list[str]) -> SourceError:
    likely = [each for each in (f"{name}_mj_description", f"{name}_description") if each in names]
    likely += closest(name, names, 3)
    notes = (exists_note("description", [*likely, *names]).message,)
    help = f"write `descriptions:{likely[0]}`" if likely else None
    message = f"`{_DESCRIPTIONS_PACKAGE}` has no description `{name}`"
    return SourceError("source-not-found", message, notes=notes, help=help)


DESCRIPTIONS = SourceKind(
    name="descriptions",
    forms=(_DESCRIPTIONS_FORM,),
    local_schemes=(),
    separator="/",
    is_local=False,
    is_fetched=False,
    runs_code=True,
    pins=frozenset({"commit", "tree", "package", "version"}),
    # The last two name the folder of the package's clones.
    variables=("ROBOT_DESCRIPTIONS_CACHE", "ROBOT_DESCRIPTION_COMMIT", "PYTHONPATH", "XDG_CACHE_HOME", "HOME"),
    libraries=(Library(_DESCRIPTIONS_PACKAGE),),
    parse=_parse_descriptions,
    resolve=_resolve_descriptions,
    host=forms.no_host,
    is_of_this_machine=forms.always,
)
