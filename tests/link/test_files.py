from __future__ import annotations

import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
import pytest
from link.workshop import BASE, Linked, Piece, Workshop, obj
from mjcompose.base.access import own_door
from mjcompose.base.diagnostic import Span
from mjcompose.base.naming import is_portable
from mjcompose.base.sink import Sink
from mjcompose.link.collect import collect
from mjcompose.link.files import KINDS, Merged, NamedFile, add_file, dedup, files, path_in_assets
from mjcompose.link.link import link as link_link_link
from mjcompose.link.linking import FileUse, Linking, Part
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tree.files import SourceSettings
from mjcompose.tree.unit import Unit


def png(red: int = 255) -> bytes:
    """A picture of one color, another one for each shade."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = zlib.compress(b"".join(b"\0" + bytes([red, 0, 0]) * 2 for _ in range(2)))
    header = struct.pack(">IIBBBBB", 2, 2, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def hills(height: float = 1) -> bytes:
    return struct.pack("<2i4f", 2, 2, 0, height, 0, height / 2)


def skin(*bones: str) -> bytes:
    data = struct.pack("<4i", 3, 0, 1, len(bones)) + struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    data += struct.pack("<3i", 0, 1, 2)
    for bone in bones:
        data += bone.encode().ljust(40, b"\0") + struct.pack("<7f", 0, 0, 0, 1, 0, 0, 0)
        data += struct.pack("<i3i3f", 3, 0, 1, 2, 1, 1, 1)
    return data


def paths(uses: list[FileUse]) -> list[str]:
    return [use.path for use in uses]


FOLDERS = {
    "beside": ("", "a.obj", "t.png"),
    "meshdir": ('meshdir="m"', "m/a.obj", "t.png"),
    "texturedir": ('texturedir="t"', "a.obj", "t/t.png"),
    "both": ('meshdir="m/" texturedir="./t//u"', "m/a.obj", "t/u/t.png"),
    "assetdir": ('assetdir="x"', "x/a.obj", "x/t.png"),
    "the specific one wins": ('meshdir="m" assetdir="x"', "m/a.obj", "x/t.png"),
    "outside": ('meshdir="../m" texturedir="../m"', "../m/a.obj", "../m/t.png"),
    "with spaces": ('assetdir="a folder"', "a folder/a.obj", "a folder/t.png"),
    "in unicode": ('assetdir="Gerät"', "Gerät/a.obj", "Gerät/t.png"),
    "backslash": (r'assetdir="x\y"', "x/y/a.obj", "x/y/t.png"),
}
ASSETS = """
<mujoco><compiler {folders}/><asset><mesh file="a.obj"/><texture name="t" type="2d" file="t.png"/>
  <material name="m" texture="t"/></asset>
  <worldbody><body name="b"><geom type="mesh" mesh="a" material="m"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(("folders", "mesh", "texture"), FOLDERS.values(), ids=FOLDERS.keys())
@pytest.mark.parametrize("role", ["base", "part"])
def test_files_are_found_where_mujoco_finds_them(
    workshop: Workshop, folders: str, mesh: str, texture: str, role: str
) -> None:
    text = ASSETS.format(folders=folders)
    content = {mesh: obj(), texture: png()}
    if role == "base":
        linked = workshop.link(text, BASE, files=content)
    else:
        linked = workshop.link(BASE, Piece(text, files=content))
    linked.check()
    assert paths(linked.linking.files) == [f"assets/{role}/a.obj", f"assets/{role}/t.png"]
    assert "dir=" not in linked.xml


