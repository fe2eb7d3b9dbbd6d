"""The text of a model reference taken apart into its kind and its parts."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from composer.diagnostics.secret import hide
from composer.diagnostics.suggest import closest
from composer.sources.error import SourceError


class Kind(StrEnum):
    """The kinds of model reference."""

    PATH = "path"
    PACKAGE = "package"
    MENAGERIE = "menagerie"
    DESCRIPTIONS = "descriptions"
    GIT = "git"
    ARCHIVE = "archive"


@dataclass(frozen=True, slots=True)
class Reference:
    """A model reference in its parts.

    | kind | `name` | `path` |
    |---|---|---|
    | path | empty | the path as written |
    | package | the Python package | the file inside of it |
    | menagerie | the robot | the entry, empty for the robot's own model |
    | descriptions | the description | empty |
    | git | the URL of the repository | the file inside of it, at `revision` |
    | archive | the URL of the archive | the file inside of it; `revision` is its sha256 where that is written |
    """

    text: str
    kind: Kind
    name: str
    path: str
    revision: str = ""

    @property
    def id(self) -> str:
        """The reference without the file in it: what is fetched or installed as one."""
        if self.kind in (Kind.GIT, Kind.ARCHIVE):
            return self.text.partition("#")[0]
        return f"{self.kind}:{self.name}" if self.name else self.text


_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):(.*)", re.DOTALL)
"""Two characters at least, so that the drive of a Windows path is none."""

_CONTROL = re.compile(r"[\x00-\x1f\x7f]")

_FORMS = {
    "package": "package:NAME/path/in/package.xml",
    "menagerie": "menagerie:ROBOT/ENTRY",
    "descriptions": "descriptions:NAME",
    "git+https": "git+https://host/repo@REV#path/model.xml",
    "git+ssh": "git+ssh://git@host/repo@REV#path/model.xml",
    "git+file": "git+file:///path/to/repo@REV#path/model.xml",
    "https": "https://host/archive.zip#path/model.xml",
}

_LOOPBACK = re.compile(r"(localhost|127(\.\d+){3}|\[::1\])(:\d+)?")


def is_this_machine(host: str) -> bool:
    """Whether a host, with or without a port, is one to which a connection need not be encrypted. No I/O."""
    return _LOOPBACK.fullmatch(host) is not None


def parse(text: str) -> Reference:
    """Take a model reference apart. No I/O.

    What is no other kind is a path; a path with a colon in its first part is written with `./` in front.
    Raises SourceError (`source-kind`) for a text that has none of the forms.

    >>> parse("menagerie:universal_robots_ur5e/ur5e").name
    'universal_robots_ur5e'
    >>> parse("git+https://host/robots@v1.2#arm/arm.xml").revision
    'v1.2'
    >>> parse("./parts/table.xml").kind
    <Kind.PATH: 'path'>
    """
    if not text.strip():
        raise SourceError("source-kind", "a model reference is empty", notes=(_forms_note(),))
    if _CONTROL.search(text):
        raise SourceError(
            "source-kind", f"the model reference `{_CONTROL.sub('?', text)}` holds a control character"
        )
    scheme = None if text.startswith((".", "/", "\\")) else _SCHEME.fullmatch(text)
    if scheme is None:
        return Reference(text, Kind.PATH, "", text)
    reader = _READERS.get(scheme[1])
    if reader is None and is_this_machine(scheme[2].removeprefix("//").partition("/")[0]):
        reader = _UNENCRYPTED.get(scheme[1])
    if reader is None:
        raise _unknown_kind(text, scheme[1], scheme[2])
    return reader(text, scheme[2])


def _package(text: str, rest: str) -> Reference:
    name, _, path = _bare(text, "package", rest).partition("/")
    if not name or not path.strip("/"):
        lacks = "the file inside the package" if name else "the package"
        raise _malformed(text, "package", f"does not say {lacks}")
    # A hyphen is let through: what is typed after `pip install` is told the name of the package later.
    if not all(part.replace("-", "_").isidentifier() for part in name.split(".")):
        raise _malformed(text, "package", f"names `{name}`, which cannot be a Python package")
    return Reference(text, Kind.PACKAGE, name, path)


def _menagerie(text: str, rest: str) -> Reference:
    robot, slash, entry = _bare(text, "menagerie", rest).partition("/")
    if not robot or (slash and not entry):
        raise _malformed(text, "menagerie", "does not say " + ("the entry" if robot else "the robot"))
    return Reference(text, Kind.MENAGERIE, robot, entry)


def _descriptions(text: str, rest: str) -> Reference:
    name = _bare(text, "descriptions", rest)
    if not name.isidentifier():
        raise _malformed(text, "descriptions", "does not name a description")
    return Reference(text, Kind.DESCRIPTIONS, name, "")


def _git(text: str, rest: str) -> Reference:
    scheme = text.partition(":")[0]
    location, _, path = rest.partition("#")
    host, _, tail = location.removeprefix("//").partition("/")
    _check_secrets(text, host)
    # Only an `@` behind the host starts a revision: before it, it ends a user's name.
    repository, at, revision = tail.rpartition("@")
    if not at:
        repository, revision = tail, ""
    if not repository or bool(host) == (scheme == "git+file"):
        raise _malformed(text, scheme, "does not say the repository")
    revision = _unescaped(revision)
    if not revision or revision.startswith("-") or _CONTROL.search(revision):
        raise _malformed(text, scheme, "does not say the revision")
    if not path:
        raise _malformed(text, scheme, "does not say the file inside the repository")
    return Reference(text, Kind.GIT, f"{scheme.removeprefix('git+')}://{host}/{repository}", path, revision)


def _unescaped(revision: str) -> str:
    """An `@`, `#` or `%` in the name of a branch or tag is written as in any URL: `%40`, `%23`, `%25`."""
    if "%" not in revision:
        return revision
    from urllib.parse import unquote

    return unquote(revision)


def escaped(revision: str) -> str:
    """The name of a branch or tag as a reference writes it.

    >>> escaped("robots@1.2")
    'robots%401.2'
    """
    return revision.replace("%", "%25").replace("@", "%40").replace("#", "%23")


def _archive(text: str, rest: str) -> Reference:
    scheme = text.partition(":")[0]
    location, _, path = rest.partition("#")
    host, _, archive = location.removeprefix("//").partition("/")
    _check_secrets(text, host)
    archive, _, sha256 = archive.partition("@sha256:")
    if not host or not archive:
        raise _malformed(text, scheme, "does not say the archive")
    if not path:
        raise _malformed(text, scheme, "does not say the file inside the archive")
    if "@sha256:" in location and not re.fullmatch("[0-9a-f]{64}", sha256):
        raise _malformed(text, scheme, "has a sha256 that is not 64 digits of 0-9 and a-f")
    return Reference(text, Kind.ARCHIVE, f"{scheme}://{host}/{archive}", path, sha256)


def _check_secrets(text: str, host: str) -> None:
    """Refuse what everybody would read who gets a lock or a bundle."""
    login, _, _ = host.rpartition("@")
    user, colon, _ = login.partition(":")
    shown = hide(text.replace(f"{login}@", f"{user}:…@", 1) if colon else text)
    if colon or shown != text:
        what = "password" if colon else "secret"
        raise SourceError(
            "source-kind",
            f"the model reference `{shown}` holds a {what}, which would stand in the lock and in every bundle",
            help="leave it out: git asks its own credential helper or ssh; an archive that wants a login is"
            " downloaded first and named by a path",
        )


_READERS: dict[str, Callable[[str, str], Reference]] = {
    "package": _package,
    "menagerie": _menagerie,
    "descriptions": _descriptions,
    "git+https": _git,
    "git+ssh": _git,
    "git+file": _git,
    "https": _archive,
}
_UNENCRYPTED: dict[str, Callable[[str, str], Reference]] = {"git+http": _git, "http": _archive}


def _bare(text: str, kind: str, rest: str) -> str:
    """What follows the colon; two slashes there are a habit from other tools."""
    if rest.startswith("/"):
        bare = rest.lstrip("/")
        raise SourceError(
            "source-kind",
            f"the model reference `{text}` has slashes after `{kind}:`",
            help=f"write `{kind}:{bare}`" if bare else f"write `{_FORMS[kind]}`",
        )
    return rest


def _malformed(text: str, kind: str, problem: str) -> SourceError:
    form = _FORMS.get(kind, _FORMS["https"])
    return SourceError("source-kind", f"the model reference `{text}` {problem}", help=f"the form is `{form}`")


def _unknown_kind(text: str, scheme: str, rest: str) -> SourceError:
    help = None
    text, rest = hide(text), hide(rest)
    if near := closest(scheme, _FORMS):
        help = f"write `{near[0]}:{rest}`"
    elif scheme.lower() == "file":
        help = "write the path alone"
    elif "/" not in scheme and not rest.startswith("//"):
        help = f"if it is a path, write `./{text}`"
    return SourceError(
        "source-kind",
        f"`{scheme}:` is not a kind of model reference, in `{text}`",
        notes=(_forms_note(),),
        help=help,
    )


def _forms_note() -> str:
    return "forms that exist: `./path/to/model.xml`, " + ", ".join(f"`{form}`" for form in _FORMS.values())
