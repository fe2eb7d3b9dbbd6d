"""A model reference and its source as data, and the references and files that a recipe trusts."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import field
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

from mjcompose.base.access import NOTHING, Door
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import DiagnosticError, hide
from mjcompose.base.files import MESH_FILES
from mjcompose.sources import address
from mjcompose.sources.address import AddressError, is_private
from mjcompose.sources.ros import AS_WRITTEN, UrdfChoices

if TYPE_CHECKING:
    from mjcompose.sources.fetching import Lookup


class SourceError(DiagnosticError):
    """A fault in a model reference. The notes list existing names, and `help` says what to write instead."""


Pin = Literal["commit", "tree", "sha256", "package", "version"]
"""Facts that a lock can record about a source besides the hashes of its files."""

PINS: tuple[Pin, ...] = get_args(Pin)


class Form(Struct):
    """One way to write a reference: an example for messages and docs, and its meaning."""

    example: str
    meaning: str

    @property
    def scheme(self) -> str:
        """The text before the first colon; empty for a path, which has none."""
        scheme, colon, _ = self.example.partition(":")
        return scheme if colon else ""


class Library(Struct):
    """A Python package that a kind of reference needs, by its name on PyPI, and the extra of mjcompose with it."""

    name: str
    extra: str | None = None


class Kind(Struct, kw_only=True):
    """The facts about a kind of model reference. Every field is required.

    | field | meaning |
    |---|---|
    | `name` | the name in locks, manifests, `plan --output-format json` and messages |
    | `forms` | how references of the kind are written, one or more |
    | `local_schemes` | further schemes, for a server on this machine only |
    | `separator` | the text between the id of an origin and the path of a file in it |
    | `is_local` | whether the files belong to the user, who may change them |
    | `is_fetched` | whether the files are in mjcompose's store, separate from all other files of this machine |
    | `runs_code` | whether resolving a reference runs code of the source |
    | `pins` | the facts that a lock records besides the hashes of the files |
    | `variables` | the environment variables that determine the file of a reference |
    | `libraries` | the Python packages that determine it; they need not be installed |

    A change of one of `variables` or `libraries` makes entries of the build cache outdated. A kind that is not fetched
    sees no other variables; a fetched kind sees all of them, because its bytes are pinned or requested in every build.
    """

    name: str
    forms: tuple[Form, ...]
    local_schemes: tuple[str, ...]
    separator: Literal["#", "/"]
    is_local: bool
    is_fetched: bool
    runs_code: bool
    pins: frozenset[Pin]
    variables: tuple[str, ...]
    libraries: tuple[Library, ...]

    def check_pinned(self, **known: str | None) -> None:
        """Raise ValueError if a source of this kind has a fact that its lock would not record."""
        missing = [pin for pin, value in known.items() if value is not None and pin not in self.pins]
        if missing:
            raise ValueError(f"the kind {self.name!r} knows {missing}, and `pins` in its row does not name it")

    def __post_init__(self) -> None:
        if not self.name.isidentifier() or not self.forms:
            raise ValueError(f"the kind {self.name!r} needs a name of letters and at least one form")
        if self.is_local and (self.is_fetched or self.pins):
            raise ValueError(f"the files of the kind {self.name!r} are the user's own: they are not pinned")
        if not self.pins.issubset(PINS):
            raise ValueError(f"the kind {self.name!r} pins {sorted(self.pins.difference(PINS))}: no lock has that")


class Reference(Struct):
    """The components of a model reference.

    | kind | `name` | `path` |
    |---|---|---|
    | path | empty | the path as written |
    | package | the Python package | the file inside it |
    | menagerie | the robot | the entry, empty for the robot's own model |
    | descriptions | the description | empty |
    | git | the URL of the repository | the file inside it, at `revision` |
    | archive | the URL of the archive | the file inside it (`revision` is its sha256 if it is written) |
    | bucket | the same in an object store | likewise |
    | oci | the registry and the repository | the file inside it (`revision` is the sha256 of the manifest) |
    | hf | the repository | the file inside it, at `revision` |
    """

    text: str
    kind: Kind
    name: str
    path: str
    revision: str = ""

    @property
    def id(self) -> str:
        """The reference without the file: a name for everything that is fetched or installed with it."""
        if self.kind.separator == "#":
            return self.text.partition("#")[0]
        return f"{self.text.partition(':')[0]}:{self.name}" if self.name else self.text


CONTROL = re.compile(r"[\x00-\x1f\x7f]")


def bare(text: str, form: Form) -> str:
    """Return the text after the colon; leading slashes, a habit from other tools, are an error. Raises SourceError."""
    rest = text.partition(":")[2]
    if rest.startswith("/"):
        stripped = rest.lstrip("/")
        help = f"write `{form.scheme}:{stripped}`" if stripped else f"write `{form.example}`"
        raise SourceError("source-kind", f"the model reference `{text}` has slashes after `{form.scheme}:`", help=help)
    return rest


def malformed(text: str, form: Form, problem: str) -> SourceError:
    """Return the error for a reference that lacks something of its form."""
    return SourceError("source-kind", f"the model reference `{text}` {problem}", help=f"the form is `{form.example}`")


def check_address(text: str, form: Form, url: str) -> None:
    """Refuse a reference whose address programs read in different ways. Raises SourceError."""
    try:
        address.check_address(url)
    except AddressError as error:
        raise malformed(text, form, str(error)) from None


def check_secrets(text: str, host: str) -> None:
    """Refuse a secret in a reference, because locks and bundles would publish it. Raises SourceError."""
    login, _, _ = host.rpartition("@")
    user, colon, _ = login.partition(":")
    shown = hide(text.replace(f"{login}@", f"{user}:…@", 1) if colon else text)
    if colon or shown != text:
        what = "password" if colon else "secret"
        raise SourceError(
            "source-kind",
            f"the model reference `{shown}` contains a {what}, which the lock and every bundle would publish",
            help="remove it: git uses its own credential helper or ssh. Download an archive that needs a login, and"
            " write its path",
        )


class Origin(Struct):
    """A repository at a commit, an archive, a robot of Menagerie, or an installed package.

    `id` is the model reference without the file (`git+https://host/repo@v1`). `root` is the folder that file names are
    relative to. `commit` and `tree` are git's hashes, and `sha256` is the hash of an archive. `without` has the paths
    that were left out when it was fetched, each with a description. `stored` has the sha256 of every file as it was put
    into the store.
    """

    id: str
    kind: Kind
    root: Path
    commit: str | None = None
    tree: str | None = None
    sha256: str | None = None
    without: tuple[tuple[str, str], ...] = ()
    stored: Mapping[str, str] = field(default_factory=dict, compare=False, repr=False)

    def __post_init__(self) -> None:
        self.kind.check_pinned(commit=self.commit, tree=self.tree, sha256=self.sha256)

    @property
    def is_fetched(self) -> bool:
        """Whether its files are in the store, separate from all other files of this machine."""
        return self.kind.is_fetched

    def named(self, inside: str) -> str:
        """Return the reference to a file in it, by its path from `root`."""
        return f"{self.id}{self.kind.separator}{inside}"

    @property
    def pin(self) -> str | None:
        """The commit or sha256 that fetches the same bytes again; None for an installed package."""
        return self.commit or self.sha256


_COMMIT = re.compile(r"[0-9a-f]{40}([0-9a-f]{24})?")


def is_commit(text: str) -> bool:
    """Return whether a text is a full commit hash. No I/O."""
    return _COMMIT.fullmatch(text) is not None


Format = Literal["recipe", "mjcf", "urdf", "mesh"]

FORMATS: dict[str, Format] = {
    ".yaml": "recipe",
    ".yml": "recipe",
    ".xml": "mjcf",
    ".mjcf": "mjcf",
    ".urdf": "urdf",
    ".xacro": "urdf",
    **dict.fromkeys(MESH_FILES, "mesh"),
}
"""The format of a file by its suffix in lower case."""


CompilerSettings: TypeAlias = tuple[tuple[str, str], ...]
"""Attributes of `<compiler>` with their values as text, sorted by name."""

ReadAs: TypeAlias = tuple[Path, tuple[tuple[str, Path], ...], UrdfChoices, CompilerSettings]
"""A file, and how it is read; equal for sources that give the same model."""


class Source(Struct):
    """The model file of a reference.

    `reference` is the text as written. `package` and `version` name the distribution of the file. The version is None
    if the file may differ from the distribution's. For a repository it is the commit, for an archive its sha256.
    `licenses` are the license files of the model, sorted by name. `packages` are the folders for `package://NAME` in
    URDF, if the recipe gives them. `origin` is its repository, archive or package, None for a plain path. `license` is
    the SPDX expression of its package. `door` limits the files that the model may read. `urdf` has the choices for
    reading a URDF. The file is read as if it began with a `<compiler>` with the attributes `compiler`.
    """

    path: Path
    kind: Kind
    reference: str
    package: str | None = None
    version: str | None = None
    licenses: tuple[Path, ...] = ()
    packages: tuple[tuple[str, Path], ...] = ()
    origin: Origin | None = None
    license: str | None = None
    door: Door = field(default=NOTHING, compare=False, repr=False)
    urdf: UrdfChoices = AS_WRITTEN
    compiler: CompilerSettings = ()

    def __post_init__(self) -> None:
        (self.kind if self.origin is None else self.origin.kind).check_pinned(package=self.package)

    @property
    def format(self) -> Format:
        """The format of the file by its suffix; a file with another suffix never becomes a source."""
        return FORMATS[self.path.suffix.lower()]

    @property
    def read_as(self) -> ReadAs:
        return self.path, self.packages, self.urdf, self.compiler


def has_format(path: PurePath) -> bool:
    """Return whether a recipe, MJCF, URDF or a mesh may have this suffix. No I/O."""
    return path.suffix.lower() in FORMATS


def is_mesh(path: PurePath) -> bool:
    """Return whether a mesh may have this suffix. No I/O."""
    return FORMATS.get(path.suffix.lower()) == "mesh"


class SourceKind(Kind, kw_only=True):
    """A kind of model reference as a row of `mjcompose.sources.kinds.KINDS`. Every field is required.

    `parse` takes the text of a reference apart, without I/O. `resolve` finds its file, and fetches it if necessary.
    Both raise SourceError for a faulty reference. `host` returns the server of a reference, with its port, or None;
    `is_of_this_machine` returns whether a reference without a server names something that only this machine has.
    Neither does I/O. They decide whether a fetched recipe may contain the reference.
    """

    parse: Callable[[str], Reference]
    resolve: Callable[[Reference, Lookup], Source]
    host: Callable[[Reference], str | None]
    is_of_this_machine: Callable[[Reference], bool]


def no_host(reference: Reference) -> str | None:
    """Return None, for kinds without a server."""
    return None


def host_of_url(reference: Reference) -> str | None:
    """Return the host of a reference whose name is a URL, with its port; None if it has no host."""
    return reference.name.partition("://")[2].partition("/")[0] or None


def always(reference: Reference) -> bool:
    return True


def never(reference: Reference) -> bool:
    return False


class Trust(Struct):
    """The files and references that the outer recipe trusts.

    `files` are folders that the user's own models may read; fetched recipes may name `references`. A
    reference is allowed if it is one of `references`, or continues one of them after a separator:

    >>> trust = Trust(references=("git+file:///srv/robots", "package:arms"))
    >>> trust.allows("git+file:///srv/robots@v1#arm.xml"), trust.allows("package:armsdealer/arm.xml")
    (True, False)
    """

    files: tuple[Path, ...] = ()
    references: tuple[str, ...] = ()

    def with_more(self, other: Trust) -> Trust:
        return Trust(
            tuple(dict.fromkeys((*self.files, *other.files))),
            tuple(dict.fromkeys((*self.references, *other.references))),
        )

    def allows(self, reference: str) -> bool:
        """Return whether a fetched recipe may contain the reference. No I/O."""
        if _LEADS_OUT.search(reference):  # leads out of the allowed folder
            return False
        return any(_begins(reference, each) for each in self.references)

    @property
    def folders(self) -> tuple[str, ...]:
        """The references that are absolute paths: the folders of this machine that fetched recipes may read."""
        return tuple(each for each in self.references if os.path.isabs(each))


_LEADS_OUT = re.compile(r"(^|[/\\])(\.|%2e){2}([/\\]|$)", re.IGNORECASE)
_SEPARATORS = "/:@#"


def _begins(text: str, start: str) -> bool:
    rest = text[len(start) :]
    return text.startswith(start) and (not rest or start[-1] in _SEPARATORS or rest[0] in _SEPARATORS)


def check_reach(reference: Reference, kind: SourceKind, origin: Origin, trust: Trust, offline: bool) -> None:
    """Refuse a reference that a recipe fetched with `origin` may not name. Raises SourceError."""
    host = None
    try:
        if trust.allows(reference.text):
            return
        host = kind.host(reference)
        if host is None and not kind.is_of_this_machine(reference):
            return
        if host is not None and not is_private(host, offline):
            return
    except Exception:  # a guard that fails refuses
        what = "something that mjcompose cannot check"
    else:
        what = "something on this machine" if host is None else f"`{host}`, which is on this machine or in its network"
    message = f"`{reference.text}` names {what}, and `{origin.id}`, whose recipe does, was fetched"
    trusted = reference.text if reference.kind.is_local else reference.id
    help = f'if you trust it with that, write in your own recipe `trust: {{references: ["{trusted}"]}}`'
    raise SourceError("source-outside", message, help=help)


def outside_network(shown: str, leads: str = "") -> SourceError:
    """Return the error for a server that a fetched recipe names and that is not public, when it is contacted."""
    message = f"`{shown}`, which a fetched recipe names,{leads} is on this machine or in its network"
    return SourceError("source-outside", message, help=TO_TRUST)


TO_TRUST = "if you trust it with that, allow its reference in your own recipe, under `trust: {references: […]}`"