def test_every_kind_of_file_is_bundled(workshop: Workshop) -> None:
    part = """
    <mujoco><asset>
      <mesh file="d/a.obj" name="a"/><hfield file="h.bin" size="1 1 1 1"/>
      <texture name="c" type="cube" fileright="r.png" fileleft="l.png" fileup="u.png" filedown="d.png"
        filefront="f.png" fileback="b.png"/>
      <skin file="s.skn"/>
    </asset><worldbody>
      <geom name="g" type="hfield" hfield="h"/><body name="b"><geom type="mesh" mesh="a"/>
      <flexcomp name="cloth" type="mesh" file="f.obj" dim="2" mass="1" radius=".01"/></body>
    </worldbody><deformable><skin name="second" file="s.skn"/></deformable></mujoco>"""
    content = {"d/a.obj": obj(), "h.bin": hills(), "s.skn": skin("b", "world"), "f.obj": obj(0.3)}
    content |= {f"{side}.png": png(at) for at, side in enumerate("rludfb")}
    linked = workshop.link(BASE, Piece(part, files=content))
    linked.check()
    assert sorted(linked.bundled()) == sorted(f"assets/part/{name}" for name in content)
    workshop.link(part, BASE, files=content).check()


def test_the_bones_of_a_skin_follow_the_prefix(workshop: Workshop) -> None:
    part = """<mujoco><asset><skin file="s.skn"/></asset>
      <worldbody><body name="upper"><geom size=".1"/></body><body name="lower"><geom size=".1"/></body></worldbody></mujoco>"""
    piece = {"s.skn": skin("upper", "lower")}
    linked = workshop.link(part, Piece(part, "a/", files=piece), Piece(part, "b/", files=piece), files=piece)
    model = linked.check()
    bodies = [model.body(index).name for index in model.skin_bonebodyid]
    assert bodies == ["upper", "lower", "a/upper", "a/lower", "b/upper", "b/lower"]
    assert len(linked.bundled()) == 3


@pytest.mark.parametrize(
    ("content", "reason"),
    [(b"short", "not a skin file"), (skin("b") + b"more", "not a skin file"), (skin("b" * 36), "39 bytes")],
)
def test_a_skin_that_cannot_be_renamed_is_told(workshop: Workshop, content: bytes, reason: str) -> None:
    part = '<mujoco>\n<asset><skin file="s.skn"/></asset></mujoco>'
    fault = workshop.link(BASE, Piece(part, files={"s.skn": content})).fault
    assert (fault.code, fault.span and fault.span.line) == ("not-supported", 2)
    assert reason in fault.message


def test_strippath_leaves_the_last_step(workshop: Workshop) -> None:
    part = """<mujoco><compiler strippath="true" meshdir="m/n"/><asset><mesh file="any/where/a.obj"/>
      <mesh file="C:\\old\\b.obj"/></asset>
      <worldbody><body name="b"><geom type="mesh" mesh="a"/><geom type="mesh" mesh="b"/></body></worldbody></mujoco>"""
    linked = workshop.link(BASE, Piece(part, files={"m/n/a.obj": obj(), "m/n/b.obj": obj(0.2)}))
    assert paths(linked.linking.files) == ["assets/part/a.obj", "assets/part/b.obj"]
    assert "strippath" not in linked.xml
    linked.check()


def test_an_absolute_path_is_bundled_under_its_last_step(workshop: Workshop, tmp_path: Path) -> None:
    (tmp_path / "else where").mkdir()
    file = tmp_path / "else where" / "a.obj"
    file.write_bytes(obj())
    part = f"""<mujoco><compiler meshdir="m"/><asset><mesh file="{file}"/></asset>
      <worldbody><body name="b"><geom type="mesh" mesh="a"/></body></worldbody></mujoco>"""
    linked = workshop.link(BASE, part)
    assert paths(linked.linking.files) == ["assets/part/a.obj"]
    linked.check()


def meshes(*names: str) -> str:
    assets = "".join(f'<mesh name="m{at}" file="{name}"/>' for at, name in enumerate(names))
    geoms = "".join(f'<geom type="mesh" mesh="m{at}"/>' for at in range(len(names)))
    return f'<mujoco><asset>{assets}</asset><worldbody><body name="b">{geoms}</body></worldbody></mujoco>'


