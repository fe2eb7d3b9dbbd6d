"""Pass: remove frames. The poses of what they held are written by `values.py`."""

from __future__ import annotations

from lxml.etree import _Element as Node


def without_frames(root: Node) -> None:
    """Replace each frame by its children.

    >>> from lxml import etree
    >>> inner = "<frame><body/><frame><geom/></frame></frame><site/>"
    >>> root = etree.fromstring(f"<mujoco><worldbody>{inner}</worldbody></mujoco>")
    >>> without_frames(root)
    >>> [str(each.tag) for each in root[0]]
    ['body', 'geom', 'site']
    """
    for frame in list(root.iter("frame"))[::-1]:
        holder = frame.getparent()
        assert holder is not None
        at = holder.index(frame)
        holder[at : at + 1] = list(frame)
