"""The judge is judged: one number of every array of `mjModel` is changed, and `compare` must name exactly this array."""

from __future__ import annotations

import copy
import random
from functools import cache

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.arrays import ARRAYS, PLACED, Treatment, about
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.match import Mount
from mjcompose.mujoco.unchanged import compare
from mujoco.test_compare import HAND

pytestmark = pytest.mark.mujoco4("its attach does not find the material of a skin")

_USER = " ".join(f'nuser_{kind}="1"' for kind in ("body", "jnt", "site", "cam", "tendon", "actuator", "sensor"))
_MORE = """
  <body name="cup" pos="1 0 .1"><joint name="slide" type="slide"/><geom name="cup" size=".05"/></body>
  <body name="knob" pos="0 1 0">
    <joint name="round" type="ball"/>
    <geom name="knob" size=".02" material="skin"/>
    <camera name="follow" mode="targetbody" target="cup" sensorsize=".1 .1" focal=".1 .1" resolution="8 8"/>
    <light name="spot" mode="targetbody" target="cup" pos="0 0 1"/>
  </body>
  <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" radius=".01" dim="2" pos="2 0 0" mass=".1"
    material="skin">
    <edge damping=".1"/><elasticity young="100" poisson=".2" thickness=".01"/>
  </flexcomp>
  <geom name="ground" type="hfield" hfield="bumps" pos="5 0 0"/>
</worldbody>
<deformable>
  <skin name="sheet" vertex="0 0 0 1 0 0 0 1 0" texcoord="0 0 1 0 0 1" face="0 1 2" material="skin">
    <bone body="palm" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1" vertweight="1 1"/>
    <bone body="left" bindpos="0 0 0" bindquat="1 0 0 0" vertid="2 1" vertweight="1 1"/>
  </skin>
</deformable>
"""
_MESH = (
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
    "f 1/1 3/2 2/3\nf 1/1 2/3 4/2\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"
)
PART = (
    HAND[: HAND.index("<keyframe>")]
    .replace("<size ", f"<size {_USER} ")
    .replace('vertex="0 0 0  .2 0 0  0 .1 0  0 0 .1" scale=".5 .5 .5"', 'file="m.obj" scale=".2 .1 .1"')
    .replace("</worldbody>", _MORE)
) + '<keyframe><key name="open"/></keyframe></mujoco>'
BASE = f"""<mujoco><size nuser_geom="2" {_USER}/><worldbody><body name="post" pos="0 0 1">
  <geom size=".1"/><site name="flange" pos=".1 0 0" euler="0 30 0"/><body name="far"><geom size=".2"/></body>
</body></worldbody><keyframe><key name="k"/></keyframe></mujoco>"""
COMPARED_ELSEWHERE = {"qpos0", "qpos_spring", "wrap_prm", "flexedge_length0"}
"""Arrays that belong to no element, and whose numbers are compared by what they belong to."""


def _spec() -> mujoco.MjSpec:
    return mujoco.MjSpec.from_string(PART, assets={"m.obj": _MESH.encode()})


@cache
def models() -> tuple[mujoco.MjModel, mujoco.MjModel]:
    """The part alone, and on a turned site."""
    base = mujoco.MjSpec.from_string(BASE)
    base.attach(_spec(), prefix="p/", site=base.site("flange"))
    return _spec().compile(), base.compile()


def told(damaged: mujoco.MjModel, moved: bool) -> set[str]:
    """The arrays that differ between the damaged part and the part as it is."""
    alone, both = models()
    if not moved:
        return _arrays(compare(damaged, alone))
    return _arrays(compare(damaged, both, prefix="p/", hung_on=Mount.of(both, site="flange"), keys=KeyMode.PREFIX))


def _arrays(found: list[object]) -> set[str]:
    return {each.array.split("[")[0].split(",")[0] for each in found}  # type: ignore[attr-defined]


def _names() -> list[str]:
    alone, _ = models()
    found = (name for name in dir(alone) if not name.startswith(("_", "name")))
    return [name for name in found if isinstance(array := getattr(alone, name), np.ndarray) and array.size]


def _places(name: str, moved: bool) -> list[int]:
    """The numbers of an array that belong to the part alone, and not to its place: by their index in the flat array."""
    alone, _ = models()
    array = getattr(alone, name)
    treatment = about(name).treatment
    kind = name.split("_", 1)[0]
    rows = range(len(array))
    if kind == "body":
        rows = range(1, len(array))
    holders = {"body": alone.body_parentid, "geom": alone.geom_bodyid, "site": alone.site_bodyid}
    holders |= {"cam": alone.cam_bodyid, "light": alone.light_bodyid}
    if moved and treatment in (Treatment.ROOT_POSE, Treatment.HOST) and kind in holders:
        keep = 0 if treatment is Treatment.ROOT_POSE or kind != "body" else -1
        rows = [row for row in rows if int(holders[kind][row]) > keep]
    if name == "cam_intrinsic":  # of the others MuJoCo says the near plane of the whole model
        rows = [row for row in rows if alone.cam_sensorsize[row].any()]
    if name == "geom_dataid":  # of other shapes nobody reads it
        rows = [row for row in rows if alone.geom_dataid[row] >= 0]
    if name == "wrap_prm":  # a site has none
        rows = [row for row in rows if alone.wrap_type[row] == mujoco.mjtWrap.mjWRAP_JOINT]
    width = array.size // len(array)
    used = 1 if name == "actuator_trnid" else width  # none of these actuators has a second id
    return [row * width + column for row in rows for column in range(used)]


