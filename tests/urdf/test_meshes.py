"""Meshes that MuJoCo does not read, and those that are hardly meant as they are."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.link.measure import folder_of
from mjcompose.mujoco.shapes import is_flat
from mjcompose.tree.xml_text import write
from mjcompose.urdf.read import UrdfReader
from urdf.parts import ARM, INERTIAL, link, robot

Reader = Callable[..., UrdfReader]
DATA = Path(__file__).parent / "data"
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def obj(scale: float = 0.2, *, flat: bool = False, faces: int = 4) -> str:
    rows = [f"v {scale * x} {scale * y} {0 if flat else scale * z}" for x, y, z in CORNERS]
    rows += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES[:faces]]
    return "\n".join(rows) + "\n"


def ascii_stl() -> str:
    rows = ["solid wedge"]
    for face in FACES:
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += [f"vertex {0.2 * CORNERS[k][0]} {0.2 * CORNERS[k][1]} {0.2 * CORNERS[k][2]}" for k in face]
        rows += ["endloop", "endfacet"]
    return "\n".join([*rows, "endsolid"]) + "\n"


def shape(file: str, tag: str = "collision", inside: str = "") -> str:
    return f'<{tag}><geometry><mesh filename="{file}"/></geometry>{inside}</{tag}>'


def told(read: UrdfReader) -> list[str]:
    read.unit()
    return [each.code for each in read.sink.sorted() if each.code != "urdf-unread"]


@pytest.mark.parametrize(
    ("mesh", "inertial", "codes"),
    [
        (obj(), INERTIAL, []),
        (obj(300.0), INERTIAL, ["mesh-size"]),
        (obj(0.0005), INERTIAL, ["mesh-size"]),
        (obj(faces=3), INERTIAL, []),
        (obj(faces=3), "", ["mesh-shape", "urdf-mass"]),
    ],
    ids=["plausible", "in millimeters", "scaled twice", "open beside an inertial", "open"],
)
def test_what_is_plausible(reader: Reader, tmp_path: Path, mesh: str, inertial: str, codes: list[str]) -> None:
    (tmp_path / "m.obj").write_text(mesh)
    assert told(reader("r.urdf", robot(ARM[0], link("upper", inertial + shape("m.obj")), *ARM[2:]))) == codes


def test_a_flat_mesh_is_reported_once(reader: Reader, tmp_path: Path) -> None:
    """As an error where MuJoCo refuses it, which 4.0 does, and as a warning where not."""
    (tmp_path / "m.obj").write_text(obj(flat=True))
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape("m.obj")), *ARM[2:]))
    read.unit()
    (found,) = (each for each in read.sink.sorted() if each.code != "urdf-unread")
    assert found.code in ("mujoco-rejects", "mesh-shape")
    assert found.help == "use a box, or a mesh with a thickness"
    assert found.span and found.span.line == 3 and found.span.column > 100


@pytest.mark.parametrize("tilted", [0.0, 1.0])
def test_what_is_flat(tilted: float) -> None:
    numpy = pytest.importorskip("numpy")
    plate = numpy.array([(x, y, tilted * x) for x, y, _ in CORNERS] + [(1, 1, tilted)])
    assert is_flat(plate)
    assert not is_flat(numpy.array([*plate, (0, 0, 1e-3)]))


def test_the_help_for_millimetres_is_right(reader: Reader, tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(obj(300.0))
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape("m.obj")), *ARM[2:]))
    read.unit()
    (warning,) = (each for each in read.sink.sorted() if each.code == "mesh-size")
    assert warning.help == 'if its file is in millimeters, write `scale="0.001 0.001 0.001"`'
    assert warning.span and warning.span.line == 3


def test_stl_as_text(reader: Reader, tmp_path: Path) -> None:
    (tmp_path / "m.stl").write_text(ascii_stl())
    unit = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape("m.stl")), *ARM[2:])).unit()
    assert unit is not None
    (mesh,) = unit.root.iterfind("asset/mesh")
    assert mesh.get("file") == "converted/m.obj" and unit.contents["converted/m.obj"].count(b"\nf ") == 4  # type: ignore[union-attr]


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
 <library_effects>{effects}</library_effects><library_materials>{materials}</library_materials>
 <library_geometries>{geometries}</library_geometries>
 <library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""


def collada(*colors: str) -> str:
    """A wedge for each color, 20 cm large."""
    given: dict[str, list[str]] = {"effects": [], "materials": [], "geometries": [], "nodes": []}
    for k, color in enumerate(colors):
        given["effects"].append(
            f'<effect id="e{k}"><profile_COMMON><technique sid="t"><lambert><diffuse><color>{color}</color></diffuse>'
            "</lambert></technique></profile_COMMON></effect>"
        )
        given["materials"].append(f'<material id="m{k}" name="m{k}"><instance_effect url="#e{k}"/></material>')
        places = " ".join(f"{20 * x + k} {20 * y} {20 * z}" for x, y, z in CORNERS)
        corners = " ".join(str(each) for face in FACES for each in face)
        given["geometries"].append(
            f'<geometry id="g{k}"><mesh><source id="p{k}"><float_array id="a{k}" count="12">{places}</float_array>'
            f'<technique_common><accessor source="#a{k}" count="4" stride="3"><param name="X" type="float"/>'
            '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
            f'<vertices id="v{k}"><input semantic="POSITION" source="#p{k}"/></vertices>'
            f'<triangles count="4" material="s{k}"><input semantic="VERTEX" source="#v{k}" offset="0"/><p>{corners}</p>'
            "</triangles></mesh></geometry>"
        )
        given["nodes"].append(
            f'<node id="n{k}"><instance_geometry url="#g{k}"><bind_material><technique_common>'
            f'<instance_material symbol="s{k}" target="#m{k}"/></technique_common></bind_material></instance_geometry></node>'
        )
    return COLLADA.format(**{name: "".join(each) for name, each in given.items()})


def test_collada_becomes_a_geom_for_each_material(reader: Reader, tmp_path: Path) -> None:
    pytest.importorskip("collada")
    (tmp_path / "m.dae").write_text(collada("1 0 0 1", "0 0 1 1"))
    looks = shape("m.dae", "visual")
    unit = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + looks), *ARM[2:]), visuals="keep").unit()
    assert unit is not None
    assert sorted(str(geom.get("rgba")) for geom in unit.root.iter("geom")) == ["0 0 1 1", "1 0 0 1"]
    assert {geom.get("contype") for geom in unit.root.iter("geom")} == {"0"}
    heights = [
        max(float(line.split()[3]) for line in content.decode().splitlines() if line.startswith("v "))  # type: ignore[union-attr]
        for content in unit.contents.values()
    ]
    assert heights == pytest.approx([0.2, 0.2])  # the file is in centimetres


def test_the_color_of_the_urdf_comes_first(reader: Reader, tmp_path: Path) -> None:
    pytest.importorskip("collada")
    (tmp_path / "m.dae").write_text(collada("1 0 0 1"))
    looks = shape("m.dae", "visual", '<material name="g"><color rgba="0 1 0 1"/></material>')
    unit = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + looks), *ARM[2:]), visuals="keep").unit()
    assert unit is not None
    assert [geom.get("rgba") for geom in unit.root.iter("geom")] == ["0 1 0 1"]


def gltf(node: dict[str, object]) -> tuple[dict[str, object], bytes]:
    """A wedge of 0.2, 0.3 and 0.1 m along its X, Y and Z, as glTF and its bytes."""
    places = b"".join(struct.pack("<3f", 0.2 * x, 0.3 * y, 0.1 * z) for x, y, z in CORNERS)
    data = places + struct.pack("<12H", *(corner for face in FACES for corner in face))
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [0.2, 0.3, 0.1]},
        {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
    ]
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}]
    meshes = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]
    scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **node}]}
    return {**scene, "meshes": meshes, "accessors": accessors, "bufferViews": views}, data


@pytest.mark.parametrize("suffix", ["gltf", "glb"])
@pytest.mark.parametrize(
    ("node", "tips"),
    [
        # What Drake 1.51.1 makes of the same: up in the file is +Z, and its +Z is -Y.
        ({}, [(0.2, 0, 0), (0, 0, 0.3), (0, -0.1, 0)]),
        # Its node turns it first, from +Y to +Z, and moves it along +Y.
        ({"rotation": [0.5**0.5, 0, 0, 0.5**0.5], "translation": [0, 1, 0]}, [(0.2, 0, 1), (0, -0.3, 1), (0, 0, 0.9)]),
    ],
    ids=["plain", "turned and moved by its node"],
)
def test_gltf_stands_upright(
    reader: Reader, tmp_path: Path, suffix: str, node: dict[str, object], tips: list[tuple[float, ...]]
) -> None:
    pytest.importorskip("trimesh")
    scene, data = gltf(node)
    if suffix == "gltf":
        text = base64.b64encode(data).decode()
        buffers = [{"byteLength": len(data), "uri": f"data:application/octet-stream;base64,{text}"}]
        (tmp_path / "m.gltf").write_text(json.dumps({**scene, "buffers": buffers}))
    else:
        head = json.dumps({**scene, "buffers": [{"byteLength": len(data)}]}).encode()
        head += b" " * (-len(head) % 4)
        chunks = struct.pack("<2I", len(head), 0x4E4F534A) + head + struct.pack("<2I", len(data), 0x004E4942) + data
        (tmp_path / "m.glb").write_bytes(struct.pack("<3I", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    mesh = shape(f"m.{suffix}")
    unit = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + mesh), *ARM[2:])).unit()
    assert unit is not None
    (content,) = unit.contents.values()
    assert isinstance(content, bytes)
    found = [tuple(map(float, line.split()[1:])) for line in content.decode().splitlines() if line.startswith("v ")]
    origin = tuple(map(float, node.get("translation", (0, 0, 0))))  # type: ignore[arg-type, call-overload]
    wanted = [(origin[0], -origin[2], origin[1]), *tips]
    assert sorted(found) == [pytest.approx(each, abs=1e-7) for each in sorted(wanted)]


def picture(path: Path, color: tuple[int, int, int] = (200, 10, 10)) -> None:
    from PIL import Image

    Image.new("RGB", (4, 4), color).save(path)


def test_obj_with_its_materials(reader: Reader, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    picture(tmp_path / "skin.png")
    (tmp_path / "m.mtl").write_text("newmtl skin\nKd 1 1 1\nmap_Kd skin.png\nnewmtl blue\nKd 0 0 1\n")
    corners = "\n".join(f"v {0.2 * x} {0.2 * y} {0.2 * z}" for x, y, z in CORNERS)
    more = "\n".join(f"v {0.2 * x + 1} {0.2 * y} {0.2 * z}" for x, y, z in CORNERS)
    first = "\n".join("f " + " ".join(f"{k + 1}/1" for k in face) for face in FACES)
    second = "\n".join("f " + " ".join(f"{k + 5}/1" for k in face) for face in FACES)
    (tmp_path / "m.obj").write_text(
        f"mtllib m.mtl\n{corners}\n{more}\nvt 0.5 0.5\nusemtl skin\n{first}\nusemtl blue\n{second}\n"
    )
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape("m.obj", "visual")), *ARM[2:]), visuals="keep")
    unit = read.unit()
    assert unit is not None, [each.message for each in read.sink.errors]
    geoms = list(unit.root.iter("geom"))
    textured = [geom for geom in geoms if geom.get("material")]
    assert len(geoms) == 2 and len(textured) == 1
    assert [geom.get("rgba") for geom in geoms if not geom.get("material")] == ["0 0 1 1"]
    (texture,) = unit.root.iterfind("asset/texture")
    assert unit.contents[str(texture.get("file"))].startswith(b"\x89PNG")  # type: ignore[union-attr]


def test_a_texture_of_urdf(reader: Reader, tmp_path: Path) -> None:
    picture(tmp_path / "skin.png")
    box = '<visual><geometry><box size="1 1 1"/></geometry><material name="skin"/></visual>'
    material = '<material name="skin"><texture filename="skin.png"/></material>'
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + box), *ARM[2:], material), visuals="keep")
    unit = read.unit()
    assert unit is not None
    assert [geom.get("material") for geom in unit.root.iter("geom")] == ["skin"]
    assert any(row.what == "material/texture" and row.became for row in read.rows)


@pytest.mark.parametrize(("content", "code"), [("<COLLADA", "mesh-unreadable"), (None, "asset-missing")])
def test_a_mesh_that_cannot_be_read(reader: Reader, tmp_path: Path, content: str | None, code: str) -> None:
    pytest.importorskip("collada")
    if content is not None:
        (tmp_path / "m.dae").write_text(content)
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape("m.dae")), *ARM[2:]))
    if code == "asset-missing":
        read.missing = lambda robot, converted: read.sink.error("asset-missing", str(converted.meshes))
    assert read.unit() is None
    assert [each.code for each in read.sink.errors] == [code]


def test_a_mesh_may_not_name_files_outside(reader: Reader, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "m.mtl").write_text("newmtl skin\nmap_Kd /etc/hostname\n")
    (tmp_path / "m.obj").write_text(f"mtllib m.mtl\nusemtl skin\nvt 0 0\n{obj()}")
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape("m.obj", "visual")), *ARM[2:]), visuals="keep")
    assert read.unit() is None
    assert [each.code for each in read.sink.errors] == ["source-outside"]


def painted(folder: Path, name: str = "m") -> str:
    """Write an OBJ of a closed wedge with a material on each of its faces."""
    colors = ("1 0 0", "0 1 0", "0 0 1", "1 1 0")
    materials = [f"newmtl c{number}\nKd {color}" for number, color in enumerate(colors)]
    (folder / f"{name}.mtl").write_text("\n".join(materials) + "\n")
    rows = [f"mtllib {name}.mtl", *(f"v {0.3 * x} {0.2 * y} {0.2 * z}" for x, y, z in CORNERS)]
    for number, face in enumerate(FACES):
        rows += [f"usemtl c{number}", "f " + " ".join(str(corner + 1) for corner in face)]
    (folder / f"{name}.obj").write_text("\n".join(rows) + "\n")
    return f"{name}.obj"


def painted_collada(folder: Path) -> str:
    """Write two wedges with a material each, that touch nothing of one another."""
    pytest.importorskip("collada")
    (folder / "m.dae").write_text(collada("1 0 0 1", "0 0 1 1"))
    return "m.dae"


def compiled(reader: UrdfReader) -> mujoco.MjModel:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    with folder_of(unit) as folder:
        file = str(folder / "model.xml")
        return mujoco.MjSpec.from_file(file, include={file: write(unit.root)}).compile()


@pytest.mark.parametrize("inertial", [INERTIAL, ""], ids=["weighed", "weighed by its shape"])
@pytest.mark.parametrize("make", [painted, painted_collada])
def test_colors_touch_no_physics(reader: Reader, tmp_path: Path, inertial: str, make: Callable[[Path], str]) -> None:
    """One `<collision>` is one geom of the same hull and mass, whether pictures are kept or not."""
    pytest.importorskip("trimesh")
    file = make(tmp_path)
    text = robot(ARM[0], link("upper", inertial + shape(file) + shape(file, "visual")), *ARM[2:])
    hulls = []
    for visuals in ("drop", "keep"):
        model = compiled(reader("r.urdf", text, visuals=visuals))
        (touching,) = (geom for geom in range(model.ngeom) if model.geom_contype[geom])
        shown = model.ngeom - 1
        assert shown == (0 if visuals == "drop" else 4 if file.endswith("obj") else 2)
        mesh = int(model.geom_dataid[touching])
        hulls.append((model.body("upper").mass[0], model.body("upper").inertia.tolist(), int(model.mesh_facenum[mesh])))
    dropped, kept = hulls
    assert kept == dropped


@pytest.mark.parametrize("folders", [("collision", "visual"), ("b", "a")])
def test_files_of_one_name_are_two_meshes(reader: Reader, tmp_path: Path, folders: tuple[str, str]) -> None:
    """MuJoCo 3.12 and 3.13 read the first file for both."""
    for folder, scale in zip(folders, (0.1, 0.3), strict=True):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "link.obj").write_text(obj(scale))
    shapes = "".join(shape(f"{folder}/link.obj") for folder in folders)
    setting = '<mujoco><compiler strippath="false"/></mujoco>'
    model = compiled(reader("r.urdf", robot(setting, ARM[0], link("upper", INERTIAL + shapes), *ARM[2:])))
    sizes = [
        float(np.ptp(model.mesh_vert[start : start + count], axis=0).max())
        for start, count in zip(model.mesh_vertadr, model.mesh_vertnum, strict=True)
    ]
    assert len(sizes) == 2 and max(sizes) / min(sizes) == pytest.approx(3, rel=1e-6)
    assert len(set(model.geom_dataid.tolist())) == 2


def test_a_file_with_parts_is_judged_as_a_whole(reader: Reader, tmp_path: Path) -> None:
    """A label of a tenth of a millimeter on a part that is large enough."""
    pytest.importorskip("trimesh")
    rows = ["mtllib m.mtl", *(f"v {0.2 * x} {0.2 * y} {0.2 * z}" for x, y, z in CORNERS)]
    rows += [f"v {1e-4 * x} {1e-4 * y} {1e-4 * z}" for x, y, z in CORNERS]
    for number in range(2):
        rows.append(f"usemtl c{number}")
        rows += ["f " + " ".join(str(corner + 1 + 4 * number) for corner in face) for face in FACES]
    (tmp_path / "m.mtl").write_text("newmtl c0\nKd 1 0 0\nnewmtl c1\nKd 0 0 1\n")
    (tmp_path / "m.obj").write_text("\n".join(rows) + "\n")
    text = robot(ARM[0], link("upper", INERTIAL + shape("m.obj", "visual")), *ARM[2:])
    assert told(reader("r.urdf", text, visuals="keep")) == []
