"""What a page changes in recipes: these characters, and nothing else."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.rotation import Pose, normalize, quat_from_euler
from mjcompose.cli.reporting import words_of
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.view.builder import Workshop
from mjcompose.tools.view.page import ViewChoice
from mjcompose.tools.view.writing import Writer

ARM = """<mujoco><worldbody><body name="link" pos="0 0 0.1" euler="0 20 0"><joint name="hinge"/>
<geom size="0.1"/><site name="tip" pos="0 0 0.3" euler="0 0 30"/><site name="side" pos="0.2 0 0"/></body></worldbody>
<actuator><position name="servo" joint="hinge" kp="10"/></actuator></mujoco>"""
BALL = """<mujoco><worldbody><body name="ball" pos="0 0 0.05"><geom size="0.05"/><site name="grip" pos="0.01 0 0"/>
</body></worldbody></mujoco>"""
FREE = '<mujoco><worldbody><body name="cube"><freejoint name="free"/><geom size="0.05"/></body></worldbody></mujoco>'


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as opened:
        yield opened


class Page:
    """A page that shows a recipe of a folder."""

    def __init__(self, folder: Path, session: Session, recipe: str, **files: str) -> None:
        for name, text in {"arm.xml": ARM, "ball.xml": BALL, "free.xml": FREE, **files}.items():
            (folder / name).write_text(text)
        self.file = folder / "cell.yaml"
        self.file.write_text(recipe)
        self.workshop = Workshop("cell.yaml", ViewChoice(), session, lambda: Context(folder=folder), words_of)
        self.workshop.writes = True
        self.writer = Writer(self.workshop)
        self.load()

    def load(self) -> None:
        shown = self.workshop.build()
        assert shown.fault is None, shown.fault
        self.scene = json.loads(shown.text)

    @property
    def text(self) -> str:
        return self.file.read_text()

    def row(self, label: str) -> dict[str, Any]:
        return next(row for row in self.scene["move"]["targets"] if row["label"] == label)

    def ask(self, kind: str, label: str | None = None, **said: Any) -> dict[str, Any]:
        """What the server answers."""
        if label is not None:
            number, *place = self.row(label)["at"]
            said["at"] = [self.scene["move"]["files"][number], *place]
        return self.writer.answer({"kind": kind, "version": self.scene["move"]["version"], **said})

    def move(self, label: str, pose: Pose) -> dict[str, Any]:
        return self.ask("place", label, pos=list(pose.pos), quat=list(pose.quat))

    def is_at(self, label: str, pose: Pose, before: Pose) -> None:
        """The bodies of a part are where its place moved them, to what the numbers round."""
        row = self.row(label)
        x, y, z, *quat = row["frame"]
        frame = Pose((x, y, z), tuple(quat))  # type: ignore[arg-type]
        moved = frame @ pose @ before.inverse() @ frame.inverse()
        scene = self.scene
        number = row["moved"]["body"][0]
        expected = moved @ _body(scene, number)
        self.load()
        found = _body(self.scene, self.row(label)["moved"]["body"][0])
        assert math.dist(expected.pos, found.pos) < 3e-5
        assert abs(sum(a * b for a, b in zip(expected.quat, found.quat, strict=True))) > 1 - 1e-8


def _body(scene: Any, number: int) -> Pose:
    pos = scene["body"]["pos"][3 * number :][:3]
    quat = scene["body"]["quat"][4 * number :][:4]
    return Pose(tuple(pos), tuple(quat))


PLACE = Pose((0.125, -0.05, 0.3), quat_from_euler([0.3, -0.4, 1.1], "xyz"))


@pytest.mark.parametrize(
    ("top", "part"),
    [
        ("", "{model: ./ball.xml}"),
        ("", "{model: ./ball.xml, pos: [0.1, 0.2, 0.3]}"),
        ("angle: degree", "{model: ./ball.xml, site: arm/tip, euler: [10, 20, 30]}   # turned"),
        ("angle: radian", "{model: ./ball.xml, site: arm/tip, mate: grip, euler: [0.1, 0.2, 0.3]}"),
        ("angle: degree\neulerseq: ZXz", "{model: ./ball.xml, euler: [1rad, 20deg, 30]}"),
        (
            "angle: degree\neulerseq: xyx",
            "\n    model: ./ball.xml  # a ball\n    body: arm/link\n    euler:\n      - 1\n      - 2   # two\n      - 3",
        ),
        ("", "{model: ./ball.xml, quat: [1, 0, 0, 0]}"),
        ("", "{model: ./ball.xml, axisangle: [0, 0, 2, 30deg]}"),
        ("angle: radian", "{model: ./ball.xml, axisangle: [0, 1, 0, 0.5]}"),
        ("", "{model: ./ball.xml, xyaxes: [1, 0, 0,\n      0, 1, 0], pos: [0,\n      0, 1]}"),
        ("", "{model: ./ball.xml, site: arm/tip, sense: [force]}"),
        ("", "{model: ./ball.xml, joint: {axis: [0, 0, 1]}, pos: [1, 0, 0]}"),
        ("", "{model: ./ball.xml, frame: corner, pos: [1, 0, 0]}"),
        ("", "{model: ./ball.xml, replicate: [{count: 3, offset: [0.2, 0, 0]}], pos: [1, 0, 0]}"),
    ],
)
def test_only_the_numbers_of_the_form_that_is_there_change(
    tmp_path: Path, session: Session, top: str, part: str
) -> None:
    recipe = f"recipe: 1\n{top}\n# the arm\nattach:\n  arm: {{model: ./arm.xml}}\n  part: {part}\n  last: {{model: ./ball.xml, pos: [0, 0, 9]}}  # stays\nadd:\n  - to: arm/link\n    frame: {{name: corner, pos: [0, 0.1, 0], quat: [1, 1, 0, 0]}}\n"
    page = Page(tmp_path, session, recipe)
    looked = page.ask("look", "part")
    before = Pose(tuple(looked["pos"]), tuple(looked["quat"]))
    answer = page.move("part", PLACE)
    assert "refused" not in answer, answer
    _same_words(recipe, page.text)
    written = page.text
    page.is_at("part", PLACE, before)
    assert page.ask("undo")["redo"] and page.text == recipe
    assert page.ask("redo")["undo"] and page.text == written


def _same_words(before: str, after: str) -> None:
    """Comments, keys and other lines are as they were."""
    for line in before.splitlines():
        if "#" in line:
            assert line.partition("#")[2] in after
        if "part" not in line and not set(line) <= set("-0123456789., []}:eulrposxya#tw"):
            assert line in after.splitlines()


def test_a_gimbal_lock_and_a_form_that_cannot_say_it(tmp_path: Path, session: Session) -> None:
    recipe = "recipe: 1\nangle: degree\nattach:\n  a: {model: ./ball.xml, euler: [10, 0, 0]}\n  b: {model: ./ball.xml, zaxis: [0, 0, 1]}\n"
    page = Page(tmp_path, session, recipe)
    answer = page.move("a", Pose(quat=quat_from_euler([math.radians(10), math.pi / 2, 0], "xyz")))
    assert "euler: [10, 90, 0]" in page.text and "quat" not in answer["said"]
    tilted = page.move("b", Pose(quat=quat_from_euler([0.5, 0, 0], "xyz")))
    assert "zaxis: [0, -0.479426, 0.877583]" in page.text and "quat" not in tilted["said"]
    turned = page.move("b", Pose(quat=normalize((1, 0, 0, 1))))
    assert "b: {model: ./ball.xml, quat: [0.707107, 0, 0, 0.707107]}" in page.text
    assert "`zaxis` cannot express this rotation" in turned["said"]
    page.load()


def test_an_expression_is_refused_by_name_and_its_parameter_is_offered(tmp_path: Path, session: Session) -> None:
    page = Page(
        tmp_path, session, 'recipe: 1\nparams: {w: 0.3}\nattach:\n  a: {model: ./ball.xml, pos: ["${w}", 0, 0]}\n'
    )
    before = page.text
    for kind in ("look", "place"):
        answer = page.ask(kind, "a", pos=[0, 0, 0], quat=[1, 0, 0, 0])
        assert answer == {"refused": "`pos` is computed: `${w}`", "parameters": [["w", "0.3"]]}
    assert page.text == before
    assert "refused" not in page.ask("parameter", name="w", value=0.45)
    assert page.text == before.replace("{w: 0.3}", "{w: 0.45}")


def test_a_page_that_shows_an_older_text_changes_nothing(tmp_path: Path, session: Session) -> None:
    page = Page(tmp_path, session, "recipe: 1\nattach:\n  a: {model: ./ball.xml, pos: [0, 0, 0]}\n")
    other = page.text + "# mine\n"
    page.file.write_text(other)
    answer = page.move("a", PLACE)
    assert answer["stale"] and "has changed since" in answer["refused"] and page.text == other
    page.workshop.build()  # the page does not know it yet
    assert page.move("a", PLACE)["stale"] and page.text == other
    page.load()
    assert "refused" not in page.move("a", PLACE) and page.text.endswith("# mine\n")
    page.file.write_text(page.text + "# more\n")
    page.load()
    assert "undo it in your editor" in page.ask("undo")["refused"]


def test_added_elements_move_too(tmp_path: Path, session: Session) -> None:
    recipe = """recipe: 1
