"""One attribute of an MJCF element, as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

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
    """What MuJoCo reads from one attribute.

    Lengths count numbers, keywords, names or (for `chars`) characters; `None` is unbounded. `default` is the
    value, in the last version covered, of an attribute written nowhere: a scalar where `max_length` is 1,
    else a tuple; `None` where no such value exists (names, lists without bound), or MuJoCo computes it.
    """

    name: str
    type: AttributeType
    min_length: int | None = 1
    max_length: int | None = 1
    lengths: tuple[int, ...] | None = None
    """The only lengths there are, where the two bounds do not say it (`scale` of a frame: one or three)."""
    keywords: tuple[str, ...] = ()
    keyword_versions: Mapping[str, tuple[str | None, str | None]] = field(default_factory=dict)
    """First and last version of the keywords that are not in all versions."""
    ordered: bool = False
    """Several keywords must stand in the order of `keywords`."""
    default: Default = None
    required: bool = False
    declares: str | None = None
    """Namespace in which this attribute declares a name."""
    refers: str | None = None
    """Namespace of the name this attribute holds; `attached:…` is a namespace of the attached model."""
    refers_by: str | None = None
    """Sibling attribute whose keyword picks the namespace, by way of `Grammar.objtypes`."""
    folder: Literal["mesh", "texture", "model"] | None = None
    """Which folder a file resolves against: meshdir, texturedir, or that of the model's own file."""
    angle: Angle | None = None
    """Which rule of `compiler/angle` governs the value; `joint` is angular for a hinge only (`range` and
    `springyield` for a ball too), `orientation-axisangle` in the fourth number."""
    since: str | None = None
    until: str | None = None
    """First and last MuJoCo version that has it; `None`: all versions the grammar covers."""
    in_default: bool = False
    """It may be set in a default class."""
    doc: str = ""

    @property
    def is_number(self) -> bool:
        """The value is one number or several."""
        return self.type in NUMERIC

    @property
    def is_interval(self) -> bool:
        """The value is a lower and an upper end: MJCF calls every such pair a range (`ctrlrange`)."""
        return self.type == "real" and self.min_length == self.max_length == 2 and self.name.endswith("range")

    @property
    def is_reference(self) -> bool:
        """The value names one other element or several."""
        return self.type in REFERRING

    @property
    def separated(self) -> bool:
        """The value is a list of items separated by white space."""
        if self.type in ("keywords", "references"):
            return True
        return self.type in NUMERIC and self.max_length != 1

    def exists_in(self, version: str) -> bool:
        """Whether that MuJoCo version (`"3.12.0"`) reads the attribute."""
        return exists_in(version, self.since, self.until)

    def versions(self) -> Iterator[str]:
        """The first and the last MuJoCo version that has it, in words."""
        if self.since is not None:
            yield f"since MuJoCo {self.since}"
        if self.until is not None:
            yield f"up to MuJoCo {self.until}"
