from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
from link.workshop import Piece, Workshop

pytestmark = pytest.mark.mujoco4("MuJoCo 3.12 has no `passthrough`")

ASKING, LOADING = 'passthrough="textures"', ""
TEXTURES = {"file": 'file="t.png"', "built": 'builtin="flat" width="4" height="4"', "none": None}


def textured(setting: str, texture: str | None) -> str:
    asset = "" if texture is None else f'<texture name="t" type="2d" {texture}/>'
    return f"<mujoco><compiler {setting}/><asset>{asset}</asset><worldbody><body/></worldbody></mujoco>"


@pytest.fixture(scope="session")
def picture() -> bytes:
    """One pixel, as PNG."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head, data = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0), zlib.compress(b"\0\1\2\3")
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    "of_base", [(ASKING, "file"), (ASKING, "built"), (LOADING, "file"), (ASKING, "none")]
)
@pytest.mark.parametrize(
    "of_part", [(ASKING, "file"), (ASKING, "built"), (LOADING, "file"), (LOADING, "none")]
)
def test_textures_stay_in_their_files_or_are_loaded_as_alone(
    workshop: Workshop, picture: bytes, of_base: tuple[str, str], of_part: tuple[str, str]
) -> None:
    base, part = (textured(setting, TEXTURES[kind]) for setting, kind in (of_base, of_part))
    linked = workshop.link(base, Piece(part, files={"t.png": picture}), files={"t.png": picture})
    if of_base[1] == of_part[1] == "file" and of_base[0] != of_part[0]:
        assert linked.fault.code == "compiler-setting"
        assert len(linked.fault.notes) == 1
    else:
        linked.check()


def test_a_model_of_one_unit_keeps_what_it_says(workshop: Workshop, picture: bytes) -> None:
    linked = workshop.link(textured(ASKING, 'file="t.png"'), files={"t.png": picture})
    assert np.array_equal(linked.alone(0).tex_data, linked.model().tex_data)
