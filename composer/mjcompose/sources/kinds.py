"""Model references that are paths, all kinds of reference, and the parser that selects one."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path, PurePath

from mjcompose.base.diagnostic import DiagnosticError, hide
from mjcompose.base.extensions import ExtensionTable, is_registered, refuse
from mjcompose.base.files import CODE
from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources import fetched, fetching as nearby, license, menagerie, packages, reference as forms
from mjcompose.sources.address import is_this_machine
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.reference import (
    CONTROL,
    Form,
    Reference,
    Source,
    SourceError,
    SourceKind,
    has_format,
    is_mesh,
    never,
)


def _parse_path(text: str) -> Reference:
    return Reference(text, PATH, "", path=text)


def _resolve_path(reference: Reference, lookup: Lookup) -> Source:
    fetching = lookup.fetching
    left_out = _left_out(reference, lookup.folder, fetching)
    if left_out is not None:
        raise left_out
    door = fetching.door_of_text(lookup.folder)
    path = os.path.join(lookup.folder, reference.path)
    if not door.sees(path):  # before any message lists existing files
        refused = door.outside(path)
        raise SourceError(CODE, refused.message(), refused.help)
    return _with_origin(_file(reference, lookup.folder, fetching), fetching, lookup.folder)


def _file(reference: Reference, relative_to: Path, fetching: Fetching) -> Source:
    wanted = relative_to / reference.path
    if os.path.isdir(wanted):
        raise _is_folder(reference.text, wanted)
    if not has_format(wanted):
        existing = _existing(reference.path, wanted, relative_to, fetching=fetching)
        raise nearby.without_suffix(reference.text, existing)
    if not os.path.isfile(wanted):
        if os.path.exists(wanted):
            message = f"the model reference `{reference.text}` is neither a file nor a folder"
            raise SourceError("source-kind", message, help="name a model file")
        hint = "`~` is not expanded: write the whole path" if reference.path.startswith("~") else None
        if reference.path.startswith("menagerie/"):
            hint = f"write `menagerie:{PurePath(reference.path).relative_to('menagerie').with_suffix('')}`"
        existing = _existing(reference.path, wanted, relative_to, fetching=fetching)
        raise nearby.not_found(reference.text, wanted, existing, hint=hint)
    return Source(wanted, reference.kind, reference.text, licenses=license.find(wanted))


def _existing(written: str, wanted: Path, relative_to: Path, fetching: Fetching) -> list[str]:
    folder = PurePath(written).parent.as_posix()
    start = "./" if folder == "." else f"{folder}/" if folder.startswith((".", "/", "~")) else f"./{folder}/"
    meshes = is_mesh(wanted)
    beside = [start + each for each in fetching.model_files(wanted.parent, 0, meshes)]
    below = [f"./{each}" for each in fetching.model_files(relative_to, meshes=meshes)]
    return list(dict.fromkeys(beside + below))


def _is_folder(text: str, folder: Path) -> SourceError:
    inside = [f"{text.rstrip('/')}/{each}" for each in nearby.model_files(folder)]
    message = f"the model reference `{text}` is a folder, not a model file"
    help = f"write `{inside[0]}`" if len(inside) == 1 else "name a model file in it"
    return SourceError("source-kind", message, notes=(exists_note("model file", inside).message,), help=help)


def _left_out(reference: Reference, relative_to: Path, fetching: Fetching) -> SourceError | None:
    origin = fetching.around(relative_to)
    if origin is None:
        return None
    inside = Path(os.path.relpath(os.path.realpath(relative_to / reference.path), os.path.realpath(origin.root)))
    for name, why in origin.without:
        if inside.is_relative_to(name):
            message = f"the model `{reference.text}` does not exist: `{name}` of `{origin.id}` is {why}"
            return SourceError("source-not-found", message)
    return None


def _with_origin(source: Source, fetching: Fetching, folder: Path) -> Source:
    origin = fetching.around(folder)
    if origin is None or fetching.around(source.path) != origin:
        return source
    asked = fetching.first.get(origin.id, source)
    own = license.find(source.path, origin.root)
    of_the_whole = tuple(each for each in asked.licenses if not each.is_relative_to(origin.root))
    return replace(
        source,
        package=asked.package,
        version=asked.version,
        license=asked.license,
        licenses=own or of_the_whole,
        origin=origin,
    )


PATH = SourceKind(
    name="path",
    forms=(Form("./path/to/model.xml", "a file, relative to the recipe that names it"),),
    local_schemes=(),
    separator="/",
    is_local=True,
    is_fetched=False,
    runs_code=False,
    pins=frozenset(),
    variables=(),
    libraries=(),
    parse=_parse_path,
    resolve=_resolve_path,
    host=forms.no_host,
    is_of_this_machine=never,
)


KINDS: tuple[SourceKind, ...] = (
    PATH,
    packages.PACKAGE,
    menagerie.MENAGERIE,
    packages.DESCRIPTIONS,
    fetched.GIT,
    fetched.ARCHIVE,
    fetched.HF,
    fetched.BUCKET,
    fetched.OCI,
)
"""A kind exists if its row is here; messages and docs list kinds in this order."""

_BY_NAME = {kind.name: kind for kind in KINDS}
_BY_SCHEME = {form.scheme: kind for kind in KINDS for form in kind.forms if form.scheme}
EXTENDED: ExtensionTable[SourceKind] = ExtensionTable("sources", {}, "KIND", kind=SourceKind)
"""The kinds of other packages, by their schemes, which are their names."""
_ON_THIS_MACHINE = {scheme: kind for kind in KINDS for scheme in kind.local_schemes}
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):(.*)", re.DOTALL)
"""At least two characters, because one letter before a colon is a Windows drive."""

if len(_BY_NAME) < len(KINDS):
    raise ValueError("two kinds of model reference have one name")
for _kind in KINDS:
    for _scheme in (*(form.scheme for form in _kind.forms), *_kind.local_schemes):
        if _scheme and {**_ON_THIS_MACHINE, **_BY_SCHEME}[_scheme] is not _kind:
            raise ValueError(f"two kinds of model reference begin with `{_scheme}:`")


def kind_called(name: str) -> SourceKind | None:
    """Return the kind of that name in a lock or manifest, or None if there is none."""
    return _BY_NAME.get(name) or EXTENDED.get(name)


def parse(text: str, fetched: str | None = None) -> Reference:
    """Parse a model reference. No I/O, except that it loads the kind of another package.

    `fetched` is the id of the origin if the recipe with the reference was fetched: it must not name such a kind.

    Text without a scheme is a path; a path with a colon in its first component needs `./` before it. Raises
    SourceError (`source-kind`) for a text that has none of the forms.

    >>> parse("menagerie:universal_robots_ur5e/ur5e").name
    'universal_robots_ur5e'
    >>> parse("git+https://host/robots@v1.2#arm/arm.xml").revision
    'v1.2'
    >>> parse("./parts/table.xml").kind.name
    'path'
    """
    if not text.strip():
        raise SourceError("source-kind", "a model reference is empty", notes=(_forms_note(),))
    if CONTROL.search(text):
        raise SourceError("source-kind", f"the model reference `{CONTROL.sub('?', text)}` holds a control character")
    scheme = None if text.startswith((".", "/", "\\")) else _SCHEME.fullmatch(text)
    if scheme is None:
        return PATH.parse(text)
    kind = _BY_SCHEME.get(scheme[1])
    if kind is None and is_registered("sources", scheme[1]):
        try:
            if fetched is not None:
                raise refuse("sources", scheme[1], fetched)
            kind = EXTENDED[scheme[1]]
        except DiagnosticError as error:
            raise SourceError(error.code, error.message, error.diagnostic.help) from error
    if kind is None and is_this_machine(scheme[2].removeprefix("//").partition("/")[0]):
        kind = _ON_THIS_MACHINE.get(scheme[1])
    if kind is None:
        raise _unknown_kind(text, scheme[1], scheme[2])
    return kind.parse(text)


def _unknown_kind(text: str, scheme: str, rest: str) -> SourceError:
    help = None
    text = hide(text)
    rest = hide(rest)
    near = closest(scheme, [*_BY_SCHEME, *EXTENDED])
    if near:
        help = f"write `{near[0]}:{rest}`"
    elif scheme.lower() == "file":
        help = "write the path alone"
    elif "/" not in scheme and not rest.startswith("//"):
        help = f"if it is a path, write `./{text}`"
    message = f"`{scheme}:` is not a kind of model reference, in `{text}`"
    return SourceError("source-kind", message, notes=(_forms_note(),), help=help)


def _forms_note() -> str:
    first = {form.scheme: form.example for kind in KINDS for form in reversed(kind.forms)}
    shown = (first.pop(form.scheme, None) for kind in KINDS for form in kind.forms)
    return "forms that exist: " + ", ".join(f"`{example}`" for example in shown if example)