angle: degree
attach: {arm: {model: ./arm.xml}}
add:
  - to: arm/link
    site: {name: tcp, pos: [0, 0, 0.1]}   # the tool
  - to: world
    body: {name: shelf, geom: [{type: box, size: [0.1, 0.1, 0.1], euler: [0, 0, 10]}]}
  - to: world
    geom: {name: bar, type: capsule, size: [0.01], fromto: [0, 0, 0, 0, 0, 1]}
"""
    page = Page(tmp_path, session, recipe)
    assert page.row("tcp")["kind"] == "site" and page.row("tcp")["mount"] == 1
    page.move("tcp", Pose((0, 0.05, 0.1)))
    page.move("shelf", Pose((0, 1, 0)))
    page.move("geom", Pose((0, 0, 0.5), quat_from_euler([0, 0, math.radians(20)], "xyz")))
    assert "site: {name: tcp, pos: [0, 0.05, 0.1]}   # the tool" in page.text
    assert "euler: [0, 0, 20], pos: [0, 0, 0.5]}], pos: [0, 1, 0]}" in page.text
    assert "fromto" in page.ask("look", "bar")["refused"]
    page.load()


def test_a_nested_recipe_and_one_that_is_extended_are_written_where_they_say_it(
    tmp_path: Path, session: Session
) -> None:
    recipe = """recipe: 1
