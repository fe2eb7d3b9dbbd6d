"""Every folder here is a wrong recipe, or one with a wrong source, and what a build prints about it.

`UPDATE_EXPECTED=1 pytest tests/errors` writes the texts anew; read what changed.
"""

from __future__ import annotations

import os
import re
from importlib.metadata import version
from pathlib import Path

import pytest

from composer.context import Context
from composer.diagnostics import Severity
from composer.diagnostics.text import render, summary
from composer.stages import Request, build

HERE = Path(__file__).resolve().parent
CASES = sorted(path.parent.name for path in HERE.glob("*/expected.txt"))
# Cases that are about several faults, all of which are told.
SEVERAL = {
    "expression_in_model",
    "range_wrong_order",
    "range_without_limited",
    "range_wrong_order_in_part",
    "several_expressions",
    "everything_at_once",
    "character_not_xml",
    "half_recipe",
    "host_not_a_host",
    "source_not_mjcf",
    "edit_beside_others",
    "edit_unset",
    "extends_without_angle",
    "several_sources",
    "source_of_older_mujoco",
    "simplify_without_faces",
    "model_with_backslashes",
    "several_names",
    "several_stages",
    "check_failed",
    "budget_of_nothing",
    "motors_sheet",
    "parameters_of_verbs",
    "runs_on_lacks",
    "runs_on_misspelt",
    "check_names",
    "check_nested",
    "files_beside_others",
    "variant_pieces",
    "when_not",
    "keyframe_ctrl_unit",
    "keyframe_several",
    "keyframe_unnamed_actuators",
    "rename_of_unnamed",
    "collision_settings",
    "draw_faults",
    "draw_in_cells",
    "draw_parameters",
    "draw_refused",
    "draw_table",
    "trust_faults",
    "trust_in_variant",
    "world_frame",
}
# Not wrong: something is told, and the model is built.
BUILT = {
    "urdf_joints_of_one_name",
    "urdf_mimic_of_nothing",
    "added_without_mass",
    "allow_unused",
    "conflict_merge",
    "check_warns",
    "collision_millimetres",
    "not_held_plugin",
    "stiff_actuator",
    "world_frame",
    "conflict_warning",
    "copies_warning",
    "edit_convert_keys",
    "edit_convert_loss",
    "ignored_attribute",
    "ignored_below_frame",
    "ignored_body_outside",
    "memory_of_part",
    "keyframe_out_of_range",
    "hold_out_of_range",
    "memory_warning",
    "edit_scale_zero",
    "randomize_scale_zero",
    "subtree_cut",
    "urdf_mesh_in_millimetres",
    "urdf_roots",
}
MUJOCO = "4.0"


def told(context: Context) -> str:
    """What the command prints on standard error."""

    def read(file: str) -> str | None:
        try:
            return (context.folder / file).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return None

    found = context.sink.sorted()
    return "".join(f"{render(each, read)}\n\n" for each in found) + summary(found) + "\n"


# An older MuJoCo fuses the links of a URDF without a trace, and has elements that this one has not.
OF_THIS_MUJOCO = {
    "urdf_clash",
    "urdf_joints_of_one_name",
    "runs_on_lacks",  # MuJoCo 3 has no pid
    "urdf_fused_link",
    "element_of_older_mujoco",
    "attribute_of_older_mujoco",
    "keyword_of_older_mujoco",
    "copies_warning",
    "integrator_of_flex",
    "flex_not_pinned",
    "mesh_without_coordinates",  # MuJoCo 3.12 does not look whether a mesh has the coordinates that its faces name
}


# What an optional package finds.
NEEDS = {
    "urdf_mesh_broken": "collada",
    **{case: "xacro" for case in CASES if "xacro" in case and case != "xacro_of_mjcf"},
}


@pytest.mark.parametrize("case", CASES)
def test_error(case: str) -> None:
    if case in NEEDS:
        pytest.importorskip(NEEDS[case])
    if case in OF_THIS_MUJOCO and not version("mujoco").startswith(MUJOCO):
        pytest.skip("another MuJoCo builds this, or says something else of it")
    folder = HERE / case
    context = Context(environment={}, folder=folder)
    built = build(Request(folder / "recipe.yaml"), context)
    text = told(context).replace(f"{folder}{os.sep}", "FOLDER/").replace(f"{folder}", "FOLDER")
    file = folder / "expected.txt"
    if os.environ.get("UPDATE_EXPECTED"):
        file.write_text(text, encoding="utf-8")
    expected = file.read_text(encoding="utf-8")
    assert (built is not None) == (case in BUILT)
    if "MuJoCo rejects" in expected and not version("mujoco").startswith(MUJOCO):
        place = re.compile(r"^\S+ error\[\S+\]", re.MULTILINE)
        assert place.findall(text) == place.findall(expected)  # the words are those of MuJoCo
    else:
        assert text == expected
    errors = context.sink.errors
    if case not in SEVERAL | BUILT:
        assert len(errors) == 1, "one cause is one error"
    for each in context.sink.diagnostics:
        assert each.severity is not Severity.ERROR or each.span is not None or case in WITHOUT_A_PLACE
        assert not re.match(r"[A-Z](?!PU\b)(?!uJoCo)[a-z]", each.message), "lower case"
        assert not each.message.endswith(".")


# There is no file, or nothing in it, to point at.
WITHOUT_A_PLACE = {"recipe_missing", "recipe_near", "recipe_folder"}


def test_every_folder_is_a_case() -> None:
    folders = {path.name for path in HERE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(CASES)
    assert len(CASES) >= 45
    assert folders >= (SEVERAL | BUILT | WITHOUT_A_PLACE)