def damaged(model: mujoco.MjModel, name: str, at: int, value: float | None = None) -> None:
    """Change one number of an array."""
    flat = getattr(model, name).reshape(-1)
    assert np.shares_memory(flat, getattr(model, name))
    if flat.dtype.kind == "f":
        flat[at] = flat[at] * 1.5 + 0.25 if value is None else value
    elif flat.dtype.kind == "b":
        flat[at] = not flat[at]
    elif name != "exclude_signature" and about(name).treatment is Treatment.LINKED:
        flat[at] = min({*flat.tolist()} - {int(flat[at])}, default=-1 if flat[at] >= 0 else 0)  # an id that there is
    else:
        flat[at] = int(flat[at]) + (-1 if flat[at] > 0 else 1)


def _is_number(name: str) -> bool:
    """Whether one value of an array can be changed without others: a measure, or a flag."""
    dtype = getattr(models()[0], name).dtype
    return dtype.kind == "f" or dtype.itemsize == 1


def _not_compared(name: str, moved: bool) -> bool:
    """Whether the tables say, with a reason, that an array is not compared here."""
    how = about(name).treatment
    if how is Treatment.ELSEWHERE:
        return name not in COMPARED_ELSEWHERE
    if name.endswith("_plugin"):
        return True  # there is none, and no other id
    return how is Treatment.SKIPPED or (
        moved and (how is Treatment.DERIVED or PLACED in about(name).traits or name == "flex_size")
    )


@pytest.mark.parametrize("moved", [False, True], ids=["in place", "moved"])
@pytest.mark.parametrize("seed", range(3))
def test_one_number_of_every_array_of_numbers(moved: bool, seed: int) -> None:
    chosen = random.Random(seed)
    model = copy.copy(models()[0])
    expected = set()
    for name in _names():
        if not _is_number(name) or _not_compared(name, moved):
            continue
        places = _places(name, moved)
        if places:
            damaged(model, name, chosen.choice(places))
            expected.add(name)
    assert told(model, moved) == expected
    assert len(expected) > 100


@pytest.mark.parametrize("part", range(5))
def test_one_value_of_every_other_array(part: int) -> None:
    """Counts, kinds and ids: what depends on them may be told as well."""
    chosen = random.Random(part)
    unseen = set()
    for name in _names()[part::5]:
        if _is_number(name) or _not_compared(name, False):
            continue
        model = copy.copy(models()[0])
        damaged(model, name, chosen.choice(_places(name, False)))
        if not told(model, False):
            unseen.add(name)
    assert unseen == set()


def test_every_array_is_damaged() -> None:
    """What the tests above leave out is said with a reason in `arrays`, or is empty in this part."""
    left_out = {name for name in _names() if _not_compared(name, False)}
    said = {name for name in ARRAYS if about(name).treatment in (Treatment.SKIPPED, Treatment.ELSEWHERE)}
    assert left_out <= said | {name for name in _names() if name.endswith("_plugin")}


@pytest.mark.parametrize("moved", [False, True], ids=["in place", "moved"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_is_no_number_is_a_difference(moved: bool, value: float) -> None:
    names = "geom_friction body_mass jnt_range mesh_vert actuator_gainprm tendon_length0 qpos0 cam_fovy".split()
    model = copy.copy(models()[0])
    for name in names:
        damaged(model, name, _places(name, moved)[-1], value)
    assert told(model, moved) == {*names}
    assert _arrays(compare(models()[0], model)) == {*names}


@pytest.mark.parametrize("moved", [False, True], ids=["in place", "moved"])
@pytest.mark.parametrize("array", ["body_mass", "body_inertia", "body_ipos", "body_iquat", "body_subtreemass"])
def test_the_mass_of_what_stands_at_the_root_counts(moved: bool, array: str) -> None:
    """The place of a part changes the pose of its root bodies, and nothing else."""
    alone, _ = models()
    width = getattr(alone, array).size // alone.nbody
    for body in np.flatnonzero(alone.body_parentid == 0).tolist():
        if body:
            model = copy.copy(alone)
            damaged(model, array, body * width)
            assert told(model, moved) == {array}, alone.body(body).name
