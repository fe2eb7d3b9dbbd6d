from __future__ import annotations

import struct
import zlib
from pathlib import Path

import pytest
from link.workshop import BASE, Piece, Workshop, obj

from composer.bundle.collect import collect
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.link.files import add_file, files, inside
from composer.link.link import link
from composer.link.linking import FileUse, Linking
from composer.link.part import Part
from composer.reading.project import own_door
from composer.tree.settings import Settings
from composer.tree.unit import Unit


def png(red: int = 255) -> bytes:
    """A picture of one colour, another one for each shade."""

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
    text, content = ASSETS.format(folders=folders), {mesh: obj(), texture: png()}
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
    [
        (b"short", "not a skin file"),
        (skin("b") + b"more", "not a skin file"),
        (skin("b" * 36), "39 bytes"),
    ],
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
        text, Piece(text, "x/", files=second, label="robot"), Piece(text, "y/", files=first, label="robot"),
        files=first, label="robot",
    )  # fmt: skip
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
    assert link(outer)
    assert paths(outer.files) == ["assets/part/a.obj", "assets/part/s.skn"]
    data = collect(outer.base, outer.files, outer.sink)
    assert b"left/arm/b\0" in data["assets/part/s.skn"]
    assert data["assets/part/a.obj"] == obj()


def test_a_composition_may_bring_a_path_that_is_taken(workshop: Workshop) -> None:
    inner = workshop.link(BASE, Piece(meshes("a.obj"), "arm/", files={"a.obj": obj(0.5)}))
    base = workshop.unit(meshes("a.obj"), {"a.obj": obj(0.1)}, "part")
    outer = Linking(base, [Part(composed(workshop, inner.linking), "left/")], Sink())
    assert link(outer)
    assert paths(outer.files) == ["assets/part/a.obj", "assets/part-2/a.obj"]


def test_files_of_the_recipe_itself_do_not_meet_those_of_parts(workshop: Workshop, tmp_path: Path) -> None:
    linked = workshop.link(meshes("a.obj"), files={"a.obj": obj()}, label="my")
    linking = linked.linking
    root = linking.base.root
    elements = [root.makeelement("mesh") for _ in range(4)]
    door = own_door(tmp_path / "recipe.yaml")
    for element, name in zip(elements, ["my/a.obj", "../my/a.obj", "my/a.obj", r"x\.\y.obj"], strict=True):
        add_file(linking, tmp_path / "in", element, "file", name, door, Span("recipe.yaml", 1, 1))
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
        (Settings(meshdir="m"), "m/a.obj", "a.obj"),
        (Settings(meshdir="m"), "more/a.obj", "more/a.obj"),
        (Settings(texturedir="t/u/"), "t/u/v/a.png", "v/a.png"),
        (Settings(meshdir="../m"), "../m/a.obj", "a.obj"),
        (Settings(), "../../x/a.obj", "x/a.obj"),
        (Settings(), "/abs/x/a.obj", "a.obj"),
        (Settings(), "C:/x/a.obj", "a.obj"),
        (Settings(), "a..b/c.obj", "a..b/c.obj"),
    ],
)
def test_what_is_left_of_a_path_in_the_bundle(settings: Settings, written: str, expected: str) -> None:
    assert inside(settings, written) == expected


def test_the_pass_by_itself_reads_no_file_but_skins(workshop: Workshop) -> None:
    unit = workshop.unit(meshes("not/there.obj"))
    linking = Linking(unit, [], Sink())
    files(linking)
    assert paths(linking.files) == ["assets/model/not/there.obj"]
    assert not linking.sink.diagnostics
