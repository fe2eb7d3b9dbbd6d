"""Parts that hang on one another in a ring."""

from __future__ import annotations

from composer.diagnostics.sink import Sink
from composer.plan.plan import AttachPart, called


def without_rings(parts: tuple[AttachPart, ...], separator: str, sink: Sink) -> tuple[AttachPart, ...]:
    """Tell parts that hang on one another in a ring, which hang on nothing; the others remain."""
    hangs_on = {part.prefix: _mount_of(part, parts) for part in parts}
    told: set[str] = set()
    for part in parts:
        ring = [part.prefix]
        while (mount := hangs_on.get(ring[-1])) is not None and mount not in ring:
            ring.append(mount)
        if mount == part.prefix and part.prefix not in told:
            told.update(ring)
            names = ", which hangs on ".join(f"`{prefix}`" for prefix in [*ring[1:], mount])
            alone = len(ring) == 1
            sink.error(
                "attach-cycle",
                f"`{part.prefix}` hangs on itself" if alone else f"`{part.prefix}` hangs on {names}",
                part.span,
                help=f"{'it' if alone else 'one of them'} must hang on the base or on the world",
                subjects=ring,
            )
    if told:
        sink.suppress_about(called(part, separator) for part in parts if part.prefix in told)
    return tuple(part for part in parts if part.prefix not in told)


def _mount_of(part: AttachPart, parts: tuple[AttachPart, ...]) -> str | None:
    """The prefix of the part that this one hangs on, the longest that fits; None for the base and the world."""
    attachment = part.attachment
    place = attachment.site or attachment.body or attachment.frame or ""
    if not place:
        return None
    fitting = [other.prefix for other in parts if other.prefix and place.startswith(other.prefix)]
    return max(fitting, key=len, default=None)
