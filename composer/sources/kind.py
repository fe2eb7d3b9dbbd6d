"""The facts about a kind of model reference, without the code that parses and resolves it."""

from __future__ import annotations

from typing import Literal, get_args

from composer.dataclass import dataclass

Pin = Literal["commit", "tree", "sha256", "package", "version"]
"""What a lock can record about a source besides the hashes of its files."""

PINS: tuple[Pin, ...] = get_args(Pin)


@dataclass(frozen=True, slots=True)
class Form:
    """One way to write a reference: an example for messages and docs, and what it refers to."""

    example: str
    meaning: str

    @property
    def scheme(self) -> str:
        """The text before the first colon; empty for a path, which has none.

        >>> Form("menagerie:ROBOT/ENTRY", "a robot").scheme, Form("./arm.xml", "a file").scheme
        ('menagerie', '')
        """
        scheme, colon, _ = self.example.partition(":")
        return scheme if colon else ""


@dataclass(frozen=True, slots=True)
class Library:
    """A Python package that a kind of reference needs, by its name on PyPI, and the extra of mjcompose with it."""

    name: str
    extra: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """The facts about a kind of model reference. Every field is required.

    | field | what it says |
    |---|---|
    | `name` | the name in locks, manifests, `plan --format json` and messages |
    | `forms` | how references of the kind are written, one or more |
    | `local_schemes` | further schemes, for a server on this machine only |
    | `separator` | the text between the id of an origin and the path of a file in it |
    | `is_local` | whether the files belong to the user, who may change them |
    | `is_fetched` | whether the files are in mjcompose's store, separate from all other files of this machine |
    | `runs_code` | whether resolving a reference runs code of the source |
    | `pins` | what a lock records besides the hashes of the files |
    | `variables` | the environment variables that determine the file of a reference |
    | `libraries` | the Python packages that determine it; they need not be installed |

    A change of one of `variables` or `libraries` makes entries of the build cache outdated. A kind that is not
    fetched sees no other variables; one that is fetched sees all of them, because its bytes are pinned or requested
    in every build.
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
        if missing := [pin for pin, value in known.items() if value is not None and pin not in self.pins]:
            raise ValueError(
                f"the kind {self.name!r} knows {missing}, and `pins` in its row does not name it"
            )

    def __post_init__(self) -> None:
        if not self.name.isidentifier() or not self.forms:
            raise ValueError(f"the kind {self.name!r} needs a name of letters and at least one form")
        if self.is_local and (self.is_fetched or self.pins):
            raise ValueError(f"the files of the kind {self.name!r} are the user's own: they are not pinned")
        if not self.pins.issubset(PINS):
            raise ValueError(
                f"the kind {self.name!r} pins {sorted(self.pins.difference(PINS))}: no lock has that"
            )