NAMES = {
    "one name in two folders": ["x/a.obj", "y/a.obj"],
    "a name twice": ["a.obj", "a.obj"],
    "a name in two ways": ["a.obj", "./a.obj", "x/../a.obj"],
    "outside and inside": ["../m/a.obj", "m/a.obj"],
    "from outside to outside": ["../m/../n/a.obj", "n/a.obj"],
    "spaces": ["a b.obj", " a.obj"],
    "unicode": ["Schraube_ü.obj", "螺丝.obj"],
    "several dots": ["a.b.obj", "..a.obj", ".a.obj"],
    "no letters": ["1/2.obj", "1/2-2.obj"],
    "special letters": ["a&amp;b.obj", "it's.obj", "a%20b.obj", "#1.obj"],
}


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES.keys())
def test_names_of_files_of_all_kinds(workshop: Workshop, names: list[str]) -> None:
    content = {name.replace("&amp;", "&"): obj(0.1 + at / 10) for at, name in enumerate(names)}
    content.pop("./a.obj", None)
    content.pop("x/../a.obj", None)
    content.pop("../m/../n/a.obj", None)
    content |= {"x/y": b""}
    if "../m/../n/a.obj" in names:
        content |= {"../n/a.obj": obj(0.7), "../m/y": b""}
    text = meshes(*names)
    linked = workshop.link(text, Piece(text, files=content), files=content)
    linked.check()
    assert all(".." not in path.split("/") for path in linked.bundled())


def test_names_that_differ_in_case_alone_stay_apart(workshop: Workshop) -> None:
    """In a bundle that is unpacked on a file system that does not tell them apart."""
    text = meshes("a.obj", "A.obj", "x/a.obj", "X/a.obj")
    content = {name: obj(0.1 + at / 10) for at, name in enumerate(["a.obj", "A.obj", "x/a.obj", "X/a.obj"])}
    linked = workshop.link(text, BASE, files=content)
    linked.check()
    bundled = linked.bundled()
    assert len({path.lower() for path in bundled}) == len(bundled) == 4


def test_equal_bytes_are_stored_once(workshop: Workshop) -> None:
    text = """<mujoco><asset><mesh file="a.obj"/><mesh file="b.obj"/><mesh name="c" file="c.OBJ"/></asset>
      <worldbody><body name="b"><geom type="mesh" mesh="a"/><geom type="mesh" mesh="b"/><geom type="mesh" mesh="c"/></body>
      </worldbody></mujoco>"""
    content = dict.fromkeys(["a.obj", "b.obj", "c.OBJ"], obj())
    linked = workshop.link(text, Piece(text, files=content), files=content)
    linked.check()
    assert sorted(linked.bundled()) == ["assets/base/a.obj", "assets/base/c.OBJ"]
    assert 'file="assets/base/a.obj" name="b"' in linked.xml, "what was called after its file keeps its name"


def test_units_of_one_label_share_a_folder_while_their_files_are_the_same(workshop: Workshop) -> None:
    text = meshes("a.obj", "b.obj")
    first = {"a.obj": obj(0.1), "b.obj": obj(0.2)}
    second = {"a.obj": obj(0.3), "b.obj": obj(0.2)}
    linked = workshop.link(
        text,
        Piece(text, "x/", files=second, label="robot"),
        Piece(text, "y/", files=first, label="robot"),
        files=first,
        label="robot",
    )
    linked.check()
    assert sorted(linked.bundled()) == ["assets/robot-2/a.obj", "assets/robot/a.obj", "assets/robot/b.obj"]


def test_the_label_of_another_unit_is_not_taken(workshop: Workshop) -> None:
    text = meshes("a.obj")
    scales = [{"a.obj": obj(0.1 * at)} for at in (1, 2, 3)]
    linked = workshop.link(
        text,
        Piece(text, "x/", files=scales[1], label="robot"),
        Piece(text, "y/", files=scales[2], label="robot-2"),
        files=scales[0],
        label="robot",
    )
    linked.check()
    assert len(linked.bundled()) == 3


