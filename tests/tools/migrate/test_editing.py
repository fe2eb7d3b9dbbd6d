"""What was measured of the whole model, by the names that the models attached to it have for their own elements.

Changes of a tree in the text that it was read from.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree
from mjcompose.sources.context import Context
from mjcompose.tools.migrate.editing import Markup, MarkupError, Migration, Pieces
from mjcompose.tools.migrate.migrate import _sources, read

ARM = """\
<mujoco>
  <asset><model name="hand" file="hand.xml"/></asset>
  <worldbody><frame><attach model="hand" body="palm" prefix="l_"/><attach model="hand" body="palm" prefix="r_"/></frame></worldbody>
  <actuator><position name="turn" joint="j" kp="1" dampratio="1"/></actuator>
</mujoco>
"""
HAND = """\
<mujoco model="hand">
  <asset><model file="tip.xml"/></asset>
  <worldbody><body name="palm"><joint name="j"/><attach model="tip" body="tip" prefix="t_"/></body></worldbody>
  <actuator><position name="grip" joint="j" kp="1" dampratio="1"/></actuator>
</mujoco>
"""
TIP = """\
<mujoco model="tip">
  <worldbody><body name="tip"><joint name="j"/></body></worldbody>
  <actuator><position name="press" joint="j" kp="1" dampratio="1"/></actuator>
</mujoco>
"""
ALL = {"turn": "1", "l_grip": "2", "r_grip": "2", "l_t_press": "3", "r_t_press": "3"}


@pytest.mark.parametrize(
    ("measured", "hand", "tip"),
    [
        (ALL, {"grip": "2"}, {"press": "3"}),
        ({**ALL, "r_grip": "4"}, {}, {"press": "3"}),
        ({name: value for name, value in ALL.items() if name != "l_t_press"}, {"grip": "2"}, {}),
    ],
    ids=["all the same", "one has another", "one is missing"],
)
def test_an_actuator_has_what_all_of_its_copies_have(
    measured: dict[str, str], hand: dict[str, str], tip: dict[str, str], tmp_path: Path
) -> None:
    for name, text in (("arm", ARM), ("hand", HAND), ("tip", TIP)):
        (tmp_path / f"{name}.xml").write_text(text)
    context = Context(environment={}, folder=tmp_path)
    unit = read(Path("arm.xml"), context)
    assert unit is not None
    pieces = Pieces.of(unit, context)
    assert [each.unit.label for each in pieces.every] == ["arm", "hand", "tip"]
    assert [pieces.measured(each, {"kv": measured})["kv"] for each in pieces.every] == [measured, hand, tip]
    assert [pieces.measured(each, {}) for each in pieces.every] == [{}, {}, {}]


TEXT = """\
<?xml version="1.0"?>
<!-- <geom size="9"/> -->
<mujoco model='a &amp; b'>
\t<option timestep=".001"
\t        gravity = "0 0 -1" />
\t<worldbody>
\t\t<geom name="a>b" size=".1"/><!-- beside --><geom name="c"
\t\t\tsize='.2'></geom>
\t\t<body><geom size=".3"/></body>
\t</worldbody>
</mujoco>
"""


def edited(text: str, folder: Path) -> tuple[Migration, Path]:
    model = folder / "model.xml"
    model.write_bytes(text.encode())
    context = Context(environment={}, folder=folder)
    unit = read(model, context)
    assert unit is not None
    editing = Migration(unit, context.sink, "4.0.0", "4.0.0")
    editing.values["sources"] = _sources(unit, context)
    return editing, model


def text_of(editing: Migration, model: Path) -> str:
    sources = editing.values["sources"]
    assert isinstance(sources, dict)
    found = sources[model][0].rewritten(editing.renamed)
    etree.fromstring(found.encode())
    return str(found)


def test_nothing_changes_nothing(tmp_path: Path) -> None:
    assert text_of(*edited(TEXT, tmp_path)) == TEXT


def test_a_value_keeps_what_is_around_it(tmp_path: Path) -> None:
    editing, model = edited(TEXT, tmp_path)
    first, second, _ = editing.at("body/geom")
    editing.set(first, "size", '".5"')
    editing.set(second, "rgba", "1 0 0 1")
    expected = TEXT.replace('"a>b" size=".1"', '"a>b" size=\'".5"\'').replace(
        "size='.2'>", "size='.2' rgba=\"1 0 0 1\">"
    )
    assert text_of(editing, model) == expected


def test_an_attribute_is_renamed_in_its_place_and_taken_away(tmp_path: Path) -> None:
    editing, model = edited(TEXT, tmp_path)
    (option,) = editing.at("option")
    editing.rename(option, "timestep", "other")
    editing.unset(option, "gravity")
    assert text_of(editing, model) == TEXT.replace(
        'timestep=".001"\n\t        gravity = "0 0 -1" />', 'other=".001" />'
    )
    editing.rename(option, "other", "timestep")
    assert '<option timestep=".001" />' in text_of(editing, model)


def test_an_element_gets_children(tmp_path: Path) -> None:
    editing, model = edited(TEXT, tmp_path)
    editing.set(editing.within("option/flag"), "island", "disable")
    editing.set(editing.within("visual/headlight"), "active", "1")
    text = text_of(editing, model)
    assert '"0 0 -1">\n\t\t<flag island="disable"/>\n\t</option>\n' in text
    assert '\t<visual>\n\t\t<headlight active="1"/>\n\t</visual>\n\t<option' in text


def test_another_tag(tmp_path: Path) -> None:
    editing, model = edited(TEXT, tmp_path)
    editing.retag(editing.at("body/geom")[1], "site")
    assert "<site name=\"c\"\n\t\t\tsize='.2'></site>" in text_of(editing, model)


def test_another_tag_gets_its_first_attribute(tmp_path: Path) -> None:
    editing, model = edited(TEXT, tmp_path)
    (body,) = editing.at("body")
    editing.retag(body, "replicate")
    editing.set(body, "count", "2")
    assert '<replicate count="2"><geom size=".3"/></replicate>' in text_of(editing, model)


def test_line_breaks_of_windows_and_a_mark_are_kept(tmp_path: Path) -> None:
    editing, model = edited("\ufeff" + TEXT.replace("\n", "\r\n"), tmp_path)
    editing.set(editing.within("option/flag"), "island", "disable")
    text = text_of(editing, model)
    assert text.count("\n") == text.count("\r\n") == TEXT.count("\n") + 2


def test_text_that_is_no_markup() -> None:
    with pytest.raises(MarkupError):
        Markup.read("<a><b></a>")
    with pytest.raises(MarkupError):
        Markup.read("<a>")
