"""What is offered while a recipe is being written."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsp.client import MARK, Editor, labels
from lsp.conftest import RECIPES, needs_robots

DEMO = (RECIPES / "demo.yaml").read_text(encoding="utf-8")
STUDY = (RECIPES / "payload_study.yaml").read_text(encoding="utf-8")


def offered(editor: Editor, marked: str, name: str = "demo.yaml", previous: str = DEMO) -> list[dict[str, object]]:
    """What is offered at the mark, in a recipe that was whole a moment ago."""
    return editor.complete(marked, name, previous=previous)


def test_sites_of_the_parts_by_final_name_with_where_they_are(editor: Editor) -> None:
    found = offered(editor, DEMO.replace("site: arm/attachment_site\n", f"site: {MARK}\n"))
    assert labels(found) == ["table/mount", "table/corner", "arm/attachment_site", "watcher/optical_frame"]
    assert found[2]["detail"] == "site of arm, in arm/flange, pos 0 0 0.025"
    assert not any(str(each["label"]).startswith("gripper/") for each in found), "a part is not attached to itself"


@pytest.mark.parametrize(
    ("marked", "first", "absent"),
    [
        (f"sensor:\n  s: {{type: jointpos, joint: {MARK}}}", "arm/shoulder_pan", "table/mount"),
        (f"sensor:\n  s: {{type: framepos, objtype: camera, objname: {MARK}", "overview", "arm/base"),
        (f"sensor:\n  s:\n    type: actuatorfrc\n    actuator: {MARK}", "arm/shoulder_pan", "arm/base"),
        (f"actuator:\n  a: {{type: motor, joint: {MARK}", "arm/shoulder_pan", "arm/base"),
        (f"contact:\n  exclude:\n    - {{body1: {MARK}", "table/table", "table/mount"),
        (f"equality:\n  e: {{type: weld, body1: {MARK}", "table/table", "table/mount"),
        (f"asset:\n  material:\n    m: {{texture: {MARK}", "checker", "arm/base"),
        (f"tendon:\n  t:\n    type: spatial\n    path:\n      - site: {MARK}", "table/mount", "arm/base"),
        (f"add:\n  - to: {MARK}", "table/table", "table/mount"),
        (f"keyframe:\n  k:\n    qpos:\n      {MARK}", "arm/shoulder_pan", "arm/base"),
        (f"keyframe:\n  k:\n    ctrl: {{{MARK}", "arm/shoulder_pan", "arm/base"),
        (f"keyframe:\n  k:\n    from: {{{MARK}", "base", "arm/base"),
        (f"interface:\n  actuator: [{MARK}", "arm/shoulder_pan", "arm/gripper/pinion"),
        (f"interface:\n  joint:\n    - {MARK}", "arm/shoulder_pan", "arm/gripper/grip"),
        (f"interface:\n  key: [{MARK}", "home", "arm/shoulder_pan"),
        (f"keyframe:\n  k:\n    from: {{arm: {MARK}", "home", "base"),
        (f"check:\n  c: {{reachable: {{site: {MARK}", "table/mount", "arm/base"),
        (f"edit:\n  - {{select: {{part: {MARK}", "base", "arm/base"),
        (f"edit:\n  - {{select: {{actuator: a}}, datasheet: {{model: {MARK}", "dynamixel-xm430-w350", "arm/base"),
        (f"add:\n  - to: world\n    body:\n      geom: {{material: {MARK}", "floor", "arm/base"),
    ],
)
def test_names_of_the_kind_that_fits(editor: Editor, marked: str, first: str, absent: str) -> None:
    base = DEMO.partition("option:")[0]
    found = labels(offered(editor, base + marked + "\n", previous=base))
    assert found[:1] == [first], found[:20]
    assert absent not in found


def test_a_part_is_mated_and_edited_in_its_own_words(editor: Editor) -> None:
    found = labels(offered(editor, DEMO.replace("    site: table/corner", f"    site: table/corner\n    mate: {MARK}")))
    assert found[:2] == ["optical_frame", "base"]
    text = DEMO.replace("    site: table/corner", f"    site: table/corner\n    edit:\n      - select: {{body: {MARK}")
    assert {"head", "tilt"} <= set(labels(offered(editor, text)))


def test_a_recipe_that_is_written_in_place_has_its_own_words(editor: Editor) -> None:
    outer = "recipe: 1\nattach:\n  a:\n    model:\n      base: ./models/arm6/arm6.xml\n"
    marked = f"{outer}      sensor:\n        s: {{type: force, site: {MARK}}}\n"
    assert labels(offered(editor, marked, "in_place.yaml", outer)) == ["attachment_site"]


def test_selectors_say_how_many_they_match(editor: Editor) -> None:
    found = {
        each["label"]: each["detail"] for each in offered(editor, f'{DEMO}edit:\n  - {{select: {{body: "{MARK}"}}}}\n')
    }
    assert found["arm/*"] == "7 elements"
    assert found["cube/*"] == "1 element"
    assert str(found["**"]).startswith("all, unnamed ones too")
    assert "arm/wrist" in found


def test_a_glob_gets_the_quotes_that_it_needs(editor: Editor) -> None:
    for before, after, expected in (("", "", '"**"'), ('"', '"', "**"), ("'", "", "**")):
        found = offered(editor, f"{DEMO}edit:\n  - {{select: {{body: {before}{MARK}{after}}}}}\n")
        texts = {each["label"]: each["textEdit"]["newText"] for each in found}  # type: ignore[index]
        assert texts["**"] == expected
        assert texts["arm/wrist"] == "arm/wrist"


def test_keys_with_documentation_those_that_are_needed_first(editor: Editor) -> None:
    found = offered(editor, DEMO.replace("option:", f"  new:\n    {MARK}\noption:"))
    assert found[0]["label"] == "model"
    assert found[0]["detail"] == "required"
    assert "A model reference" in found[0]["documentation"]["value"]  # type: ignore[index]
    assert found[0]["textEdit"]["newText"] == "model: "  # type: ignore[index]
    assert "site" in labels(found)


def test_keys_that_are_there_are_not_offered_again(editor: Editor) -> None:
    found = labels(offered(editor, DEMO.replace("    site: table/mount", f"    site: table/mount\n    {MARK}")))
    assert "site" not in found
    assert "model" not in found
    assert "pos" in found


def test_attributes_and_keywords_of_mjcf(editor: Editor) -> None:
    found = labels(offered(editor, f"{DEMO}  s: {{type: force, {MARK}\n"))
    assert found[0] == "site"
    assert labels(offered(editor, DEMO.replace("cone: elliptic", f"cone: {MARK}"))) == ["pyramidal", "elliptic"]
    assert "framepos" in labels(offered(editor, DEMO.replace("type: framepos", f"type: {MARK}")))


def test_model_references(editor: Editor) -> None:
    found = labels(offered(editor, DEMO.replace("base: ./models/scenes/floor.xml", f"base: {MARK}")))
    assert "./models/arm6/arm6.xml" in found
    assert "./two_arms.yaml" in found
    assert "./demo.yaml" not in found
    assert {"menagerie:", "package:"} <= set(found)
    found = labels(offered(editor, DEMO.replace("base: ./models/scenes/floor.xml", f"base: menagerie:univ{MARK}")))
    assert "menagerie:universal_robots_ur5e" in found
    found = labels(
        offered(
            editor, DEMO.replace("base: ./models/scenes/floor.xml", f"base: menagerie:universal_robots_ur5e/{MARK}")
        )
    )
    assert found[0] == "menagerie:universal_robots_ur5e/ur5e"


def test_inside_an_expression(editor: Editor) -> None:
    marked = STUDY.replace('"${reach}", 0, 0.025', f'"${{re{MARK}", 0, 0.025')
    found = offered(editor, marked, "payload_study.yaml", STUDY)
    named = {each["label"]: each for each in found}
    assert named["reach"]["detail"] == "parameter, default 0.55 m"
    assert {"tool", "clamp", "pi"} <= set(named)
    begin = named["reach"]["textEdit"]["range"]["start"]  # type: ignore[index]
    line = marked.replace(MARK, "").splitlines()[begin["line"]]
    assert line[: begin["character"]].endswith("${"), "only the name is replaced"


def test_parameters_of_a_nested_recipe(editor: Editor, folder: Path) -> None:
    outer = "recipe: 1\nattach:\n  a:\n    model: ./payload_study.yaml\n    with: {"
    found = offered(editor, f"{outer}{MARK}}}\n", "outer.yaml", f"{outer}}}\n")
    assert labels(found)[:5] == ["payload", "reach", "tilt", "tool", "light"]
    assert labels(offered(editor, f"{outer}tool: {MARK}}}\n", "outer.yaml"))[:2] == ["gripper", "flange"]


def test_variants_in_when_and_in_the_matrix(editor: Editor) -> None:
    found = labels(
        offered(editor, STUDY.replace("when: {tool: gripper}", f"when: {{{MARK}}}", 1), "payload_study.yaml", STUDY)
    )
    assert found[:5] == ["payload", "reach", "tilt", "tool", "light"]
    found = labels(
        offered(
            editor, STUDY.replace("when: {tool: gripper}", f"when: {{tool: {MARK}}}", 1), "payload_study.yaml", STUDY
        )
    )
    assert found[:2] == ["gripper", "flange"]


def test_names_of_a_part_whose_recipe_never_was_whole(editor: Editor) -> None:
    """What is opened with a fault has no composed model: the parts say their own names."""
    text = DEMO.replace("site: table/mount", "site: nowhere").replace("site: table/corner", f"site: {MARK}")
    found = labels(editor.complete(text, "never.yaml"))
    assert "arm/attachment_site" in found


def test_what_the_recipe_makes_itself_is_known_while_it_has_a_fault(editor: Editor) -> None:
    broken = DEMO.replace("site: table/mount", "site: nowhere")
    place, _ = editor.at(
        f"{broken}  s: {{type: framepos, objtype: camera, objname: {MARK}}}\n", "faulty.yaml", previous=DEMO
    )
    assert editor.diagnostics(editor.uri("faulty.yaml"))
    assert "wrist_camera" in labels(editor.ask("textDocument/completion", place)["items"])


def test_nothing_in_comments_and_blocks_of_text(editor: Editor) -> None:
    assert offered(editor, f"{DEMO}# {MARK}\n") == []
    assert offered(editor, f"{DEMO}add:\n  - to: world\n    xml: |\n      <geom {MARK}\n") == []


def test_a_new_file_begins_with_its_version(editor: Editor) -> None:
    assert labels(editor.complete(MARK, "new.recipe.yaml"))[0] == "recipe"


@needs_robots
def test_inside_robots_of_menagerie(editor: Editor) -> None:
    name = "menagerie_ur5e_2f85.yaml"
    text = (editor.folder / name).read_text()
    found = offered(editor, text.replace("actuator: gripper/fingers_actuator", f"actuator: {MARK}"), name, text)
    assert "gripper/fingers_actuator" in labels(found)
    assert "shoulder_pan" in labels(found)


def test_a_terrain_has_the_keys_of_its_kind(editor: Editor) -> None:
    def here(marked: str) -> list[str]:
        return labels(editor.complete(f"recipe: 1\nasset:\n  hfield:\n    ground: {{{marked}}}\n", "land.yaml"))

    assert {"terrain", "file"} <= set(here(MARK))
    assert {"rough", "stairs", "boxes"} <= set(here(f"terrain: {{kind: {MARK}}}"))
    keys = here(f"terrain: {{kind: stairs, {MARK}}}")
    assert {"rise", "tread", "difficulty"} <= set(keys)
    assert "kind" not in keys
    assert "rough" in here(f"terrain: {{columns: [{MARK}]}}")