@pytest.mark.parametrize("label", ["my robot", "Roboter-Übung", "a.b", "x'y"])
def test_labels_of_all_kinds(workshop: Workshop, label: str) -> None:
    text = meshes("a.obj")
    linked = workshop.link(BASE, Piece(text, files={"a.obj": obj()}, label=label))
    linked.check()
    assert paths(linked.linking.files) == [f"assets/{label}/a.obj"]


def test_a_missing_file_is_told_where_it_is_named(workshop: Workshop) -> None:
    text = '<mujoco><asset>\n  <mesh file="arm.obj"/></asset></mujoco>'
    linked = workshop.link(BASE, Piece(text, files={"Arm.obj": obj()}))
    assert collect(linked.linking.base, linked.linking.files, linked.sink) == {}
    fault = linked.fault
    assert fault.code == "asset-missing"
    assert fault.span is not None
    assert (fault.span.file, fault.span.line) == (str(linked.paths[1]), 2)
    assert "Arm.obj" in (fault.help or "")


def test_a_missing_skin_is_told_once(workshop: Workshop) -> None:
    linked = workshop.link(BASE, '<mujoco><asset><skin file="s.skn"/></asset></mujoco>')
    assert not linked.sink.has_errors
    collect(linked.linking.base, linked.linking.files, linked.sink)
    assert linked.fault.code == "asset-missing"


def test_assets_of_an_included_file_stand_beside_the_main_file(workshop: Workshop) -> None:
    part = '<mujoco><compiler meshdir="m"/><include file="sub/assets.xml"/></mujoco>'
    included = """<mujoco><asset><mesh file="a.obj"/></asset>
      <worldbody><body name="b"><geom type="mesh" mesh="a"/></body></worldbody></mujoco>"""
    content = {"sub/assets.xml": included, "m/a.obj": obj()}
    workshop.link(BASE, Piece(part, files=content)).check()


def composed(workshop: Workshop, linking: Linking) -> Unit:
    """A composition as a unit of its own, as a nested recipe gives one."""
    base = linking.base
    known = {use.path: use.content if use.content is not None else Path(use.source) for use in linking.files}
    return Unit(base.root, base.file, base.directory, base.label, known, base.origins)


def test_the_files_of_a_composition_keep_their_paths(workshop: Workshop) -> None:
    text = meshes("a.obj").replace("</mujoco>", '<asset><skin file="s.skn"/></asset></mujoco>')
    content = {"a.obj": obj(), "s.skn": skin("b")}
    inner = workshop.link(BASE, Piece(text, "arm/", files=content))
    outer = Linking(workshop.unit(BASE), [Part(composed(workshop, inner.linking), "left/")], Sink())
    assert link_link_link(outer)
    assert paths(outer.files) == ["assets/part/a.obj", "assets/part/s.skn"]
    data = collect(outer.base, outer.files, outer.sink)
    assert b"left/arm/b\0" in data["assets/part/s.skn"]
    assert data["assets/part/a.obj"] == obj()


def test_a_composition_may_bring_a_path_that_is_taken(workshop: Workshop) -> None:
    inner = workshop.link(BASE, Piece(meshes("a.obj"), "arm/", files={"a.obj": obj(0.5)}))
    base = workshop.unit(meshes("a.obj"), {"a.obj": obj(0.1)}, "part")
    outer = Linking(base, [Part(composed(workshop, inner.linking), "left/")], Sink())
    assert link_link_link(outer)
    assert paths(outer.files) == ["assets/part/a.obj", "assets/part-2/a.obj"]


