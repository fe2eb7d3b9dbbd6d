"""Model references to the package `robot_descriptions`, which clones repositories with models."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, redirect_stdout
from importlib import import_module
from pathlib import Path
from typing import Any

from mjcompose.base.files import read_regular
from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources import license
from mjcompose.sources.fetching import Fetching, Lookup, not_at_hand
from mjcompose.sources.package import distribution, folders
from mjcompose.sources.reference import (
    Form,
    Library,
    Origin,
    Reference,
    Source,
    SourceError,
    SourceKind,
    always,
    bare,
    has_format,
    is_commit,
    malformed,
    no_host,
)

_PACKAGE = "robot_descriptions"
_FORM = Form("descriptions:NAME", "a model that the `robot_descriptions` package names")
_TRANSPORTS = "GIT_ALLOW_PROTOCOL"


def _parse(text: str) -> Reference:
    name = bare(text, _FORM)
    if not name.isidentifier():
        raise malformed(text, _FORM, "does not name a description")
    return Reference(text, KIND, name, path="")


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the MJCF file of a description, or its URDF file if it has no MJCF. Raises SourceError.

    Importing a description runs the package's code, which clones a repository on first use.
    """
    roots = folders(_PACKAGE)
    if not roots:
        message = f"`{reference.text}` needs the Python package `{_PACKAGE}`, which is not installed"
        raise SourceError("source-not-found", message, help=f"run `pip install {_PACKAGE}`")
    names = sorted(
        file.stem for root in roots for file in root.glob("*_description.py") if not file.name.startswith("_")
    )
    if reference.name not in names:
        raise _unknown(reference.name, names)
    description = _load(reference, lookup.fetching)
    path = _model_file(description, reference)
    owner = distribution(_PACKAGE)
    written = getattr(description, "REPOSITORY_PATH", None)
    repository = Path(written) if written else None
    commit = None if repository is None else _commit(repository)
    return Source(
        path, reference.kind, reference.text, package=_PACKAGE, version=owner.version if owner is not None else None,
        licenses=license.find(path, repository),
        origin=Origin(reference.id, reference.kind, repository or path.parent, commit=commit),
    )  # fmt: skip


def _commit(repository: Path) -> str | None:
    """Return the commit that the package has checked out by its hash, or None for any other state."""
    try:
        head = read_regular(repository / ".git" / "HEAD", 1024).decode("ascii").strip()
    except (OSError, ValueError):
        return None
    return head if is_commit(head) else None


def _load(reference: Reference, fetching: Fetching) -> Any:
    try:
        # The package prints its progress to standard output, which may carry a model.
        with redirect_stdout(sys.stderr), _no_transport() if fetching.offline else nullcontext():
            return import_module(f"{_PACKAGE}.{reference.name}")
    except Exception as fault:
        if fetching.offline:
            raise not_at_hand(reference, f"the cache of `{_PACKAGE}`") from fault
        # Any error of git, of the network or of a missing extra of the package.
        raise SourceError(
            "source-not-found", f"`{reference.text}` could not be fetched", notes=(str(fault) or repr(fault),)
        ) from fault


@contextmanager
def _no_transport() -> Iterator[None]:
    before = os.environ.get(_TRANSPORTS)
    os.environ[_TRANSPORTS] = "none"
    try:
        yield
    finally:
        os.environ.pop(_TRANSPORTS)
        if before is not None:
            os.environ[_TRANSPORTS] = before


def _model_file(description: Any, reference: Reference) -> Path:
    for attribute in ("MJCF_PATH", "URDF_PATH"):
        written = getattr(description, attribute, None)
        if written is None:
            continue
        path = Path(written)
        if not os.path.isfile(path) or not has_format(path):
            raise SourceError("source-not-found", f"`{reference.text}` stands for `{path}`, which is not a model file")
        return path
    raise SourceError("source-kind", f"`{reference.text}` has neither MJCF nor URDF")


def _unknown(name: str, names: list[str]) -> SourceError:
    likely = [each for each in (f"{name}_mj_description", f"{name}_description") if each in names]
    likely += closest(name, names, 3)
    notes = (exists_note("description", [*likely, *names]).message,)
    help = f"write `descriptions:{likely[0]}`" if likely else None
    return SourceError("source-not-found", f"`{_PACKAGE}` has no description `{name}`", notes=notes, help=help)


KIND = SourceKind(
    name="descriptions", forms=(_FORM,), local_schemes=(), separator="/", is_local=False, is_fetched=False,
    runs_code=True, pins=frozenset({"commit", "tree", "package", "version"}),
    # The last two name the folder of the package's clones.
    variables=("ROBOT_DESCRIPTIONS_CACHE", "ROBOT_DESCRIPTION_COMMIT", "PYTHONPATH", "XDG_CACHE_HOME", "HOME"),
    libraries=(Library(_PACKAGE),), parse=_parse, resolve=_resolve, host=no_host, is_of_this_machine=always,
)  # fmt: skip
