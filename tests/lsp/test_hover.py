"""What is shown of what stands under the cursor."""

from __future__ import annotations

import pytest
from lsp.client import MARK, Editor, stretch
from lsp.conftest import RECIPES, needs_robots

DEMO = (RECIPES / "demo.yaml").read_text(encoding="utf-8")
STUDY = (RECIPES / "payload_study.yaml").read_text(encoding="utf-8")


def shown(editor: Editor, marked: str, name: str = "demo.yaml") -> str:
    params, _ = editor.at(marked, name)
    found = editor.ask("textDocument/hover", params)
    return "" if found is None else found["contents"]["value"]


def mark(text: str, where: str) -> str:
    """The text with the mark in its first `where`: where that has it, or in the middle."""
    inside = where.index(MARK) if MARK in where else len(where) // 2
    at = text.index(where.replace(MARK, "")) + inside
    return text[:at] + MARK + text[at:]


def test_an_element_with_its_pose_its_part_and_where_it_came_from(editor: Editor) -> None:
    text = shown(editor, mark(DEMO, "site: arm/attachment_site"))
    assert "**site `arm/attachment_site`**" in text
    assert "- part `arm`" in text
    assert "in its body: [0, 0, 0.025] m" in text
    assert "in the world: [-0.32, 0, 1.809] m" in text
    assert "read from models/arm6/arm6.xml:90" in text
    assert "default classes, the nearest first" in text


def test_the_range_of_a_joint_in_its_unit_and_in_degrees(editor: Editor) -> None:
    text = shown(editor, mark(DEMO + "keyframe:\n  k: {qpos: {arm/elbow: 1rad}}\n", "arm/elbow"))
    assert "hinge joint, range [-2.6, 2.6] rad = [-149, 149]°" in text
    text = shown(editor, mark(DEMO + "keyframe:\n  k: {qpos: {gripper/left_finger: 0.01}}\n", "gripper/left_finger"))
    assert "slide joint, range [" in text
    assert "] m" in text


def test_the_mass_of_a_body(editor: Editor) -> None:
    assert "mass: 0.05 kg" in shown(editor, mark(DEMO, "objname: cube/cube"))


def test_a_place_in_the_parts_own_words(editor: Editor) -> None:
    text = DEMO.replace("    site: table/corner", "    site: table/corner\n    mate: optical_frame")
    assert "**site `watcher/optical_frame`**" in shown(editor, mark(text, "mate: optical_frame"))


def test_the_value_of_an_expression_in_each_cell(editor: Editor) -> None:
    text = shown(editor, mark(STUDY, '"${max(payload, 0.001)}"'), "payload_study.yaml")
    assert "| tool gripper, payload 0.5 | **0.5** |" in text
    assert "| tool flange, payload 0 | **0.001** |" in text
    assert "`payload`: parameter, default 0.5 kg; the mass of the cube at the tool" in text
    text = shown(editor, mark(STUDY, '"${reach}", 0, 0.025'), "payload_study.yaml")
    assert "**" in text


def test_what_a_model_reference_leads_to(editor: Editor) -> None:
    text = shown(editor, mark(DEMO, "./models/arm6/arm6.xml"))
    assert "7 bodies, 6 joints, 6 actuators, 1 key" in text
    assert "- site `attachment_site` at [" in text
    assert "license: " in text
    assert " MB" in text


def test_who_wants_a_setting_and_what_is_in_effect(editor: Editor) -> None:
    text = shown(editor, mark(DEMO, "cone: elliptic"))
    assert "| `gripper` | `elliptic` (models/gripper2/gripper2.xml:" in text
    assert "| **the model** | **`elliptic`** |" in text


def test_what_a_selector_matches(editor: Editor) -> None:
    text = shown(editor, mark(DEMO + 'edit:\n  - {select: {body: "arm/*"}, set: {gravcomp: 1}}\n', "arm/*"))
    assert "**matches 7 elements**" in text
    assert "- `arm/flange`" in text


@pytest.mark.parametrize(
    ("where", "words"),
    [("attach:", "The parts"), ("description:", "Free text"), ("type: framepos", "position of an object")],
)
def test_keys_and_words_of_the_language(editor: Editor, where: str, words: str) -> None:
    assert words in shown(editor, mark(DEMO, where))


def test_the_stretch_that_it_is_about(editor: Editor) -> None:
    params, text = editor.at(mark(DEMO, "site: arm/attachment_site"), "demo.yaml")
    assert stretch(editor.ask("textDocument/hover", params)["range"], text) == "arm/attachment_site"


def test_nothing_about_comments(editor: Editor) -> None:
    assert shown(editor, mark(DEMO, "# the version of the recipe language")) == ""


@needs_robots
def test_a_robot_of_menagerie(editor: Editor) -> None:
    name = "menagerie_ur5e_2f85.yaml"
    text = shown(editor, mark((RECIPES / name).read_text(), "menagerie:robotiq_2f85/2f85"), name)
    assert "license: " in text
    assert "`pinch`" in text


def test_a_name_fetches_no_picture(editor: Editor) -> None:
    """Editors show the pictures of Markdown, and a name that a model has can end a code span."""
    name = "`![x](https://example.org/x.png)"
    (editor.folder / "picture.xml").write_text(f'<mujoco><worldbody><body name="{name}"/></worldbody></mujoco>')
    text = f'recipe: 1\nbase: ./picture.xml\nadd: [{{to: "{MARK}{name}", site: {{name: a}}}}]\n'
    seen = shown(editor, text, "picture.yaml")
    assert "[x](https://example.org/x.png)" in seen and "![" not in seen
