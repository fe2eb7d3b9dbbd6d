"""The pose of a part's own world in a composition."""

from __future__ import annotations

from composer.compiled.kinds import Model, NameTable
from composer.dataclass import dataclass
from composer.numerics.pose import IDENTITY_QUAT, ORIGIN, Pose, Quat, Vec3, normalise

AT_ORIGIN = Pose()


@dataclass(frozen=True, slots=True)
class Mount:
    """The body that replaces the part's world in a composition, and the pose of the part in it.

    ``body`` is a name in the composition, the id of an unnamed body, or None for the world. ``pose=None`` means
    that the pose is unknown: it is then taken from the first element at the part's root, and all others must have
    moved with it.
    """

    body: str | int | None = None
    pose: Pose | None = AT_ORIGIN

    @property
    def is_in_place(self) -> bool:
        """Whether the part has the same pose in the composition as alone."""
        return self.body is None and self.pose is not None and self.pose.is_identity

    @classmethod
    def of(
        cls,
        composed: Model,
        *,
        site: str | None = None,
        body: str | None = None,
        pos: Vec3 = ORIGIN,
        quat: Quat = IDENTITY_QUAT,
    ) -> Mount:
        """Return the mount for a place in a recipe: a site, a body or the world, with an offset.

        ``pos`` is in metres, in the frame of the place. Raises KeyError for an unknown site.
        """
        offset = Pose(pos, normalise(quat))
        if site is None:
            return cls(body, offset)
        roster = NameTable(composed)
        index = roster.ids["site"][site]
        place = _pose(composed.site_pos[index], composed.site_quat[index])
        owner = int(composed.site_bodyid[index])
        return cls(owner or None, place @ offset)

    def index(self, roster: NameTable) -> int:
        """Return the id of the body in the composition. Raises KeyError for an unknown body."""
        if self.body is None:
            return 0
        return self.body if isinstance(self.body, int) else roster.ids["body"][self.body]


def _pose(pos: Model, quat: Model) -> Pose:
    x, y, z = pos.tolist()
    w, a, b, c = quat.tolist()
    return Pose((x, y, z), (w, a, b, c))
