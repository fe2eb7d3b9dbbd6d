from __future__ import annotations

from pathlib import Path

import pytest
from lsp.client import MARK, position
from mjcompose.base.sink import Sink
from mjcompose.lsp.markup import ModelAnalysis, ModelQuestion, read_model, repaired
from mjcompose.tree.parse import parse_xml

ARM = """\
<mujoco model="arm">
  <default>
    <default class="link">
      <geom rgba="1 0 0 1"/>
    </default>
  </default>
  <worldbody>
    <body name="base" childclass="link">
      <!-- a geom -->
      <geom name="rod" size="0.1 0.2"/>
    </body>
  </worldbody>
</mujoco>
"""


def asked(marked: str) -> ModelQuestion:
    at = position(marked)
    text = marked.replace(MARK, "")
    return ModelQuestion(ModelAnalysis(Path("arm.xml"), Path(), text), text.split("\n"), at["line"], at["character"])


@pytest.mark.parametrize(
    ("old", "new", "role", "path", "word"),
    [
        ("<geom name", "<ge▮om name", "tag", "mujoco/worldbody/body", "ge"),
        ("<geom name", "<▮\n<geom name", "tag", "mujoco/worldbody/body", ""),
        ('name="rod"', 'na▮me="rod"', "key", "mujoco/worldbody/body/geom", "na"),
        (' size="0.1 0.2"', " ▮", "key", "mujoco/worldbody/body/geom", ""),
        (' size="0.1 0.2"/>', " ▮", "key", "mujoco/worldbody/body/geom", ""),
        ('"rod"', '"r▮od"', "value", "mujoco/worldbody/body/geom/name", "r"),
        ('"rod"', '"r▮', "value", "mujoco/worldbody/body/geom/name", "r"),
        ('"rod"', "▮", "value", "mujoco/worldbody/body/geom/name", ""),
        ("0.1 0.2", "0.1 0.▮2", "value", "mujoco/worldbody/body/geom/size", "0."),
        ("a geom", "a ▮geom", "text", "mujoco/worldbody/body", ""),
        ("<!--", "jo▮<!--", "content", "mujoco/worldbody/body", "jo"),
        ("</body>", "</b▮ody>", "end", "mujoco/worldbody/body", "b"),
        ("</worldbody>\n", "▮", "content", "mujoco/worldbody", ""),
    ],
)
def test_the_place_of_a_cursor(old: str, new: str, role: str, path: str, word: str) -> None:
    cursor = asked(ARM.replace(old, new, 1)).cursor
    assert (cursor.role, "/".join(map(str, cursor.path)), cursor.word) == (role, path, word)


def test_every_beginning_of_a_text_can_be_read() -> None:
    for end in range(ARM.index("<default>"), len(ARM)):
        whole = repaired(ARM[:end])
        root = parse_xml(whole, "arm.xml", Sink())
        assert root is not None, whole
        assert whole.startswith(ARM[:end].rpartition("<")[0].rstrip())
    assert repaired(ARM) == ARM


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('0.2"/>', '0.2" name="other"/>'),
        ("<geom name", "<4 <geom name"),
        ("</body>", ""),
        ("<worldbody>", ""),
        ("<worldbody>", "<visua\n<worldbody>"),
    ],
)
def test_a_fault_leaves_the_names_of_the_rest(old: str, new: str, tmp_path: Path) -> None:
    unit, nodes = read_model(tmp_path / "arm.xml", ARM.replace(old, new), tmp_path)
    assert unit is not None
    assert [each.get("name") for each in nodes if each.tag == "geom"] == [None, "rod"]
    analysis = ModelAnalysis(tmp_path / "arm.xml", tmp_path, "", unit=unit)
    assert analysis.names.find("default", "link") is not None


def test_a_piece_of_a_model_has_the_names_of_the_model_that_includes_it(tmp_path: Path) -> None:
    inner = '<mujocoinclude>\n  <key name="home" qpos="0"/>\n</mujocoinclude>\n'
    alone, nodes = read_model(tmp_path / "keys.xml", inner, tmp_path)
    assert alone is not None and [each.tag for each in nodes] == ["key"]
    (tmp_path / "keys.xml").write_text(inner)
    (tmp_path / "arm.xml").write_text(
        ARM.replace("</mujoco>", '<keyframe><include file="keys.xml"/></keyframe></mujoco>')
    )
    unit, (key,) = read_model(tmp_path / "keys.xml", inner.replace("home", "start"), tmp_path)
    assert unit is not None and unit.file == "arm.xml" and key.get("name") == "start"
    assert (span := unit.origins.span(key, unit.file, "name")).file == "keys.xml" and span.line == 2
