"""MJCF models as Python objects: read, edit, attach to one another, and write.

    from composer import mjcf

    arm = mjcf.from_path('arm.xml')
    gripper = mjcf.from_path('gripper.xml')
    arm.find('site', 'flange').attach(gripper)
    mjcf.export_with_assets_as_zip(arm, 'arm_with_gripper.zip')

Importing it does not import MuJoCo.
"""

from __future__ import annotations

from composer.mjcf import elements as elements
from composer.mjcf.asset import Asset
from composer.mjcf.attachment import (
    AttachmentFrame,
    get_attachment_frame,
    get_frame_freejoint,
    get_frame_joints,
    get_freejoint,
)
from composer.mjcf.committing import commit_defaults
from composer.mjcf.element import Element, RootElement
from composer.mjcf.element_list import ElementList
from composer.mjcf.errors import (
    MjcfAttributeError,
    MjcfError,
    MjcfFileError,
    MjcfFileNotFoundError,
    MjcfKeyError,
    MjcfWarning,
)
from composer.mjcf.export import export_with_assets, export_with_assets_as_zip
from composer.mjcf.parse import from_file, from_path, from_xml_string, from_zip
from composer.mjcf.physics.binding import Binding
from composer.mjcf.physics.physics import Physics
from composer.mjcf.physics.spec import from_spec
from composer.mjcf.views import ViewClasses, register
from composer.tree.name_index import SEPARATOR as PREFIX_SEPARATOR

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
