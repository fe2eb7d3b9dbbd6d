"""The components of a model reference, and errors that several kinds of references share."""

from __future__ import annotations

import re

from composer.dataclass import dataclass
from composer.diagnostics.secret import hide
from composer.sources.error import SourceError
from composer.sources.kind import Form, Kind


@dataclass(frozen=True, slots=True)
class Reference:
    """The components of a model reference.

    | kind | `name` | `path` |
    |---|---|---|
    | path | empty | the path as written |
    | package | the Python package | the file inside of it |
    | menagerie | the robot | the entry, empty for the robot's own model |
    | descriptions | the description | empty |
    | git | the URL of the repository | the file inside of it, at `revision` |
    | archive | the URL of the archive | the file inside of it; `revision` is its sha256 if it is written |
    """

    text: str
    kind: Kind
    name: str
    path: str
    revision: str = ""

    @property
    def id(self) -> str:
        """The reference without the file: what is fetched or installed as a whole."""
        if self.kind.separator == "#":
            return self.text.partition("#")[0]
        return f"{self.text.partition(':')[0]}:{self.name}" if self.name else self.text


CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_LOOPBACK = re.compile(r"(localhost|127(\.\d+){3}|\[::1\])(:\d+)?")


def is_this_machine(host: str) -> bool:
    """Return whether a host, with or without a port, is the loopback, which needs no encryption. No I/O."""
    return _LOOPBACK.fullmatch(host) is not None


def bare(text: str, form: Form) -> str:
    """Return the text after the colon; leading slashes, a habit from other tools, are an error. Raises SourceError."""
    rest = text.partition(":")[2]
    if rest.startswith("/"):
        stripped = rest.lstrip("/")
        raise SourceError(
            "source-kind",
            f"the model reference `{text}` has slashes after `{form.scheme}:`",
            help=f"write `{form.scheme}:{stripped}`" if stripped else f"write `{form.example}`",
        )
    return rest


def malformed(text: str, form: Form, problem: str) -> SourceError:
    """Return the error for a reference that lacks something of its form."""
    return SourceError(
        "source-kind", f"the model reference `{text}` {problem}", help=f"the form is `{form.example}`"
    )


def check_secrets(text: str, host: str) -> None:
    """Refuse a secret in a reference, because locks and bundles would publish it. Raises SourceError."""
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