extends: ./below.yaml
attach:
  left: {model: ./nested.yaml, pos: [0, 1, 0], euler: [0, 0, 90deg]}
  right: {model: ./nested.yaml, pos: [0, -1, 0]}
  given: {pos: [3, 0, 0]}
"""
    files = {
        "nested.yaml": "recipe: 1\nattach:\n  arm: {model: ./arm.xml}\n  ball: {model: ./ball.xml, pos: [1, 0, 0]}  # b\n",
        "below.yaml": "recipe: 1\nattach:\n  low: {model: ./ball.xml, pos: [2, 0, 0]}\n  given: {model: ./ball.xml, pos: [0, 0, 0]}\n",
        "other.yaml": "recipe: 1\nbase: ./nested.yaml\n",
    }
    page = Page(tmp_path, session, recipe, **files)
    looked = page.ask("look", "ball")
    assert looked["where"] == "nested.yaml:4" and "2 parts of this model and 1 other recipe" in looked["also"]
    assert "also changes 2 parts of this model and 1 other recipe" in page.move("ball", PLACE)["said"]
    assert (
        "pos: [0.125, -0.05, 0.3], euler: [17.189deg, -22.918deg, 63.025deg]}  # b"
        in (tmp_path / "nested.yaml").read_text()
    )
    assert page.text == recipe
    page.move("low", Pose((2.5, 0, 0)))
    assert "low: {model: ./ball.xml, pos: [2.5, 0, 0]}" in (tmp_path / "below.yaml").read_text()
    page.move("given", Pose((3.5, 0, 0)))
    assert page.text == recipe.replace("[3, 0, 0]", "[3.5, 0, 0]")
    before = [page.row("ball")["frame"], page.row("left")["mount"]]
    page.load()
    assert [page.row("ball")["frame"], page.row("left")["mount"]] == before
    site = page.scene["site"]["name"].index("left/arm/tip")
    assert page.ask("place", "ball", site=site, pos=[0, 0, 0], quat=[1, 0, 0, 0])["said"].startswith(
        "ball: site: arm/tip"
    )
    page.load()


def test_a_part_is_dropped_on_a_site(tmp_path: Path, session: Session) -> None:
    recipe = "recipe: 1\nangle: degree\nattach:\n  arm: {model: ./arm.xml}\n  a:\n    model: ./ball.xml\n    body: arm/link   # here\n    pos: [1, 2, 3]   # m\n    euler: [180, -28, 90]\n  b: {model: ./ball.xml}\n"
    page = Page(tmp_path, session, recipe)
    site = page.scene["site"]["name"].index("arm/side")
    for label in ("a", "b"):
        assert "refused" not in page.ask("place", label, site=site)
    expected = recipe.replace("body: arm/link ", "site: arm/side ").replace("[1, 2, 3]", "[0, 0, 0]")
    expected = expected.replace("[180, -28, 90]", "[0, 0, 0]").replace("ball.xml}", "ball.xml, site: arm/side}")
    assert page.text == expected
    page.load()


def test_an_element_of_a_source_is_moved_by_an_edit_that_is_confirmed(tmp_path: Path, session: Session) -> None:
    page = Page(tmp_path, session, "recipe: 1\nattach: {arm: {model: ./arm.xml}}\n")
    before = page.text
    site = page.scene["site"]["name"].index("arm/side")
    asked = {"of": "site", "index": site, "pos": [0.25, 0, 0], "quat": [1, 0, 0, 0]}
    offer = page.ask("edit", **asked)
    assert (
        "select: {site: arm/side}, set: {pos: [0.25, 0, 0], quat: [1, 0, 0, 0]}" in offer["offer"]
        and page.text == before
    )
    page.ask("edit", **asked, confirmed=True)
    page.load()
    assert page.scene["site"]["pos"][3 * site] == 0.25
    page.ask("edit", **{**asked, "pos": [0.3, 0, 0]}, confirmed=True)
    assert page.text == before + "edit: [{select: {site: arm/side}, set: {pos: [0.3, 0, 0], quat: [1, 0, 0, 0]}}]\n"


def test_a_pose_is_saved_by_names(tmp_path: Path, session: Session) -> None:
    recipe = "recipe: 1\nattach:\n  arm: {model: ./arm.xml}\n  cube: {model: ./free.xml}\n"
    page = Page(tmp_path, session, recipe)
    pose = {"qpos": [[0, [math.radians(30)]], [1, [0.1, 0.2, 0.3, 1, 0, 0, 0]]], "mpos": [], "mquat": [], "hold": True}
    assert page.ask("keyframe", name="reach", **pose)["said"] == "keyframe reach"
    expected = "keyframe:\n  reach:\n    qpos:\n      arm/hinge: 30deg\n      cube/free: [0.1, 0.2, 0.3, 1, 0, 0, 0]\n    ctrl: hold\n"
    assert page.text == recipe + expected
    page.load()
    assert page.scene["key"]["ctrl"] == pytest.approx([math.radians(30)])
    assert "choose another name" in page.ask("keyframe", name="reach", **pose)["refused"]
    free = page.scene["joint"]["name"].index("cube/free")
    page.ask("free", key="reach", joint=free, qpos=[0.5, 0.2, 0.3, 1, 0, 0, 0])
    assert page.text == recipe + expected.replace("[0.1,", "[0.5,")
    assert "does not write the keyframe" in page.ask("free", key="home", joint=free, qpos=[0] * 7)["refused"]


def test_a_part_is_attached_at_a_site(tmp_path: Path, session: Session) -> None:
    page = Page(tmp_path, session, "recipe: 1\nattach:\n  arm:\n    model: ./arm.xml\n")
    site = page.scene["site"]["name"].index("arm/tip")
    assert "./ball.xml" in page.ask("models")["models"]
    for wrong in ({"prefix": "base"}, {"prefix": "a b"}, {"prefix": "a/b"}, {"prefix": "arm"}, {"prefix": "x\ny"}):
        assert "refused" in page.ask("attach", model="./ball.xml", site=site, **wrong)
    for model in ("/etc/passwd", "../x.xml", "https://example.org/x.xml", "./ball.xml}\nbase: /etc/passwd"):
        assert "is not a model of this folder" in page.ask("attach", model=model, site=site, prefix="tool")["refused"]
    page.ask("attach", model="./ball.xml", site=site, prefix="null")
    assert page.text.endswith('  "null": {model: ./ball.xml, site: arm/tip}\n')
    page.load()


def test_names_are_not_yaml(tmp_path: Path, session: Session) -> None:
    """A name of a model is written as this name, or not at all."""
    odd = [
        "a: b",
        "x}, base: /etc/passwd",
        "- 1",
        "#",
        "on",
        "1e3",
        "'",
        '"',
        "&a",
        "*a",
        "!t",
        "é",
        "a\\b",
        "~",
        "0x1F",
    ]
    sites = "".join(f'<site name="{_escaped(name)}"/>' for name in odd)
    page = Page(
        tmp_path,
        session,
        "recipe: 1\nbase: ./odd.xml\nattach: {a: {model: ./ball.xml}}\n",
        **{"odd.xml": f"<mujoco><worldbody>{sites}</worldbody></mujoco>"},
    )
    for name in odd:
        answer = page.ask("place", "a", site=page.scene["site"]["name"].index(name))
        assert "refused" not in answer, answer
        page.load()  # which fails if the recipe names another site
    for name in ("x: 1}\nbase: y", "x\ny", "", "${1}", "$${1}"):
        before = page.text
        assert "refused" in page.ask("keyframe", name=name, qpos=[], mpos=[], mquat=[])
        assert "refused" in page.ask("attach", prefix=name, model="./ball.xml", site=0)
        assert page.text == before


def _escaped(name: str) -> str:
    return name.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, "x", None, [1]])
def test_numbers_are_finite_and_of_a_size(tmp_path: Path, session: Session, wrong: Any) -> None:
    page = Page(tmp_path, session, "recipe: 1\nattach: {a: {model: ./ball.xml}}\n")
    before = page.text
    for said in (
        {"pos": [wrong, 0, 0], "quat": [1, 0, 0, 0]},
        {"pos": [0, 0, 0], "quat": [1, 0, 0, wrong]},
        {"pos": [0, 0, 0], "quat": [0, 0, 0, 0]},
    ):
        with pytest.raises((ValueError, TypeError)):
            page.ask("place", "a", **said)
    huge = page.ask("place", "a", pos=[1e300, 0, 0], quat=[1, 0, 0, 0])
    assert huge["refused"] == "a number here can be 10000 at most, so nothing is written"
    assert page.text == before


def test_only_recipes_of_the_project_are_written(tmp_path: Path, session: Session) -> None:
    outside = tmp_path / "outside"
    inside = tmp_path / "project"
    outside.mkdir()
    inside.mkdir()
    (inside / "pyproject.toml").touch()
    nested = "recipe: 1\nattach: {ball: {model: ./ball.xml, pos: [1, 0, 0]}}\n"
    for folder in (outside, inside):
        (folder / "ball.xml").write_text(BALL)
    (outside / "nested.yaml").write_text(nested)
    (inside / "linked.yaml").symlink_to(outside / "nested.yaml")
    page = Page(
        inside, session, "recipe: 1\nattach:\n  far: {model: ../outside/nested.yaml}\n  near: {model: ./linked.yaml}\n"
    )
    rows = page.scene["move"]["targets"]
    assert {row["label"] for row in rows} == {"far", "near", "ball"}
    for row in rows:
        if row["label"] == "ball":
            at = [page.scene["move"]["files"][row["at"][0]], *row["at"][1:]]
            answer = page.ask("place", at=at, pos=[0, 0, 0], quat=[1, 0, 0, 0])
            assert "not a recipe of your project" in answer["refused"]
    assert (outside / "nested.yaml").read_text() == nested
    for at in (["/etc/passwd", 1, 1], ["../outside/nested.yaml", 2, 10], ["cell.yaml", 99, 1]):
        assert "refused" in page.ask("place", at=at, pos=[0, 0, 0], quat=[1, 0, 0, 0])
    (inside / "cell.yaml").unlink()
    (inside / "cell.yaml").symlink_to(outside / "nested.yaml")
    assert "refused" in page.move("near", PLACE) and (outside / "nested.yaml").read_text() == nested


def test_an_alias_and_a_text_that_would_change_otherwise_are_refused(tmp_path: Path, session: Session) -> None:
    recipe = "recipe: 1\nattach:\n  a: {model: ./ball.xml, pos: &p [0, 0, 1]}\n  b: {model: ./ball.xml, pos: *p}\n"
    page = Page(tmp_path, session, recipe)
    assert "refused" in page.move("b", PLACE) and page.text == recipe


def test_an_editor_gets_what_to_replace_in_its_own_text(tmp_path: Path, session: Session) -> None:
    recipe = "recipe: 1\nattach:\n  a: {model: ./ball.xml, pos: [0, 0, 1]}  # 🤖\n"
    page = Page(tmp_path, session, recipe)
    unsaved = f"# 🤖 mine\n{recipe}"
    said = {"pos": [0, 0.5, 1], "quat": [1, 0, 0, 0], "texts": {str(page.file): unsaved}}
    answer = page.ask("place", "a", **said)
    assert answer["edits"] == [{"file": str(page.file), "range": [3, 35, 3, 35], "text": ".5"}]
    assert page.text == recipe
    said["texts"] = {str(page.file): unsaved.replace("[0, 0, 1]", "[0, 0.5, 1]")}
    assert page.ask("place", "a", **{**said, "pos": [0, 0.7, 1]})["edits"][0]["text"] == "7"
    said["texts"] = {str(page.file): unsaved.replace("[0, 0, 1]", "[0, 9, 1]")}
    assert "save it first" in page.ask("place", "a", **said)["refused"]
    said["texts"] = {}
    assert page.ask("place", "a", **said)["edits"][0]["range"] == [2, 35, 2, 35]


def test_a_model_that_is_no_recipe_says_what_to_write(tmp_path: Path, session: Session) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    workshop = Workshop("arm.xml", ViewChoice(), session, lambda: Context(folder=tmp_path), words_of)
    workshop.writes = True
    assert "base: ./MODEL.xml" in json.loads(workshop.build().text)["move"]["why"]
    workshop.writes = False
    assert "move" not in json.loads(workshop.build().text)


def test_a_place_that_another_key_says_is_not_given_an_offset(tmp_path: Path, session: Session) -> None:
    recipe = """recipe: 1
