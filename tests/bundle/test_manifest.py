from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import mjcompose
import pytest
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.manifest import (
    Draw,
    File,
    Input,
    Manifest,
    RecipeFile,
    files_of,
    from_json,
    index_of,
    manifest_of,
    schema,
    to_json,
    with_manifest,
)
from mjcompose.mujoco.index import (
    CompiledActuator,
    CompiledCamera,
    CompiledIndex,
    CompiledJoint,
    CompiledKeyframe,
    CompiledSensor,
)
from pydantic import ValidationError

BUNDLE = Bundle({"model.xml": b"<mujoco/>", "assets/a.obj": b"a"})
INDEX = CompiledIndex(
    joints=(
        CompiledJoint("turn", "hinge", 7, 1, 6, 1, True, (-1.5, 1.5), "link"),
        CompiledJoint("", "free", 0, 7, 0, 6, False, (0, 0), "base"),
    ),
    actuators=(CompiledActuator("a", 0, 1, -1, 0), CompiledActuator("b", 1, 2, 0, 1)),
    sensors=(CompiledSensor("s", "framepos", 0, 3),),
    keyframes=(CompiledKeyframe("home", 0),),
    cameras=(CompiledCamera("eye", "world", 45, "deg", (4, 3)),),
    bodies=("world", "base", "link"),
)


def manifest() -> Manifest:
    return Manifest(
        name="größe",
        description="two\nlines",
        mujoco="4.0.0",
        grammar="4.0",
        recipe=RecipeFile(path="arm.yaml", sha256="0" * 64),
        variants={"light": "dim"},
        params={"reach": 0.5, "label": "x", "offset": [0, 0, 1]},
        sample=3,
        draws=(Draw(field="friction", element="cube0/box", attribute="friction", operation="set", value=0.7),),
        inputs=(Input(path="arm.xml", reference="./arm.xml", kind="path", sha256="1" * 64),),
        files=files_of(BUNDLE),
        index=index_of(INDEX, {("joint", 0): ("joint", "arm.xml:12")}),
        warnings=("mujoco-warning: careful",),
        picture="arm.png",
    )


def test_it_comes_back_as_it_was() -> None:
    assert from_json(to_json(manifest())) == manifest()


def test_its_text_is_the_same_each_time_and_readable() -> None:
    text = to_json(manifest())
    assert text == to_json(manifest())
    assert text.endswith(b"}\n")
    assert "größe".encode() in text
    assert list(json.loads(text))[:3] == ["manifest", "name", "description"]


def test_it_lists_the_files_but_not_itself() -> None:
    whole = with_manifest(BUNDLE, manifest())
    assert files_of(whole) == files_of(BUNDLE)
    digest = "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb"
    assert files_of(BUNDLE)[0] == File(path="assets/a.obj", sha256=digest, size=1)
    assert from_json(whole.files["manifest.json"]).files == files_of(BUNDLE)


def test_the_index_says_where_things_are() -> None:
    index = index_of(INDEX, {("joint", 0): ("joint", "arm.xml:12")})
    turn, free = index.joints
    assert (turn.qpos, turn.qpos_size, turn.dof, turn.dof_size) == (7, 1, 6, 1)
    assert turn.range == (-1.5, 1.5)
    assert turn.origin == "arm.xml:12"
    assert free.range is None
    assert free.origin is None
    assert [(each.ctrl, each.ctrl_size, each.act, each.act_size) for each in index.actuators] == [
        (0, 1, None, 0),
        (1, 2, 0, 1),
    ]
    assert (index.sensors[0].address, index.sensors[0].size) == (0, 3)
    assert [each.name for each in index.keyframes] == ["home"]
    assert (turn.unit, turn.velocity_unit, free.unit) == ("rad", "rad/s", None)


@pytest.mark.parametrize(
    "change", [{"surprise": 1}, {"manifest": 2}, {"files": [{"path": "x"}]}, {"sample": -1}, {"index": {}}]
)
def test_other_data_is_refused(change: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        from_json(json.dumps({**json.loads(to_json(manifest())), **change}))


def test_the_schema_in_the_repository_is_current() -> None:
    written = Path(__file__).parents[2] / "schemas" / "manifest.schema.json"
    assert written.read_text(encoding="utf-8") == schema(), "run `make schemas`"


def test_the_schema_names_the_dialect_and_every_key() -> None:
    data = json.loads(schema())
    assert data["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    written = set(json.loads(to_json(manifest())))
    assert set(data["properties"]) == {*written, "deduplicated", "extensions", "made", "picture", "target", "union"}
    assert not {"deduplicated", "extensions", "made", "picture", "target"} & set(data["required"])
    assert json.loads(to_json(manifest().model_copy(update={"picture": "arm.png"})))["picture"] == "arm.png"
    assert data["additionalProperties"] is False


def test_the_rest_of_the_room_does_without_pydantic() -> None:
    code = "import sys, mjcompose.bundle, mjcompose.verify.compile; print('pydantic' in sys.modules)"
    environment = {"PYTHONPATH": str(Path(mjcompose.__file__).parents[1])}
    command = [sys.executable, "-c", code]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert shown.stdout.strip() == "False"


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"name": "a\n::error::b"}, "`name`: a name cannot have a line break in it"),
        ({"name": ""}, "`name`: string should have at least 1 character"),
        ({"cell": "a\u202eb"}, "`cell`: a name cannot have the character U+202E in it"),
        ({"model": "../model.xml"}, "`model`: `../model.xml` is not a path in a bundle: it leads out of the bundle"),
        ({"model": "/model.xml"}, "`model`: `/model.xml` is not a path in a bundle: it is absolute"),
        ({"picture": "../../x.png"}, "`picture`: it must be the name of a file, without a folder"),
        ({"recipe": {"path": "../arm.yaml", "sha256": "0" * 64}}, "`recipe/path`: it must be the name of a file"),
        ({"recipe": {"path": "arm.yaml", "sha256": "0"}}, "`recipe/sha256`: string should match pattern"),
        ({"files": [{"path": "assets/../../x", "sha256": "0" * 64, "size": 1}]}, "it leads out of the bundle"),
        ({"files": [{"path": "../assets/../x", "sha256": "0" * 64, "size": 1}]}, "it leads out of the bundle"),
        ({"files": [{"path": "../../../assets/x", "sha256": "0" * 64, "size": 1}]}, "it leads out of the bundle"),
        ({"files": [{"path": "a\\b", "sha256": "0" * 64, "size": 1}]}, "it has a backslash"),
        ({"read": [{"path": "arm.xml", "sha256": "x"}]}, "`read/0/sha256`: string should match pattern"),
        (
            {"inputs": [{"path": "a", "reference": "a", "kind": "path", "sha256": "1" * 64, "licenses": ["../L"]}]},
            "leads",
        ),
    ],
)
def test_each_path_hash_and_name_has_a_form(change: dict[str, Any], fault: str) -> None:
    text = json.dumps({**json.loads(to_json(manifest())), **change}).encode()
    sink = Sink()
    assert manifest_of(text, "arm.zip", sink) is None
    [error] = sink.errors
    assert fault in "\n".join(note.message for note in error.notes)


@pytest.mark.parametrize("path", ["../assets/x-0123.obj", "../../assets/x-0123.obj", "assets/x.obj"])
def test_shared_assets_are_outside(path: str) -> None:
    text = json.dumps({**json.loads(to_json(manifest())), "files": [{"path": path, "sha256": "0" * 64, "size": 1}]})
    assert from_json(text).files[0].path == path