def test_files_of_the_recipe_itself_do_not_meet_those_of_parts(workshop: Workshop, tmp_path: Path) -> None:
    linked = workshop.link(meshes("a.obj"), files={"a.obj": obj()}, label="my")
    linking = linked.linking
    root = linking.base.root
    elements = [root.makeelement("mesh") for _ in range(4)]
    door = own_door(tmp_path / "recipe.yaml")
    for element, name in zip(elements, ["my/a.obj", "../my/a.obj", "my/a.obj", r"x\.\y.obj"], strict=True):
        span = Span("recipe.yaml", 1, 1)
        add_file(linking, NamedFile(element, "file", name, folder=tmp_path / "in", door=door, span=span))
    assert [element.get("file") for element in elements] == [
        "assets/2/my/a.obj",
        "assets/3/my/a.obj",
        "assets/2/my/a.obj",
        "assets/x/y.obj",
    ]
    assert linking.files[-1].source == f"{tmp_path}/in/x/y.obj"


@pytest.mark.parametrize(
    ("settings", "written", "expected"),
    [
        (SourceSettings(meshdir="m"), "m/a.obj", "a.obj"),
        (SourceSettings(meshdir="m"), "more/a.obj", "more/a.obj"),
        (SourceSettings(texturedir="t/u/"), "t/u/v/a.png", "v/a.png"),
        (SourceSettings(meshdir="../m"), "../m/a.obj", "a.obj"),
        (SourceSettings(), "../../x/a.obj", "x/a.obj"),
        (SourceSettings(), "/abs/x/a.obj", "a.obj"),
        (SourceSettings(), "C:/x/a.obj", "a.obj"),
        (SourceSettings(), "a..b/c.obj", "a..b/c.obj"),
    ],
)
def test_what_is_left_of_a_path_in_the_bundle(settings: SourceSettings, written: str, expected: str) -> None:
    assert path_in_assets(settings, written) == expected


def test_the_pass_by_itself_reads_no_file_but_skins(workshop: Workshop) -> None:
    unit = workshop.unit(meshes("not/there.obj"))
    linking = Linking(unit, [], Sink())
    files(linking)
    assert paths(linking.files) == ["assets/model/not/there.obj"]
    assert not linking.sink.diagnostics


PREFIXES = ("", "a/", "b/", "c/")
COUNTS = {"mesh": "nmesh", "material": "nmat", "texture": "ntex", "hfield": "nhfield"}


def robot(assets: str, geoms: str = "", head: str = "") -> str:
    return f"<mujoco>{head}<asset>{assets}</asset><worldbody><body name='b'>{geoms}</body></worldbody></mujoco>"


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
    for array in ("body_mass", "body_inertia", "geom_pos", "geom_quat", "geom_size", "geom_rgba", "geom_aabb", "qpos0"):
        assert np.array_equal(getattr(before, array), getattr(after, array)), array
    return merged


def _all_geoms(model: mujoco.MjModel) -> list[tuple[list[tuple[str, str]], list[bytes]]]:
    """Of every geom, the names of its mesh, material and textures, and their numbers."""
    found = []
    for geom in range(model.ngeom):
        names: list[tuple[str, str]] = []
        numbers: list[bytes] = []
        data = int(model.geom_dataid[geom])
        material = int(model.geom_matid[geom])
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
                    start = int(model.tex_adr[texture])
                    size = int(model.tex_height[texture] * model.tex_width[texture])
                    numbers.append(model.tex_data[start : start + size].tobytes())
        found.append((names, numbers))
    return found


def test_copies_share_everything_of_each_kind(workshop: Workshop) -> None:
    linked = link(workshop, FULL, FULL, FULL)
    merged = merge(linked)
    assert list(merged) == [kind for kind in KINDS if kind in merged] == list(KINDS)
    assert merged["mesh"] == {f"{part}/{name}": f"a/{name}" for part in "bc" for name in ("m", "half", "tetra")}
    assert set(merged["texture"]) == {"b/t", "b/cube", "c/t", "c/cube"}
    assert merged["material"]["c/layers"] == "a/layers"
    assert merged["hfield"] == {"b/h": "a/h", "c/h": "a/h"}
    assert 'material="b/' not in linked.xml, "classes follow as well"


