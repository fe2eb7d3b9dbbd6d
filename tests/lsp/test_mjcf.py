"""MJCF files in a scripted editor, which talks to a real server."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

import pytest
from lsp.client import MARK, Editor, applied, labels, position, stretch
from lsp.conftest import ROBOTS, needs_robots

ARM = """\
<mujoco model="arm">
  <compiler meshdir="meshes"/>
  <default>
    <default class="link">
      <joint damping="2"/>
      <geom rgba="1 0 0 1"/>
      <default class="tip"/>
    </default>
  </default>
  <asset>
    <material name="red" rgba="1 0 0 0.5"/>
    <mesh name="cover" file="cover.obj"/>
  </asset>
  <worldbody>
    <body name="base" childclass="link">
      <joint name="turn" axis="0 0 1" range="-90 90"/>
      <geom name="rod" type="capsule" size="0.1 0.2" material="red"/>
      <site name="flange"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="turn" joint="turn"/>
  </actuator>
  <sensor>
    <framepos objtype="site" objname="flange"/>
    <jointpos joint="turn"/>
  </sensor>
</mujoco>
"""
SCENE = '<mujoco>\n  <include file="arm.xml"/>\n  <include file="keys.xml"/>\n  <sensor><jointvel joint="turn"/></sensor>\n</mujoco>\n'
KEYS = '<mujocoinclude>\n  <contact>\n    <exclude body1="base" body2="world"/>\n  </contact>\n</mujocoinclude>\n'
CELL = """\
<mujoco>
  <asset>
    <model name="arm" file="arm.xml"/>
  </asset>
  <worldbody>
    <attach model="arm" body="base" prefix="a_"/>
  </worldbody>
  <sensor>
    <jointpos joint="a_turn"/>
  </sensor>