attach:
  left: {model: ./ball.xml, pos: [0, 1, 0]}
  right: {model: ./ball.xml, mirror: {of: left, across: y}}
"""
    page = Page(tmp_path, session, recipe)
    assert page.move("right", PLACE)["refused"] == "`mirror` sets this place: change it there"
    assert page.text == recipe and "refused" not in page.move("left", PLACE)


def test_a_page_that_is_a_build_behind_means_its_own_lines(tmp_path: Path, session: Session) -> None:
    recipe = "recipe: 1\nattach:\n  a:\n    model: ./ball.xml\n  b:\n    model: ./ball.xml\n"
    page = Page(tmp_path, session, recipe)
    page.move("a", Pose((1, 0, 0)))
    page.writer.know(page.workshop.build())  # the page does not show it yet, and the lines of b have moved
    page.move("b", Pose((2, 0, 0)))
    assert page.text == recipe.replace("ball.xml\n  b", "ball.xml\n    pos: [1, 0, 0]\n  b") + "    pos: [2, 0, 0]\n"
    assert "select it again" in page.ask("look", "a", version=99)["refused"]


def test_a_urdf_and_a_bundle_are_not_recipes(tmp_path: Path, session: Session) -> None:
    (tmp_path / "robot.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    workshop = Workshop("robot.urdf", ViewChoice(), session, lambda: Context(folder=tmp_path), words_of)
    workshop.writes = True
    assert "base: ./MODEL.xml" in json.loads(workshop.build().text)["move"]["why"]


def test_a_base_with_a_place_moves(tmp_path: Path, session: Session) -> None:
    page = Page(tmp_path, session, "recipe: 1\nbase: {model: ./ball.xml, pos: [1, 0, 0]}  # far\n")
    page.move("base", Pose((2, 0, 0.5)))
    assert page.text == "recipe: 1\nbase: {model: ./ball.xml, pos: [2, 0, 0.5]}  # far\n"
    page.load()


def test_a_variant_says_a_place_of_its_own(tmp_path: Path, session: Session) -> None:
    recipe = """recipe: 1
