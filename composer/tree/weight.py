"""What a piece of a model costs MuJoCo, once it is expanded."""

from __future__ import annotations

from typing import NamedTuple

from lxml.etree import _Element as Node

_DOFS = {"free": 6, "ball": 3}


class Weight(NamedTuple):
    """How many elements, bodies and degrees of freedom a piece has, and how many numbers in the mass matrix.

    The matrix has a number for each two degrees of freedom of which one carries the other, and for each with itself.
    `loose` are the degrees of freedom whose body is around the piece; they have no numbers yet. `points` are those of
    the meshes of models that it attaches.

    >>> joint = Weight(elements=1, dofs=1, loose=1)
    >>> link = joint.in_body()
    >>> link.matrix, link.plus(joint).in_body().matrix
    (1, 3)
    """

    elements: int = 0
    bodies: int = 0
    dofs: int = 0
    matrix: int = 0
    loose: int = 0
    points: int = 0

    def plus(self, other: Weight) -> Weight:
        return Weight(
            self.elements + other.elements, self.bodies + other.bodies, self.dofs + other.dofs,
            matrix=self.matrix + other.matrix, loose=self.loose + other.loose, points=self.points + other.points,
        )  # fmt: skip

    def times(self, count: int) -> Weight:
        return Weight(*(count * each for each in self))

    def in_body(self) -> Weight:
        """A body with this in it."""
        own, carried = self.loose, self.dofs - self.loose
        matrix = self.matrix + own * (own + 1) // 2 + own * carried
        return Weight(
            self.elements + 1, self.bodies + 1, self.dofs, matrix=matrix, loose=0, points=self.points
        )


NOTHING = Weight()


def joint_dofs(joint: Node, by_default: int) -> int:
    """The degrees of freedom of a joint; `by_default` of one that does not say its type.

    >>> from lxml import etree
    >>> joint_dofs(etree.fromstring('<joint type="ball"/>'), 1), joint_dofs(etree.fromstring("<freejoint/>"), 1)
    (3, 6)
    """
    if joint.tag == "freejoint":
        return 6
    kind = joint.get("type")
    return by_default if kind is None else _DOFS.get(kind, 1)


def default_dofs(root: Node) -> int:
    """At least so many degrees of freedom that a joint without a type has: its class is not looked for.

    >>> from lxml import etree
    >>> default_dofs(etree.fromstring('<mujoco><default><joint type="ball"/></default></mujoco>'))
    3
    """
    return max((joint_dofs(each, 1) for each in root.iterfind("default//joint[@type]")), default=1)
