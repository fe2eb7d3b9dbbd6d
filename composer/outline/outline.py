"""A model at a glance, as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field

from composer.dataclass import dataclass
from composer.numerics.pose import Pose


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint; `range` is None without limits, in radians for a hinge or ball joint and in metres for a slide."""

    name: str | None
    type: str
    range: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Place:
    """A place for attaching a part: `kind` is `site`, `body` or `frame`.

    `pose` is relative to its body, `world` to the world with all joints at their reference; metres.
    """

    kind: str
    name: str
    pose: Pose
    world: Pose


@dataclass(frozen=True, slots=True)
class Body:
    """A body or the world. `part` is its part's name in the recipe; None if the recipe adds it.

    `copies` is the number of copies that MuJoCo's `<replicate>` makes. `places` has the body itself first.
    """

    name: str | None
    part: str | None
    joints: tuple[Joint, ...] = ()
    places: tuple[Place, ...] = ()
    children: tuple[Body, ...] = ()
    copies: int = 1

    def walk(self) -> Iterator[Body]:
        """Yield the body and all below it, depth first."""
        yield self
        for child in self.children:
            yield from child.walk()


@dataclass(frozen=True, slots=True)
class Part:
    """A part: its name in the recipe, the origin of its model, and the body that it is fixed to."""

    name: str
    model: str
    body: str | None = None


@dataclass(frozen=True, slots=True)
class Outline:
    """A model: `name` is its own, `label` the user's name for it."""

    name: str
    label: str
    world: Body
    parts: tuple[Part, ...] = field(default=())

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies, without the world."""
        return tuple(self.world.walk())[1:]

    @property
    def joints(self) -> tuple[Joint, ...]:
        return tuple(joint for body in self.world.walk() for joint in body.joints)