attach:
  a: {model: ./ball.xml, pos: [0, 0, 0]}
variants:
  where:
    near: {attach: {a: {pos: [1, 0, 0]}}}   # the first is chosen
    far: {attach: {a: {pos: [9, 0, 0]}}}
"""
    page = Page(tmp_path, session, recipe)
    assert page.ask("look", "a")["pos"] == (1.0, 0.0, 0.0)
    page.move("a", Pose((1.5, 0, 0)))
    assert page.text == recipe.replace("[1, 0, 0]", "[1.5, 0, 0]")


REPEATED = """\
recipe: 1
params:
  places:                                       # measured
    default:
      a: {pos: [0, 0, 0], euler: [0, 0, 0]}
      b: {pos: [1, 0, 0], euler: [0, 0, 0]}     # moved on Monday
  tips: {default: {c: {at: [3, 0, 0]}}}
attach:
  "ball_${i}": {for: {i: [a, b]}, model: ./ball.xml, pos: "${places[i].pos}", euler: "${places[i].euler}"}
  "arm${k}": {for: {k: 2}, model: ./arm.xml, pos: [0, 0, 2]}
  "tip_${i}": {for: {i: [c]}, model: ./ball.xml, pos: "${tips[i].at}"}
add:
  - {for: {k: 2}, to: world, site: {name: "s${k}", pos: ["${k}", 0, 0]}}
