"""The settings in a model's `<compiler>`, which determine how its numbers and files are read."""

from __future__ import annotations

from typing import NamedTuple

from lxml.etree import _Element as Node


class Settings(NamedTuple):
    """The compiler settings of one source, as text; the defaults are MuJoCo's.

    If there are several `<compiler>` elements, the last written value of each attribute counts.
    """

    angle: str = "degree"
    eulerseq: str = "xyz"
    autolimits: str = "true"
    meshdir: str | None = None
    texturedir: str | None = None
    assetdir: str | None = None
    strippath: str = "false"
    inertiafromgeom: str = "auto"
    inertiagrouprange: str = "0 5"
    balanceinertia: str = "false"
    boundmass: str = "0"
    boundinertia: str = "0"
    settotalmass: str = "-1"
    fusestatic: str = "false"
    discardvisual: str = "false"
    alignfree: str = "false"
    fitaabb: str = "false"

    @property
    def mesh_folder(self) -> str:
        return self.meshdir if self.meshdir is not None else self.assetdir or ""

    @property
    def texture_folder(self) -> str:
        return self.texturedir if self.texturedir is not None else self.assetdir or ""


_KNOWN = frozenset(Settings._fields)


def read_settings(root: Node) -> Settings:
    """Return the settings of a whole `<mujoco>` tree."""
    written: dict[str, str] = {}
    for compiler in root.iterchildren("compiler"):
        for name, value in compiler.items():
            if name in _KNOWN and value.strip():
                written[str(name)] = str(value).strip()
    return Settings(**written)
