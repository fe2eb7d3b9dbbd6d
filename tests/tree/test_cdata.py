from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from composer.diagnostics.sink import Sink
from composer.tree.parse import parse_file, parse_text
from composer.tree.write import to_text


def _written(custom: str) -> str:
    sink = Sink()
    text = f"<mujoco><custom>{custom}</custom></mujoco>"
    unit = parse_text(text, sink, file="m.xml", directory=Path(), label="m")
    assert unit is not None and not sink.has_errors
    return to_text(unit.root)


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ('<text name="i"><![CDATA[a "q" & <b>]]></text>', b'a "q" & <b>\0'),
        ('<text name="i">\n <![CDATA[a\nb]]> c</text>', b"a\nb\0"),
        ('<!-- <![CDATA[ --><text name="z" data="z"/><text name="i"><![CDATA[a]]></text>', b"z\0a\0"),
    ],
)
def test_a_section_is_the_data_of_a_text(text: str, data: bytes) -> None:
    assert mujoco.MjModel.from_xml_string(_written(text)).text_data == data


def test_plain_text_means_nothing() -> None:
    assert "data" not in _written('<text name="i">plain</text><!-- <![CDATA[x]]> -->')


def test_what_mujoco_saves_comes_back(tmp_path: Path) -> None:
    spec = mujoco.MjSpec()
    spec.add_text(name="i", data='say "hello"')
    spec.compile()
    (tmp_path / "inner.xml").write_text(spec.to_xml())
    (tmp_path / "m.xml").write_text('<mujoco><include file="inner.xml"/></mujoco>')
    unit = parse_file(tmp_path / "m.xml", Sink())
    assert unit is not None
    assert mujoco.MjModel.from_xml_string(to_text(unit.root)).text_data == b'say "hello"\0'
