from __future__ import annotations

import mujoco
import numpy as np
import pytest
from link.test_files import png
from link.workshop import BASE, Linked, Piece, Workshop, obj

from composer.link.dedup import KINDS, Merged, dedup

PREFIXES = ("", "a/", "b/", "c/")
COUNTS = {"mesh": "nmesh", "material": "nmat", "texture": "ntex", "hfield": "nhfield"}


def robot(assets: str, geoms: str = "", head: str = "") -> str:
    return (
        f"<mujoco>{head}<asset>{assets}</asset><worldbody><body name='b'>{geoms}</body></worldbody></mujoco>"
    )


FULL = robot(
    """<texture name="t" type="2d" file="t.png"/><texture name="cube" type="cube" fileright="t.png" rgb1="1 0 0"/>
    <material name="m" texture="t"/><material name="layers"><layer role="rgb" texture="t"/></material>
    <mesh file="m.obj"/><mesh name="half" file="m.obj" class="half"/><mesh name="tetra" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
    <hfield name="h" nrow="2" ncol="2" size="1 1 1 1" elevation="0 1 2 3"/>""",
    """<geom type="mesh" mesh="m" material="m"/><geom type="mesh" mesh="half" material="layers"/>
    <geom class="black" size="1"/><geom type="mesh" mesh="tetra"/><site material="m"/>
    <geom type="hfield" hfield="h"/>""",
    """<default><mesh scale="3 3 3"/><default class="half"><mesh scale=".5 .5 .5"/></default>
    <default class="black"><geom material="m"/></default></default>""",
)
FILES = {"t.png": png(), "m.obj": obj()}


def link(workshop: Workshop, *texts: str, **options: object) -> Linked:
    pieces = [
        Piece(text, prefix, files=FILES, label=f"robot{prefix[0]}")
        for text, prefix in zip(texts, PREFIXES[1:], strict=False)
    ]
    return workshop.link(BASE, *pieces, **options)


def merge(linked: Linked) -> Merged:
    """Merge, and prove that nothing else has changed."""
    before = linked.model()
    merged, uses = dedup(linked.linking.base, linked.linking.files, PREFIXES)
    linked.linking.files = list(uses)
    after = linked.model()
    for kind, count in COUNTS.items():
        assert getattr(before, count) - getattr(after, count) == len(merged.get(kind, {}))
    for mine, theirs in zip(_all_geoms(before), _all_geoms(after), strict=True):
        names = tuple(merged.get(kind, {}).get(name, name) for kind, name in mine[0])
        assert names == tuple(name for _, name in theirs[0])
        assert mine[1] == theirs[1]
    for array in (
        "body_mass",
        "body_inertia",
        "geom_pos",
        "geom_quat",
        "geom_size",
        "geom_rgba",
        "geom_aabb",
        "qpos0",
    ):
        assert np.array_equal(getattr(before, array), getattr(after, array)), array
    return merged


def _all_geoms(model: mujoco.MjModel) -> list[tuple[list[tuple[str, str]], list[bytes]]]:
    """Of every geom, the names of its mesh, material and textures, and their numbers."""
    found = []
    for geom in range(model.ngeom):
        names: list[tuple[str, str]] = []
        numbers: list[bytes] = []
        data, material = int(model.geom_dataid[geom]), int(model.geom_matid[geom])
        if data >= 0 and model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            names.append(("mesh", model.mesh(data).name))
            start = int(model.mesh_vertadr[data])
            numbers.append(model.mesh_vert[start : start + int(model.mesh_vertnum[data])].tobytes())
        elif data >= 0:
            names.append(("hfield", model.hfield(data).name))
        if material >= 0:
            names.append(("material", model.mat(material).name))
            numbers.append(model.mat_rgba[material].tobytes())
            for texture in model.mat_texid[material].tolist():
                if texture >= 0:
                    names.append(("texture", model.tex(texture).name))
                    start, size = (
                        int(model.tex_adr[texture]),
                        int(model.tex_height[texture] * model.tex_width[texture]),
                    )
                    numbers.append(model.tex_data[start : start + size].tobytes())
        found.append((names, numbers))
    return found


def test_copies_share_everything_of_each_kind(workshop: Workshop) -> None:
    linked = link(workshop, FULL, FULL, FULL)
    merged = merge(linked)
    assert list(merged) == [kind for kind in KINDS if kind in merged] == list(KINDS)
    assert merged["mesh"] == {
        f"{part}/{name}": f"a/{name}" for part in "bc" for name in ("m", "half", "tetra")
    }
    assert set(merged["texture"]) == {"b/t", "b/cube", "c/t", "c/cube"}
    assert merged["material"]["c/layers"] == "a/layers"
    assert merged["hfield"] == {"b/h": "a/h", "c/h": "a/h"}
    assert 'material="b/' not in linked.xml, "classes follow as well"


