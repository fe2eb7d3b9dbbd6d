"""One attribute of an MJCF element, as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import Literal

from composer.dataclass import dataclass
from composer.grammar.version import exists_in

AttributeType = Literal[
    "real",
    "int",
    "bool",
    "keyword",
    "keywords",
    "string",
    "chars",
    "file",
    "name",
    "reference",
    "references",
]

Angle = Literal["orientation-euler", "orientation-axisangle", "joint", "replicate"]

Default = bool | int | float | str | tuple[int | float | str, ...] | None

NUMERIC = frozenset({"real", "int"})
REFERRING = frozenset({"reference", "references"})


@dataclass(frozen=True, slots=True, eq=False)
class Attribute:
    """MuJoCo's rules for one attribute.

    Lengths count numbers, keywords, names or (for `chars`) characters; `None` is unbounded. `default` is the value,
    in the last version covered, of an attribute that is not written: a scalar if `max_length` is 1, else a tuple;
    `None` if there is none (names, lists without bound), or if MuJoCo computes it.
    """

    name: str
    type: AttributeType
    min_length: int | None = 1
    max_length: int | None = 1
    lengths: tuple[int, ...] | None = None
    """The only allowed lengths, if the two bounds are not enough (`scale` of a frame: one or three)."""
    keywords: tuple[str, ...] = ()
    keyword_versions: Mapping[str, tuple[str | None, str | None]] = field(default_factory=dict)
    """First and last version of keywords that are not in all versions."""
    ordered: bool = False
    """Several keywords must be in the order of `keywords`."""
    default: Default = None
    required: bool = False
    declares: str | None = None
    """Namespace in which this attribute declares a name."""
    refers: str | None = None
    """Namespace of the name in this attribute; `attached:…` is a namespace of the attached model."""
    refers_by: str | None = None
    """Sibling attribute whose keyword selects the namespace, through `Grammar.objtypes`."""
    folder: Literal["mesh", "texture", "model"] | None = None
    """The folder that a file is relative to: meshdir, texturedir, or that of the model's own file."""
    angle: Angle | None = None
    """The rule of `compiler/angle` for the value; `joint` is an angle for a hinge only (`range` and `springyield`
    also for a ball), `orientation-axisangle` only in the fourth number.
    """
    since: str | None = None
    until: str | None = None
    """First and last MuJoCo version with it; `None`: all versions that the grammar covers."""
    in_default: bool = False
    """It may be set in a default class."""
    doc: str = ""

    @property
    def is_number(self) -> bool:
        """Whether the value is one number or several."""
        return self.type in NUMERIC

    @property
    def is_interval(self) -> bool:
        """Whether the value is a lower and an upper end: MJCF calls every such pair a range (`ctrlrange`)."""
        return self.type == "real" and self.min_length == self.max_length == 2 and self.name.endswith("range")

    @property
    def is_reference(self) -> bool:
        """Whether the value names one other element or several."""
        return self.type in REFERRING

    @property
    def separated(self) -> bool:
        """Whether the value is a list of items separated by white space."""
        if self.type in ("keywords", "references"):
            return True
        return self.type in NUMERIC and self.max_length != 1

    def exists_in(self, version: str) -> bool:
        """Return whether that MuJoCo version (`"3.12.0"`) reads the attribute."""
        return exists_in(version, self.since, self.until)

    def versions(self) -> Iterator[str]:
        """Yield the first and the last MuJoCo version with it, in words."""
        if self.since is not None:
            yield f"since MuJoCo {self.since}"
        if self.until is not None:
            yield f"up to MuJoCo {self.until}"
