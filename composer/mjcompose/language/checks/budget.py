"""The form of the check `budget`: limits of a model's cost."""

from __future__ import annotations

from typing import Annotated, ClassVar

from mjcompose.language.check import Check
from mjcompose.language.forms.model import AnyOf
from mjcompose.language.forms.scalars import BYTES, Items, Name, NotNegative, Positive, Scaled

_MOST = ("geoms", "faces", "meshes", "textures", "bytes", "contacts", "steps_per_second")
_BYTES = Annotated[float, Scaled(BYTES, ge=0)]


class Budget(Check):
    """The model stays within these limits of size and speed."""

    word: ClassVar = "budget"
    example: ClassVar = "{faces: 50000}"
    rules: ClassVar = (AnyOf(*_MOST, lacks="limits nothing", advice="write for instance `faces: 50000`"),)
    instead: ClassVar = {"keys": "key"}

    geoms: NotNegative | None = None
    """the largest number of geoms"""
    faces: NotNegative | None = None
    """the largest number of triangles of all meshes together"""
    meshes: _BYTES | None = None
    """the largest memory of all meshes together, in bytes"""
    textures: _BYTES | None = None
    """the largest memory of all textures together, in bytes"""
    bytes: _BYTES | None = None
    """the largest size of all files of the model together, in bytes"""
    contacts: NotNegative | None = None
    """the largest number of contacts in a keyframe, or in the reference configuration"""
    steps_per_second: Positive | None = None
    """the smallest number of steps per second, in one thread on this machine"""
    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """the keyframes in which to count contacts; by default all, and the reference configuration"""


KIND = Budget
