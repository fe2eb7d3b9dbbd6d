"""MJCF models as Python objects: read, edit, attach to one another, and write.

    from mjcompose import mjcf

    arm = mjcf.from_path('arm.xml')
    gripper = mjcf.from_path('gripper.xml')
    arm.find('site', 'flange').attach(gripper)
    mjcf.export_with_assets_as_zip(arm, 'arm_with_gripper.zip')

Importing it does not import MuJoCo.
"""

from __future__ import annotations

from mjcompose.mjcf import elements as elements
from mjcompose.mjcf.asset import Asset
from mjcompose.mjcf.attachment import (
    AttachmentFrame,
    get_attachment_frame,
    get_frame_freejoint,
    get_frame_joints,
    get_freejoint,
)
from mjcompose.mjcf.attributed import ViewClasses, register
from mjcompose.mjcf.binding import Binding
from mjcompose.mjcf.commit import commit_defaults
from mjcompose.mjcf.element import Element, ElementList, RootElement
from mjcompose.mjcf.errors import (
    MjcfAttributeError,
    MjcfError,
    MjcfFileError,
    MjcfFileNotFoundError,
    MjcfKeyError,
    MjcfWarning,
)
from mjcompose.mjcf.parse import (
    export_with_assets,
    export_with_assets_as_zip,
    from_file,
    from_path,
    from_spec,
    from_xml_string,
    from_zip,
)
from mjcompose.mjcf.physics import Physics
from mjcompose.tree.names import SEPARATOR as PREFIX_SEPARATOR

register(ViewClasses(element=Element, root=RootElement, frame=AttachmentFrame, several=ElementList))

__all__ = [
    "PREFIX_SEPARATOR",
    "Asset",
    "AttachmentFrame",
    "Binding",
    "Element",
    "ElementList",
    "MjcfAttributeError",
    "MjcfError",
    "MjcfFileError",
    "MjcfFileNotFoundError",
    "MjcfKeyError",
    "MjcfWarning",
    "Physics",
    "RootElement",
    "commit_defaults",
    "elements",
    "export_with_assets",
    "export_with_assets_as_zip",
    "from_file",
    "from_path",
    "from_spec",
    "from_xml_string",
    "from_zip",
    "get_attachment_frame",
    "get_frame_freejoint",
    "get_frame_joints",
    "get_freejoint",
]


def __dir__() -> list[str]:
    return __all__
