"""The names of a model as data and code: what they say is MuJoCo's, they need nothing, and they are the same each time."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import mujoco
import pytest
from mjcompose.base.sink import Sink
from mjcompose.mujoco.addresses import span
from mjcompose.sides.names import NamesRecord
from mjcompose.sources.context import Context
from mjcompose.tools.names import names, to_cpp, to_json, to_python

MODEL = """
<mujoco model="2 odd-names">
  <worldbody>
    <body name="base" pos="0 0 1"><freejoint/><geom size=".1"/>
      <body name="a"><joint name="arm/el bow" range="-90 90"/><joint name="arm_el_bow" type="slide" axis="1 0 0"/><geom size=".1"/>
        <body name="b"><joint name="class" type="ball"/><geom size=".1"/><site name="tip"/></body></body></body>
    <body name="goal" mocap="true"/>
  </worldbody>
  <actuator>
    <position name="d\u00e9" joint="arm/el bow" kp="4" ctrlrange="-1 1"/>
    <motor joint="arm_el_bow" forcerange="-2 2"/>
    <intvelocity name="int" joint="arm_el_bow" kp="4" actrange="0 1"/>
  </actuator>
  <sensor><gyro name="g" site="tip" cutoff="5"/><jointpos name="&quot;?\\" joint="arm/el bow"/></sensor>
  <keyframe><key name="home" time="1" ctrl="0.5 1 2" act="3" mpos="1 2 3"/><key/></keyframe>
</mujoco>
"""


@pytest.fixture
def read(tmp_path: Path) -> NamesRecord:
    (tmp_path / "model.xml").write_text(MODEL, encoding="utf-8")
    found = names("model.xml", Context(environment={}, folder=tmp_path))
    assert found is not None
    return found


def test_addresses_are_those_of_mujoco(read: NamesRecord) -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = json.loads(to_json(read))
    assert data["sizes"] == {name: getattr(model, name) for name in data["sizes"]}
    assert [each["name"] for each in data["joints"]] == [model.joint(at).name for at in range(model.njnt)]
    for at, each in enumerate(data["joints"]):
        assert [*range(each["qpos_address"], each["qpos_address"] + each["qpos_size"])] == [*span(model, "qpos", at)]
    assert data["joints"][1]["range"] == model.jnt_range[1].tolist()
    assert [each["unit"] for each in data["joints"]] == [None, "rad", "m", "quaternion"]
    assert [each["unit"] for each in data["actuators"]] == ["rad", "N", "m/s"]
    assert data["actuators"][2]["act_address"] == model.actuator_actadr[2]
    assert [each["address"] for each in data["sensors"]] == model.sensor_adr.tolist()
    assert data["keyframes"][0]["ctrl"] == [0.5, 1, 2] and data["keyframes"][0]["mpos"] == [1, 2, 3]


def test_the_module_of_python_runs_alone_and_has_the_same(read: NamesRecord, tmp_path: Path) -> None:
    text = to_python(read)
    assert [line for line in text.splitlines() if "import" in line] == ["from enum import IntEnum"]
    (tmp_path / "made.py").write_text(text, encoding="utf-8")
    program = (
        "import json, made; print(json.dumps([made.NQ, made.Qpos.ARM_EL_BOW, made.Qpos.ARM_EL_BOW_2, made.Ctrl.D, made.Key.HOME,"
        " made.JOINTS['arm/el bow'], made.SENSORS['g'], made.KEYFRAMES['home']['ctrl'], made.SHA256]))"
    )
    run = subprocess.run(
        [sys.executable, "-I", "-c", f"import sys; sys.path[:0] = [{str(tmp_path)!r}]; {program}"],
        capture_output=True,
        check=True,
        text=True,
    )
    nq, first, second, ctrl, key, joint, sensor, row, sha256 = json.loads(run.stdout)
    data: dict[str, Any] = json.loads(to_json(read))
    assert (nq, first, second, ctrl, key, row) == (data["sizes"]["nq"], 7, 8, 0, 0, [0.5, 1, 2])
    assert {"name": "arm/el bow", **joint} == data["joints"][1]
    assert {"name": "g", **sensor} == data["sensors"][0]
    assert sha256 == data["sha256"] and f"# sha256 of the MJCF text: {sha256}" in text
    assert "# 1 joint without a name" in text and "# 1 actuator without a name" in text


@pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler")
def test_the_header_compiles_without_a_warning(read: NamesRecord, tmp_path: Path) -> None:
    (tmp_path / "made.hpp").write_text(to_cpp(read), encoding="utf-8")
    (tmp_path / "main.cpp").write_text(
        '#include "made.hpp"\nnamespace m = n2_odd_names;\n'
        "static_assert(m::qpos::arm_el_bow == 7 && m::qpos::arm_el_bow_2 == 8 && m::qpos::class_ == 9);\n"
        "static_assert(m::ctrl::d == 0 && m::act::int_ == 0 && m::sensor::g == 0 && m::key::home == 0);\n"
        "static_assert(m::keyframes[0].ctrl[1] == 1.0 && m::ctrl_ranges[0].high == 1.0 && !m::ctrl_ranges[1].limited);\n"
        "static_assert(m::actuators[1].force_range.low == -2.0 && m::joints.size() == 4 && m::sensors[0].cutoff == 5.0);\n"
        "int main() { return m::sensors[1].name[1] == '?' ? 0 : 1; }\n"
    )
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(["c++", *flags, "main.cpp", "-o", "main"], cwd=tmp_path, check=True, capture_output=True)
    assert subprocess.run([str(tmp_path / "main")], check=False).returncode == 0


def test_an_empty_model_has_code_too(tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text("<mujoco/>")
    found = names("model.xml", Context(environment={}, folder=tmp_path))
    assert found is not None
    compile(to_python(found), "made.py", "exec")
    if shutil.which("c++"):
        (tmp_path / "made.cpp").write_text(to_cpp(found).replace("#pragma once", "") + "int main() {}\n")
        subprocess.run(["c++", "-std=c++17", "-Wall", "-Werror", "-c", "made.cpp"], cwd=tmp_path, check=True)


def test_a_recipe_and_its_bundle_have_the_same_bytes(tmp_path: Path) -> None:
    from mjcompose.bundle.staging import write_folder
    from mjcompose.pipeline.stages import ModelRequest, build

    (tmp_path / "model.xml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "recipe.yaml").write_text("recipe: 1\nbase: ./model.xml\n")
    context = Context(environment={}, folder=tmp_path)
    built = build(ModelRequest(tmp_path / "recipe.yaml"), context)
    assert built is not None
    write_folder(built.bundle, tmp_path / "bundle")
    found = [names(each, Context(environment={}, folder=tmp_path)) for each in ("recipe.yaml", "recipe.yaml", "bundle")]
    texts = {to_python(each) for each in found if each is not None}
    assert None not in found and len(texts) == 1 and built.bundle.digest("model.xml") in texts.pop()


def test_what_is_no_model_is_reported(tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text("<mujoco><worldbody><geom/></worldbody></mujoco>")
    context = Context(environment={}, folder=tmp_path, sink=Sink())
    assert names("model.xml", context) is None
    assert names("other.xml", context) is None
    assert {each.code for each in context.sink.errors} == {"mujoco-rejects", "file-not-found"}
