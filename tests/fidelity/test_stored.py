"""Files whose time tells their content, so that MuJoCo's cache can be trusted."""

from __future__ import annotations

import mujoco
from fidelity import stored

MODEL = b"""
<mujoco>
  <asset><mesh name="m" file="a.obj"/></asset>
  <worldbody><geom type="mesh" mesh="m"/></worldbody>
</mujoco>
"""


def _cube(size: int) -> bytes:
    return f"v 0 0 0\nv {size} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n".encode()


def test_only_what_is_given_is_there() -> None:
    stored.folder("test", {"a/b.txt": b"1", "c.txt": b"2"})
    place = stored.folder("test", {"c.txt": b"3"})
    assert [path.name for path in place.iterdir()] == ["c.txt"]
    assert (place / "c.txt").read_bytes() == b"3"


def test_a_content_always_has_the_same_time_and_no_other_has_it() -> None:
    times = [int((stored.folder("test", {"a.obj": _cube(size)}) / "a.obj").stat().st_mtime) for size in (1, 2, 1)]
    assert times[0] == times[2] != times[1]


def test_mujoco_never_takes_a_file_for_another() -> None:
    widths = []
    for size in (1, 2, 1, 3):
        place = stored.folder("test", {"model.xml": MODEL, "a.obj": _cube(size)})
        model = mujoco.MjModel.from_xml_path(str(place / "model.xml"))
        widths.append(round(float(model.mesh_vert[:, 0].max() - model.mesh_vert[:, 0].min()), 3))
    assert widths[0] == widths[2]
    assert len(set(widths)) == 3
