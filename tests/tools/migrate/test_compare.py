"""Two compiled models of one version: what differs is named, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mjcompose.mujoco.environments import Other, open_python, this_python
from mjcompose.mujoco.programs import ProgramError
from mjcompose.tools.migrate.compare import ArrayComparison, compare
from mjcompose.tools.migrate.migrate import installed

MODEL = """\
<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1 .3 .3 .9"/></asset>
<worldbody><body name="a"><joint name="j" damping="1"/><geom name="g" size=".1" margin=".1"/>
  <geom type="mesh" mesh="m"/></body><body name="b" pos="3 0 0"><freejoint/><geom size=".2"/></body></worldbody>
<actuator><motor name="x" joint="j"/><position name="y" joint="j"/></actuator></mujoco>
"""


def compared(one: str, two: str, folder: Path) -> ArrayComparison:
    other = Other(this_python(), installed())
    found = []
    for name, text in (("one", one), ("two", two)):
        (folder / f"{name}.xml").write_text(text)
        found.append(other.compile(folder / f"{name}.xml", folder / f"{name}.npz"))
    return compare(found[0], found[1])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "arrays"),
    [
        ("<worldbody>", "<worldbody>", set()),
        ('damping="1"', 'damping="2"', {"dof_damping"}),
        ('margin=".1"', 'margin=".2"', {"geom_margin"}),
        (
            '<motor name="x" joint="j"/><position name="y" joint="j"/>',
            '<position name="y" joint="j"/><motor name="x" joint="j"/>',
            set(),
        ),
        ("<worldbody>", '<option><flag island="disable"/></option><worldbody>', {"flags.island"}),
        ('name="g"', 'name="h"', {"geom names"}),
        ('name="j" damping', 'name="j" type="slide" damping', {"jnt_type", "dof_invweight0", "dof_M0"}),
        (".3 .3 .9", ".3 .3 .91", {"mesh_face", "body_mass", "body_inertia", "body_ipos"}),
    ],
)
def test_what_differs(old: str, new: str, arrays: set[str], tmp_path: Path) -> None:
    outcome = compared(MODEL, MODEL.replace(old, new), tmp_path)
    found = {each.array for each in outcome.differences}
    assert arrays <= found if arrays else not found, [each.words() for each in outcome.differences]
    assert not outcome.apart


@pytest.mark.slow
def test_a_difference_names_its_element(tmp_path: Path) -> None:
    outcome = compared(MODEL, MODEL.replace('damping="1"', 'damping="2"'), tmp_path)
    (found,) = outcome.differences
    assert found.words() == "`dof_damping` of joint `j`: 1 before, 2 now"


def test_a_python_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(ProgramError):
        open_python(tmp_path)
    with pytest.raises(ProgramError):
        open_python(tmp_path / "python")


SKY = """<mujoco><asset><texture name="sky" type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 0" width="32"
  height="192" mark="{}" markrgb="1 .5 1" random="{}"/></asset><worldbody/></mujoco>"""


@pytest.mark.parametrize(
    ("mark", "share", "changed", "same"),
    [
        ("random", ".05", "moved", True),
        ("random", ".05", "fewer", False),
        ("random", ".05", "another pixel", False),
        ("edge", "0", "fewer", False),
    ],
)
def test_random_marks_may_be_anywhere(mark: str, share: str, changed: str, same: bool, tmp_path: Path) -> None:
    """As many of them: MuJoCo 3.1 draws them with another generator."""
    (tmp_path / "sky.xml").write_text(SKY.format(mark, share))
    other = Other(this_python(), installed())
    one = other.compile(tmp_path / "sky.xml", tmp_path / "one.npz")
    with np.load(tmp_path / "one.npz") as stored:
        arrays = {name: stored[name] for name in stored.files}
    name = next(each for each in ("tex_data", "tex_rgb") if each in arrays)
    pixels = arrays[name].reshape(192, 32, 3)
    marked = (pixels == (255, 127, 255)).all(axis=2)
    assert 100 < marked.sum() < 2000
    plain = np.where(marked[..., None], pixels[np.arange(192), np.argmin(marked, axis=1)][:, None], pixels)
    wanted = marked[:, ::-1] if changed == "moved" else marked
    if changed == "fewer":
        wanted = marked & (np.arange(32) < 8)
    moved = np.where(wanted[..., None], np.array((255, 127, 255), dtype=pixels.dtype), plain)
    if changed == "another pixel":
        moved[5, 5] = 3
    np.savez(tmp_path / "two.npz", **(arrays | {name: moved.ravel()}))
    found = compare(one, replace(one, arrays=tmp_path / "two.npz"))
    assert found.same is same, [each.words() for each in found.differences]
