"""What MuJoCo's own `MjSpec.attach` makes of a composition."""

from __future__ import annotations

import mujoco
from fidelity.corpus import Composition


def attached(composition: Composition) -> mujoco.MjModel:
    """The compiled model. Raises ValueError where MuJoCo refuses.

    Attaching when either side has keys demands that both be compiled first; where neither has, a compile
    first would do harm: it would fuse the bodies of a URDF for good.
    """
    base = mujoco.MjSpec.from_file(str(composition.parent))
    children = [mujoco.MjSpec.from_file(str(attachment.child)) for attachment in composition.attachments]
    keyed = any(spec.keys for spec in (base, *children))
    if keyed:
        base.compile()
    for attachment, child in zip(composition.attachments, children, strict=True):
        if keyed:
            child.compile()
        if attachment.site is not None:
            site = base.site(attachment.site)
            if site is None:
                raise ValueError(f"no site {attachment.site}")
            if any(attachment.pos) or attachment.quat != (1.0, 0.0, 0.0, 0.0):
                raise ValueError("MjSpec attaches to a site without an offset")
            base.attach(child, prefix=attachment.prefix, site=site)
            continue
        body = base.worldbody if attachment.body is None else base.body(attachment.body)
        frame = body.add_frame(pos=attachment.pos, quat=attachment.quat)
        base.attach(child, prefix=attachment.prefix, frame=frame)
    return base.compile()