DIFFERENT = {
    "an attribute": ('<material name="x" rgba="1 0 0 1"/>', '<material name="x" rgba="1 0 0 .5"/>'),
    "a class": ('<material name="x"/>', '<material name="x" class="dull"/>'),
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
    pieces = [Piece(robot(each, head=CLASSES), prefix, files=files) for each, prefix in ((one, "a/"), (other, "b/"))]
    linked = workshop.link(BASE, *pieces)
    merged = merge(linked)
    assert not any("b/x" in names for names in merged.values())
    same = merge(workshop.link(BASE, pieces[0], Piece(pieces[0].text, "b/", files=files)))
    assert any("b/x" in names for names in same.values())


SAME = {
    "a number written otherwise": (
        '<mesh name="x" file="m.obj" scale="1 2 3"/>',
        '<mesh name="x" file="m.obj" scale="1.0 2e0 3"/>',
    ),
    "from a class": ('<material name="x" shininess="0"/>', '<material name="x" class="dull"/>'),
    "another file of the same bytes": ('<mesh name="x" file="m.obj"/>', '<mesh name="x" file="copy.obj"/>'),
    "a name from the file": ('<mesh name="m" file="m.obj"/>', '<mesh file="m.obj"/>'),
    "another name": ('<mesh name="y" file="m.obj"/>', '<mesh name="z" file="m.obj"/>'),
}


@pytest.mark.parametrize(("one", "other"), SAME.values(), ids=SAME.keys())
def test_what_means_the_same_becomes_one(workshop: Workshop, one: str, other: str) -> None:
    files = {**FILES, "copy.obj": obj()}
    pieces = [Piece(robot(each, head=CLASSES), prefix, files=files) for each, prefix in ((one, "a/"), (other, "b/"))]
    merged = merge(workshop.link(BASE, *pieces))
    assert sum(len(names) for names in merged.values()) == 2  # and the texture of the class


def test_what_one_part_has_twice_stays_two(workshop: Workshop) -> None:
    """Names keep their own: `b/y` is not made `a/x` where `a/y` is there."""
    twice = robot(
        '<material name="x"/><material name="y"/>', '<geom size="1" material="y"/><geom size="1" material="x"/>'
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


@pytest.mark.parametrize(
    ("file", "path", "name"),
    [
        ("con.obj", "assets/aux_/con_.obj", "con"),
        ("wood: oak.obj", "assets/aux_/wood_ oak.obj", "wood: oak"),
        ("nul/link.obj", "assets/aux_/nul_/link.obj", "link"),
        ("end./a.obj", "assets/aux_/end_/a.obj", "a"),
        ("a\nb.obj", "assets/aux_/a_b.obj", "a\nb"),
        ("COM1.x.obj", "assets/aux_/COM1_.x.obj", "COM1.x"),
    ],
)
@pytest.mark.parametrize("alone", [True, False])
def test_files_get_paths_that_every_system_can_have(
    tmp_path: Path, file: str, path: str, name: str, *, alone: bool
) -> None:
    """An unnamed mesh keeps the name that MuJoCo gives it after its file."""
    written = file.replace("\n", "&#10;")
    mesh = name.replace("\n", "&#10;")
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_bytes(obj())
    geom = f'<worldbody><geom type="mesh" mesh="{mesh}"/></worldbody>'
    model = f'<mujoco><asset><mesh file="{written}"/></asset>{geom}</mujoco>'
    (tmp_path / "aux.xml").write_text(model)
    recipe = "recipe: 1\nbase: ./aux.xml\n" if alone else "recipe: 1\nattach: {part: {model: ./aux.xml}}\n"
    (tmp_path / "recipe.yaml").write_text(recipe)
    built = build(ModelRequest(tmp_path / "recipe.yaml"), context := Context(environment={}, folder=tmp_path))
    assert built is not None, context.sink.errors
    assert [each for each in built.bundle.files if each.startswith("assets/")] == [path]
    assert all(map(is_portable, built.bundle.files))
