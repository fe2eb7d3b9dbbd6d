"""Model references to installed Python packages and to `robot_descriptions`."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

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
