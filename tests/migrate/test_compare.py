"""Two compiled models of one version: what differs is named, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from composer.migrate.compare import Outcome, compare
from composer.migrate.environments import Other, OtherError, open_python, this_python
from composer.migrate.wish import installed

MODEL = """\
<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1 .3 .3 .9"/></asset>
<worldbody><body name="a"><joint name="j" damping="1"/><geom name="g" size=".1" margin=".1"/>
  <geom type="mesh" mesh="m"/></body><body name="b" pos="3 0 0"><freejoint/><geom size=".2"/></body></worldbody>
<actuator><motor name="x" joint="j"/><position name="y" joint="j"/></actuator></mujoco>
"""


def compared(one: str, two: str, folder: Path) -> Outcome:
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
        ('<motor name="x" joint="j"/><position name="y" joint="j"/>', '<position name="y" joint="j"/><motor name="x" joint="j"/>', set()),
        ("<worldbody>", '<option><flag island="disable"/></option><worldbody>', {"flags.island"}),
        ('name="g"', 'name="h"', {"geom names"}),
        ('name="j" damping', 'name="j" type="slide" damping', {"jnt_type", "dof_invweight0", "dof_M0"}),
        (".3 .3 .9", ".3 .3 .91", {"mesh_face", "body_mass", "body_inertia", "body_ipos"}),
    ],
)  # fmt: skip
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
    with pytest.raises(OtherError):
        open_python(tmp_path)
    with pytest.raises(OtherError):
        open_python(tmp_path / "python")