DIFFERENT = {
    "an attribute": ('<material name="x" rgba="1 0 0 1"/>', '<material name="x" rgba="1 0 0 .5"/>'),
    "a class": (
        '<material name="x"/>',
        '<material name="x" class="dull"/>',
    ),
    "a file": ('<mesh name="x" file="m.obj"/>', '<mesh name="x" file="n.obj"/>'),
    "what a texture shows": (
        '<texture name="x" type="2d" builtin="flat" width="2" height="2"/>',
        '<texture name="x" type="2d" builtin="flat" width="2" height="2" rgb1="1 0 0"/>',
    ),
    "a texture further on": (
        '<texture name="t" type="2d" builtin="flat" width="2" height="2"/><material name="x" texture="t"/>',
        '<texture name="t" type="2d" builtin="flat" width="4" height="2"/><material name="x" texture="t"/>',
    ),
    "a layer": (
        '<texture name="t" type="2d" builtin="flat" width="2" height="2"/><material name="x"><layer role="rgb" texture="t"/></material>',
        '<texture name="u" type="2d" builtin="flat" width="2" height="1"/><material name="x"><layer role="rgb" texture="u"/></material>',
    ),
    "a layer of a class": ('<material name="x"/>', '<material name="x" class="layered"/>'),
    "the kind of cube": (
        '<texture name="x" type="cube" fileright="t.png"/>',
        '<texture name="x" type="cube" fileleft="t.png"/>',
    ),
}
CLASSES = """<default><default class="dull"><material shininess="0"/></default>
  <default class="layered"><material><layer role="rgb" texture="from class"/></material></default></default>
  <asset><texture name="from class" type="2d" builtin="flat" width="8" height="8"/></asset>"""


@pytest.mark.parametrize(("one", "other"), DIFFERENT.values(), ids=DIFFERENT.keys())
def test_what_differs_stays_apart(workshop: Workshop, one: str, other: str) -> None:
    files = {**FILES, "n.obj": obj(0.7)}
    pieces = [
        Piece(robot(each, head=CLASSES), prefix, files=files) for each, prefix in ((one, "a/"), (other, "b/"))
    ]
    linked = workshop.link(BASE, *pieces)
    merged = merge(linked)
    assert not any("b/x" in names for names in merged.values())
    same = merge(workshop.link(BASE, pieces[0], Piece(pieces[0].text, "b/", files=files)))
    assert any("b/x" in names for names in same.values())


SAME = {
    "a number written otherwise": ('<mesh name="x" file="m.obj" scale="1 2 3"/>', '<mesh name="x" file="m.obj" scale="1.0 2e0 3"/>'),
    "from a class": ('<material name="x" shininess="0"/>', '<material name="x" class="dull"/>'),
    "another file of the same bytes": ('<mesh name="x" file="m.obj"/>', '<mesh name="x" file="copy.obj"/>'),
    "a name from the file": ('<mesh name="m" file="m.obj"/>', '<mesh file="m.obj"/>'),
    "another name": ('<mesh name="y" file="m.obj"/>', '<mesh name="z" file="m.obj"/>'),
}  # fmt: skip


@pytest.mark.parametrize(("one", "other"), SAME.values(), ids=SAME.keys())
def test_what_means_the_same_becomes_one(workshop: Workshop, one: str, other: str) -> None:
    files = {**FILES, "copy.obj": obj()}
    pieces = [
        Piece(robot(each, head=CLASSES), prefix, files=files) for each, prefix in ((one, "a/"), (other, "b/"))
    ]
    merged = merge(workshop.link(BASE, *pieces))
    assert sum(len(names) for names in merged.values()) == 2  # and the texture of the class


def test_what_one_part_has_twice_stays_two(workshop: Workshop) -> None:
    """Names keep their own: `b/y` is not made `a/x` where `a/y` is there."""
    twice = robot(
        '<material name="x"/><material name="y"/>',
        '<geom size="1" material="y"/><geom size="1" material="x"/>',
    )
    backwards = robot('<material name="y"/><material name="x"/>', '<geom size="1" material="x"/>')
    assert merge(link(workshop, twice, backwards)) == {"material": {"b/y": "a/y", "b/x": "a/x"}}
    assert merge(link(workshop, twice)) == {}
    three = robot('<material name="z"/><material name="y"/><material name="v"/>')
    assert merge(link(workshop, twice, three)) == {"material": {"b/z": "a/x", "b/y": "a/y"}}


def test_the_base_counts_as_a_part(workshop: Workshop) -> None:
    text = robot('<mesh file="m.obj"/>', '<geom type="mesh" mesh="m"/>')
    linked = workshop.link(text, Piece(text, "a/", files=FILES), files=FILES)
    assert merge(linked) == {"mesh": {"a/m": "m"}}


def test_units_of_parts_do_not_hide_that_they_are_equal(workshop: Workshop) -> None:
    text = robot('<mesh file="m.obj"/>', '<geom type="mesh" mesh="m"/>', '<compiler angle="{}"/>')
    assert merge(link(workshop, text.format("degree"), text.format("radian"))) == {"mesh": {"b/m": "a/m"}}


def test_every_reference_follows(workshop: Workshop) -> None:
    text = robot(
        '<mesh name="m" file="m.obj"/><material name="m"/><texture name="t" type="2d" builtin="flat" width="2" height="2"/>',
        """<geom name="g" type="mesh" mesh="m"/><site name="s"/><site name="e" pos="0 0 1"/>
        <flexcomp name="f" type="grid" count="2 2 1" spacing="1 1 1" dim="2" mass="1" radius=".1" material="m"/>
        <light texture="t"/>""",
    ).replace(
        "</mujoco>",
        """<tendon><spatial material="m"><site site="s"/><site site="e"/></spatial></tendon>
        <custom><tuple name="u"><element objtype="mesh" objname="m"/><element objtype="material" objname="m"/></tuple></custom>
        <sensor><tactile geom="g" mesh="m"/></sensor></mujoco>""",
    )
    linked = link(workshop, text, text)
    merge(linked)
    for attribute in ("mesh", "material", "texture"):
        assert f'{attribute}="b/' not in linked.xml


def test_a_file_that_is_not_there_is_told_later(workshop: Workshop) -> None:
    text = robot('<mesh file="lost.obj"/>')
    linked = link(workshop, text, text)
    merged, uses = dedup(linked.linking.base, linked.linking.files, PREFIXES)
    assert (merged, len(uses)) == ({}, 2), "they are in different folders"
