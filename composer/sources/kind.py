"""What a kind of model reference is, apart from the code that reads and follows one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

Pin = Literal["commit", "tree", "sha256", "package", "version"]
"""What a lock can write down of a source besides the hashes of its files."""

PINS: tuple[Pin, ...] = get_args(Pin)


@dataclass(frozen=True, slots=True)
class Form:
    """One way to write a reference: an example as messages and docs show it, and what it refers to."""

    example: str
    meaning: str

    @property
    def scheme(self) -> str:
        """What stands before the first colon; empty for a path, which has none.

        >>> Form("menagerie:ROBOT/ENTRY", "a robot").scheme, Form("./arm.xml", "a file").scheme
        ('menagerie', '')
        """
        scheme, colon, _ = self.example.partition(":")
        return scheme if colon else ""


@dataclass(frozen=True, slots=True)
class Library:
    """A Python package that a kind of reference needs, by its name on PyPI, and the extra of mjcompose that has it."""

    name: str
    extra: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """The facts about a kind of model reference. Every field is required.

    | field | what it says |
    |---|---|
    | `name` | the kind in locks, manifests, `plan --format json` and messages |
    | `forms` | how references of the kind are written, one or more |
    | `local_schemes` | schemes that are read too, but only for a server on this machine |
    | `separator` | what stands between the id of what is fetched or installed as one, and a file in it |
    | `is_local` | whether the files are the user's own, who may change them |
    | `is_fetched` | whether the files are in mjcompose's store, apart from all other files of this machine |
    | `runs_code` | whether following a reference runs code that came with what it names |
    | `pins` | what a lock has of such a source besides the hashes of its files |
    | `variables` | the environment variables that decide which file a reference stands for |
    | `libraries` | the Python packages that decide it, which need not be installed |

    A change of one of `variables` or `libraries` makes what the build cache knows out of date. A kind that is not
    fetched sees no other variables; one that is fetched sees all of them, since its bytes are pinned or asked for
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
        """Raise ValueError if something is known of a source of this kind that no lock of it would have."""
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