</mujoco>
"""
RECIPE = "recipe: 1\nattach:\n  left: {model: ./arm.xml}\nsensor:\n  angle: {type: jointpos, joint: left/turn}\n"


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lab")
    for name, text in {
        "arm.xml": ARM,
        "scene.xml": SCENE,
        "keys.xml": KEYS,
        "cell.xml": CELL,
        "cell.yaml": RECIPE,
    }.items():
        (folder / name).write_text(text)
    (folder / "meshes").mkdir()
    (folder / "meshes" / "cover.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    (folder / "pyproject.toml").touch()
    if ROBOTS is not None:
        for robot in ("shadow_hand", "unitree_g1"):
            shutil.copytree(ROBOTS / robot, folder / robot)
    return folder


@pytest.fixture(scope="module")
def own(lab: Path) -> Iterator[Editor]:
    with Editor(lab) as found:
        yield found
        assert not found.log, "\n".join(found.log)


def marked(old: str, new: str, text: str = ARM) -> str:
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "some", "not_there"),
    [
        ("<site name", "<▮\n<site name", {"geom", "body", "site", "include"}, {"motor", "mesh"}),
        ("<site name", "▮\n<site name", {"geom", "body"}, {"motor"}),
        ("<motor ", "<mo▮ ", {"motor", "position"}, {"geom"}),
        ('<geom name="rod"', '<geom ▮ name="rod"', {"pos", "class", "fromto"}, {"type", "name", "kp"}),
        ('<geom name="rod"', '<geom na▮\n<geom name="rod"', {"pos", "name"}, set()),
        ('"capsule"', '"▮"', {"capsule", "box"}, {"rod"}),
        ('"capsule"', '"▮', {"capsule", "box"}, set()),
        ('material="red"', 'material="▮"', {"red"}, {"cover", "rod"}),
        ('material="red"', 'mesh="▮"', {"cover"}, {"red"}),
        ('material="red"', 'class="▮"', {"link", "tip", "main"}, {"red"}),
        ('joint="turn"/>\n  </actuator', 'joint="▮"/>\n  </actuator', {"turn"}, {"rod"}),
        ('objname="flange"', 'objname="▮"', {"flange"}, {"rod", "base"}),
        ('file="cover.obj"', 'file="▮"', {"cover.obj"}, set()),
        ('model="arm">', 'model="arm">\n<option integrator="▮"/>', {"Euler", "implicitfast"}, set()),
        ('meshdir="meshes"', 'autolimits="▮"', {"true", "false"}, set()),
        ("</worldbody>", "</▮", {"worldbody"}, set()),
    ],
)
def test_completion(own: Editor, old: str, new: str, some: set[str], not_there: set[str]) -> None:
    own.complete(ARM.replace("<mujoco", MARK + "<mujoco", 1), "arm.xml")  # the names of the whole text are known
    found = labels(own.complete(marked(old, new), "arm.xml"))
    assert some <= set(found) and not not_there & set(found), found


def test_a_completion_replaces_the_word_and_writes_quotes(own: Editor) -> None:
    text = marked('"capsule"', "▮")
    items = own.complete(text, "arm.xml")
    edit = next(each["textEdit"] for each in items if each["label"] == "box")
    assert applied(text.replace(MARK, ""), [edit]) == marked('"capsule"', '"box"')
    text = marked('<geom name="rod"', '<geom po▮ name="rod"')
    edit = next(each["textEdit"] for each in own.complete(text, "arm.xml") if each["label"] == "pos")
    assert applied(text.replace(MARK, ""), [edit]) == marked('<geom name="rod"', '<geom pos="" name="rod"')


def hover(own: Editor, text: str, name: str = "arm.xml") -> str:
    params, _ = own.at(text, name)
    found = own.ask("textDocument/hover", params)
    return "" if found is None else str(found["contents"]["value"])


def test_hover(own: Editor) -> None:
    damping = hover(own, marked('axis="0 0 1"', 'dam▮ping="3"'))
    assert "damping" in damping and "value in effect: **`3 0 0`**" in damping
    assert "class `link`: `2` (arm.xml:5)" in damping and "class `link`, by `childclass`" in damping
    named = hover(own, marked('joint="turn"', 'joint="tu▮rn"'))
    assert "**joint `turn`**" in named and "in body `base`" in named and "damping: `2` from class `link`" in named
    assert "a shape that collides" in hover(own, marked("<geom name", "<ge▮om name"))
    assert hover(own, marked("<compiler", "<!-- ▮ --><compiler")) == ""


def test_definition_and_references(own: Editor, lab: Path) -> None:
    params, text = own.at(marked('joint="turn"/>\n  </sensor>', 'joint="tu▮rn"/>\n  </sensor>'), "arm.xml")
    (found,) = own.ask("textDocument/definition", params)
    assert found["range"]["start"]["line"] == 15 and stretch(found["range"], text) == "turn"
    uses = own.ask("textDocument/references", {**params, "context": {"includeDeclaration": True}})
    places = {(Path(each["uri"]).name, each["range"]["start"]["line"]) for each in uses}
    assert places == {("arm.xml", 15), ("arm.xml", 21), ("arm.xml", 25), ("scene.xml", 3), ("cell.xml", 8)}
    params, _ = own.at(marked("cover.obj", "cov▮er.obj"), "arm.xml")
    (found,) = own.ask("textDocument/definition", params)
    assert found["uri"] == (lab / "meshes" / "cover.obj").as_uri()
    params, _ = own.at(marked("arm.xml", "ar▮m.xml", SCENE), "scene.xml")
    (found,) = own.ask("textDocument/definition", params)
    assert found["uri"] == (lab / "arm.xml").as_uri()


def test_a_piece_of_a_model_knows_the_names_of_the_model_that_includes_it(own: Editor) -> None:
    assert {"base", "world"} <= set(labels(own.complete(marked('body1="base"', 'body1="▮"', KEYS), "keys.xml")))
    params, _ = own.at(marked('body1="base"', 'body1="ba▮se"', KEYS), "keys.xml")
    (found,) = own.ask("textDocument/definition", params)
    assert Path(found["uri"]).name == "arm.xml" and found["range"]["start"]["line"] == 14


def test_the_text_of_the_editor_counts_in_included_files(own: Editor) -> None:
    own.at(MARK + ARM.replace("turn", "yaw"), "arm.xml")
    own.diagnostics(own.at(MARK + SCENE, "scene.xml")[0]["textDocument"]["uri"])
    found = labels(own.complete(marked('joint="turn"', 'joint="▮"', SCENE), "scene.xml"))
    for text, name in ((ARM, "arm.xml"), (SCENE, "scene.xml")):
        own.at(MARK + text, name)
    assert found == ["yaw"]


def renamed(own: Editor, lab: Path, text: str, name: str, new: str) -> dict[str, str]:
    params, _ = own.at(text, name)
    assert own.ask("textDocument/prepareRename", params) is not None
    changes = own.ask("textDocument/rename", {**params, "newName": new})["changes"]
    texts = {"arm.xml": ARM, "scene.xml": SCENE, "keys.xml": KEYS, "cell.xml": CELL, "cell.yaml": RECIPE}
    return {Path(uri).name: applied(texts[Path(uri).name], edits) for uri, edits in changes.items()}


def test_rename_in_everything_that_refers_to_it(own: Editor, lab: Path) -> None:
    found = renamed(own, lab, marked('joint="turn"', 'joint="tu▮rn"'), "arm.xml", "yaw")
    assert found == {
        "arm.xml": ARM.replace('<joint name="turn"', '<joint name="yaw"').replace('joint="turn"', 'joint="yaw"'),
        "scene.xml": SCENE.replace("turn", "yaw"),
        "cell.yaml": RECIPE.replace("left/turn", "left/yaw"),
        "cell.xml": CELL.replace("a_turn", "a_yaw"),
    }
    found = renamed(own, lab, marked('childclass="link"', 'childclass="li▮nk"'), "arm.xml", "part")
    assert found == {"arm.xml": ARM.replace('class="link"', 'class="part"').replace('"link"', '"part"')}
    found = renamed(own, lab, marked('body1="base"', 'body1="ba▮se"', KEYS), "keys.xml", "root")
    assert found["keys.xml"] == KEYS.replace('"base"', '"root"') and '<body name="root"' in found["arm.xml"]


@pytest.mark.parametrize(
    ("old", "at", "new", "reason"),
    [
        ('name="rod"', 'name="ro▮d"', 'a"b', "cannot be the name"),
        ('class="tip"', 'class="ti▮p"', "link", "there is a default `link` already"),
    ],
)
def test_refused_renames(own: Editor, old: str, at: str, new: str, reason: str) -> None:
    params, _ = own.at(marked(old, at), "arm.xml")
    with pytest.raises(AssertionError, match=reason):
        own.ask("textDocument/rename", {**params, "newName": new})


def test_a_name_that_cannot_be_renamed(own: Editor) -> None:
    for text, name in (
        (marked('body2="world"', 'body2="wo▮rld"', KEYS), "keys.xml"),
        (marked("0.1 0.2", "0.▮1 0.2"), "arm.xml"),
    ):
        params, _ = own.at(text, name)
        assert own.ask("textDocument/prepareRename", params) is None


def test_quick_fixes(own: Editor) -> None:
    params, text = own.at(marked('size="0.1 0.2"', 's▮ise="0.1 0.2"'), "arm.xml")
    uri = params["textDocument"]["uri"]
    (found,) = own.wait(uri, bool)
    assert found["code"] == "unknown-attribute"
    place = {"start": params["position"], "end": params["position"]}
    asked = {"textDocument": params["textDocument"], "range": place, "context": {"diagnostics": [found]}}
    (action,) = own.ask("textDocument/codeAction", asked)
    assert applied(text, action["edit"]["changes"][uri]) == ARM


def test_lint(own: Editor, lab: Path) -> None:
    text = ARM.replace('<default class="tip"/>', '<default class="tip">\n        <geom size="1"/>\n      </default>')
    (lab / "linted.xml").write_text(ARM)  # the text of the editor counts
    params, _ = own.at(MARK + text, "linted.xml")
    uri = params["textDocument"]["uri"]
    (found,) = [each for each in own.wait(uri, bool) if each["code"] == "unused-class"]
    asked = {"textDocument": {"uri": uri}, "range": found["range"], "context": {"diagnostics": [found]}}
    action, ignore = own.ask("textDocument/codeAction", asked)
    ignored = applied(text, ignore["edit"]["changes"][uri])
    assert '      <!-- mjcompose: ignore[unused-class] -->\n      <default class="tip">' in ignored
    without = applied(text, action["edit"]["changes"][uri])
    assert "tip" not in without
    for text in (without, ignored):
        own.change(uri, text)
        codes = own.wait(uri, lambda found: "unused-mesh" in [each["code"] for each in found])
        assert "unused-class" not in [each["code"] for each in codes]


def test_symbols_and_folding(own: Editor) -> None:
    uri = own.at(MARK + ARM, "arm.xml")[0]["textDocument"]
    (root,) = own.ask("textDocument/documentSymbol", {"textDocument": uri})
    sections = {each["name"]: each.get("children") or [] for each in root["children"]}
    assert list(sections) == ["compiler", "default", "asset", "worldbody", "actuator", "sensor"]
    (base,) = sections["worldbody"]
    assert (base["name"], base["detail"]) == ("base", "body")
    assert [each["name"] for each in base["children"]] == ["turn", "rod", "flange"]
    assert [each["name"] for each in sections["default"]] == ["link"]
    folds = own.ask("textDocument/foldingRange", {"textDocument": uri})
    assert {"startLine": 14, "endLine": 17} in [{key: each[key] for key in ("startLine", "endLine")} for each in folds]


def test_symbols_of_a_model_that_is_not_finished(own: Editor) -> None:
    whole = '<mujoco><worldbody><body name="a"><geom name="g"/></body></worldbody></mujoco>'
    kinds = []
    for at, text in enumerate((whole, whole.removesuffix("</body></worldbody></mujoco>"))):
        uri = own.at(MARK + text, f"model{at}.xml")[0]["textDocument"]
        (root,) = own.ask("textDocument/documentSymbol", {"textDocument": uri})
        (section,) = root["children"]
        (body,) = section["children"]
        kinds.append([each["kind"] for each in (root, section, body, *body["children"])])
    assert kinds[0] == kinds[1]


def test_colors(own: Editor) -> None:
    params, text = own.at(MARK + ARM, "arm.xml")
    found = own.ask("textDocument/documentColor", {"textDocument": params["textDocument"]})
    assert [stretch(each["range"], text) for each in found] == ["1 0 0 1", "1 0 0 0.5"]
    assert found[1]["color"] == {"red": 1, "green": 0, "blue": 0, "alpha": 0.5}
    color = {"red": 0.2, "green": 0.4, "blue": 1 / 3, "alpha": 1}
    asked = {"textDocument": params["textDocument"], "range": found[1]["range"], "color": color}
    assert [each["label"] for each in own.ask("textDocument/colorPresentation", asked)] == ["0.2 0.4 0.3333 1"]


def test_formatting(own: Editor) -> None:
    untidy = '<mujoco>\n<worldbody>\n<geom size=".1" name="a"/>\n</worldbody></mujoco>\n'
    params, _ = own.at(MARK + untidy, "untidy.xml")
    options = {"tabSize": 2, "insertSpaces": True}
    edits = own.ask("textDocument/formatting", {"textDocument": params["textDocument"], "options": options})
    assert applied(untidy, edits) == (
        '<mujoco>\n  <worldbody>\n    <geom name="a" size=".1"/>\n  </worldbody>\n</mujoco>\n'
    )


def test_other_xml_is_left_alone(own: Editor) -> None:
    for text in ("<robot name='a'><▮</robot>", "<project>\n  <▮\n</project>", "▮"):
        params, _ = own.at(text, "package.xml")
        assert own.ask("textDocument/completion", params) is None
        assert own.ask("textDocument/hover", params) is None
        assert params["textDocument"]["uri"] not in own.published


@needs_robots
def test_a_piece_of_menagerie(own: Editor, lab: Path) -> None:
    text = (lab / "shadow_hand" / "keyframes.xml").read_text()
    params, _ = own.at(MARK + text, "shadow_hand/keyframes.xml")
    assert own.diagnostics(params["textDocument"]["uri"]) == []
    scene = (lab / "shadow_hand" / "scene_right.xml").read_text()
    params, _ = own.at(
        marked("<worldbody>", '<sensor><jointpos joint="rh_▮"/></sensor><worldbody>', scene),
        "shadow_hand/scene_right.xml",
    )
    own.diagnostics(params["textDocument"]["uri"])
    items = own.ask("textDocument/completion", params)["items"]
    assert {"rh_WRJ1", "rh_THJ1"} <= set(labels(items))
    params, _ = own.at(
        marked('joint="rh_', 'joint="▮rh_', (lab / "shadow_hand" / "right_hand.xml").read_text()),
        "shadow_hand/right_hand.xml",
    )
    (found,) = own.ask("textDocument/definition", params)
    assert Path(found["uri"]).name == "right_hand.xml"


@needs_robots
def test_completion_is_quick_in_a_thousand_lines(own: Editor, lab: Path) -> None:
    text = (lab / "unitree_g1" / "g1_with_hands.xml").read_text()
    worldbody = text[text.index("<worldbody>") : text.index("</worldbody>")]
    more = [worldbody.replace('name="', f'name="{each}_').replace("<worldbody>", "") for each in ("one", "two")]
    text = text.replace("</worldbody>", "".join(more) + "</worldbody>", 1)
    assert text.count("\n") > 1000
    uri = own.open("unitree_g1/long.xml", text)
    own.diagnostics(uri)
    spent: list[float] = []
    for number in range(20):
        typed = marked('material="', f'material="{"m" * (number % 4)}{MARK}', text)
        own.change(uri, typed.replace(MARK, ""))
        begin = time.perf_counter()
        place: dict[str, Any] = {"textDocument": {"uri": uri}, "position": position(typed)}
        items = own.ask("textDocument/completion", place)["items"]
        spent.append(time.perf_counter() - begin)
        assert "black" in labels(items)
    is_busy = os.getloadavg()[0] > (os.cpu_count() or 1)
    assert median(spent) < (1 if is_busy else 0.1), spent
