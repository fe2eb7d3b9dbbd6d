"""Hashes of the assets of compiled models: a joint model has equal assets once."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import numbers_of
from mjcompose.mujoco.attributes import KINDS

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_DATA = {
    "mesh": ("mesh_vert", "mesh_face", "mesh_normal", "mesh_texcoord"),
    "hfield": ("hfield_data",),
    "texture": ("tex_data",),
}
_PROPERTIES = {
    "mesh": ("mesh_pos", "mesh_quat", "mesh_scale", "mesh_octnum"),
    "hfield": ("hfield_size", "hfield_nrow", "hfield_ncol"),
    "texture": ("tex_type", "tex_height", "tex_width", "tex_nchannel", "tex_colorspace"),
}


class AssetContents:
    """The contents of the textures, materials, meshes and height fields of a model, as hashes."""

    def __init__(self, model: MjModel) -> None:
        self.model = model
        self.hashes: dict[str, list[str]] = {}
        for kind in ("texture", "material", "mesh", "hfield"):
            count = len(getattr(model, KINDS[kind].addresses))
            self.hashes[kind] = [self._hash(kind, number) for number in range(count)]

    def _hash(self, kind: str, number: int) -> str:
        whole = blake2b(digest_size=16)
        for each in self._numbers(kind, number):
            array = np.ascontiguousarray(each)
            whole.update(f"{array.shape}".encode())
            whole.update(array.tobytes())
        if kind == "material":
            for texture in self.model.mat_texid[number].tolist():
                whole.update(self.hashes["texture"][texture].encode() if texture >= 0 else b"-")
        return whole.hexdigest()

    def _numbers(self, kind: str, number: int) -> Iterator[Any]:
        model: Any = self.model
        if kind == "material":
            names = (name for name in dir(model) if name.startswith("mat_") and name != "mat_texid")
            yield from (getattr(model, name)[number] for name in names)
        for name in _PROPERTIES.get(kind, ()):
            if hasattr(model, name):
                yield getattr(model, name)[number]
        for name in _DATA.get(kind, ()):
            yield numbers_of(self.model, kind, name, number)