"""


def test_a_turn_of_a_for_changes_the_row_that_made_it(tmp_path: Path, session: Session) -> None:
    page = Page(tmp_path, session, REPEATED)
    looked = page.ask("look", "ball_b")
    assert (looked["pos"], looked["where"]) == ((1.0, 0.0, 0.0), "cell.yaml:6")
    before = Pose(tuple(looked["pos"]), tuple(looked["quat"]))
    answer = page.move("ball_b", PLACE)
    assert answer["said"].startswith("ball_b: pos: [")
    changed = [(a, b) for a, b in zip(REPEATED.splitlines(), page.text.splitlines(), strict=True) if a != b]
    assert len(changed) == 1 and changed[0][0].strip().startswith("b: ") and "# moved on Monday" in changed[0][1]
    page.is_at("ball_b", PLACE, before)
    assert page.ask("look", "ball_a")["pos"] == (0.0, 0.0, 0.0)
    assert page.ask("undo")["redo"] and page.text == REPEATED


@pytest.mark.parametrize(
    ("label", "reason"),
    [
        ("arm0", "the `for` at cell.yaml:10 makes this, and no table has its place: change the entry"),
        ("arm1", "the `for` at cell.yaml:10 makes this, and no table has its place: change the entry"),
        ("tip_c", "the `for` at cell.yaml:11 reads `pos` from columns with other names: change the table"),
        ("s1", "the `for` at cell.yaml:13 makes this, and no table has its place: change the entry"),
    ],
)
def test_a_turn_of_a_for_is_refused_with_the_reason(tmp_path: Path, session: Session, label: str, reason: str) -> None:
    page = Page(tmp_path, session, REPEATED)
    for answer in (page.ask("look", label), page.move(label, PLACE)):
        assert answer == {"refused": reason}
    assert page.text == REPEATED


def test_columns_that_the_entry_does_not_read_stay(tmp_path: Path, session: Session) -> None:
    turned = Pose((1, 2, 3), quat_from_euler([0, 0, 1], "xyz"))
    unread = REPEATED.replace(', euler: "${places[i].euler}"', "")
    page = Page(tmp_path, session, unread)
    assert page.move("ball_b", turned)["refused"] == "the entry does not read the column `euler` of the table"
    absent = unread.replace(", euler: [0, 0, 0]", "")
    page = Page(tmp_path, session, absent)
    assert "the table has no column `euler`" in page.move("ball_b", turned)["refused"]
    assert page.text == absent
    assert "refused" not in page.move("ball_b", Pose((1, 2, 3)))
    assert "b: {pos: [1, 2, 3]}     # moved on Monday" in page.text


def test_a_row_that_several_turns_read_is_refused(tmp_path: Path, session: Session) -> None:
    recipe = REPEATED.replace('"ball_${i}": {for: {i: [a, b]}', '"ball_${i}_${n}": {for: {i: [a, b], n: 2}')
    page = Page(tmp_path, session, recipe)
    assert "makes several from this row of its table" in page.move("ball_b_1", PLACE)["refused"]
    assert page.text == recipe


def test_a_turn_of_a_for_stays_where_it_is_attached(tmp_path: Path, session: Session) -> None:
    page = Page(tmp_path, session, REPEATED)
    number = page.scene["site"]["name"].index("arm0/tip")
    answer = page.ask("place", "ball_b", site=number)
    assert answer["refused"] == "a `for` makes this part, and the others would move, too: change the entry"
    assert page.text == REPEATED


def test_the_parameters_of_a_turn_are_offered(tmp_path: Path, session: Session) -> None:
    recipe = 'recipe: 1\nparams: {w: 0.3}\nattach:\n  "a${i}": {for: {i: 2}, model: ./ball.xml, pos: ["${w * i}", 0, "${w}"]}\n'
    page = Page(tmp_path, session, recipe)
    answer = page.ask("look", "a1")
    assert answer["refused"].startswith("the `for` at cell.yaml:4 makes this")
    assert answer["parameters"] == [["w", "0.3"]]
