from __future__ import annotations

import pytest

from composer import mjcf
from composer.mjcf import dm_control_hints as elsewhere


@pytest.fixture
def body() -> mjcf.Element:
    return mjcf.RootElement("m").worldbody.add("body", name="b")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pso", "did you mean `pos`"),
        ("geoms", "did you mean `geom`"),
        ("attch", "did you mean `attach`"),
        ("ad", "`add`"),
    ],
)
def test_what_was_probably_meant_is_told(body: mjcf.Element, name: str, said: str) -> None:
    with pytest.raises(mjcf.MjcfError, match=said):
        getattr(body, name)


@pytest.mark.parametrize("name", elsewhere.ATTRIBUTES)
def test_words_of_dm_control_are_told_as_what_they_are_here(body: mjcf.Element, name: str) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        getattr(body, name)
    assert caught.value.diagnostics[0].help == elsewhere.ATTRIBUTES[name]


@pytest.mark.parametrize("tag", elsewhere.TAGS)
def test_so_are_its_namespaces(body: mjcf.Element, tag: str) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        body.root.find(tag, "x")
    assert caught.value.diagnostics[0].help == elsewhere.TAGS[tag]


def test_they_are_no_children(body: mjcf.Element) -> None:
    with pytest.raises(mjcf.MjcfError, match="cannot have a `attachment_frame`"):
        body.add("attachment_frame")
    with pytest.raises(mjcf.MjcfError) as caught:
        body.set_attributes(namescope=1)
    assert caught.value.diagnostics[0].help is None
