"""The data of the linker: a part is complete when it is made."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields

import pytest
from link.workshop import Piece, Workshop, hinge, placed
from mjcompose.link.linking import AttachedPart, Part

ARM = '<worldbody><body name="hand"><geom size=".1"/></body></worldbody>'


@pytest.mark.parametrize("name", [field.name for field in fields(Part)])
def test_no_field_of_a_part_can_be_set(workshop: Workshop, name: str) -> None:
    part = Part(workshop.unit(f"<mujoco>{ARM}</mujoco>"), "p/")
    with pytest.raises(FrozenInstanceError):
        setattr(part, name, getattr(part, name))


def test_what_the_passes_find_out_is_beside_the_part(workshop: Workshop) -> None:
    piece = Piece(f"<mujoco>{ARM}</mujoco>", "p/", placed(pos=(1.0, 0.0, 0.0)), options={"joints": (hinge(name="p/"),)})
    linking = workshop.link("<mujoco/>", piece).linking
    (part,) = linking.parts
    assert part.joints == (hinge(name="p/"),)
    assert linking.top_class(part.unit) == "p/"
    assert linking.top_class(linking.base) == "main"
    attachment = linking.attachments[part]
    assert isinstance(attachment, AttachedPart)
    assert attachment.mount.tag == "worldbody"
    assert [child.get("name") for child in attachment.content] == ["p/hand"]
    assert linking.pose_in_world(part) is None  # it has no keys with poses
