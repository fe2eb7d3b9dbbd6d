from __future__ import annotations

import pytest

from composer import mjcf


@pytest.fixture
def world() -> mjcf.Element:
    world = mjcf.RootElement().worldbody
    for name in ("a", "b", "c"):
        world.add("geom", name=name, size=[1])
    return world


def test_it_is_a_list_and_takes_names(world: mjcf.Element) -> None:
    geoms = world.geom
    assert len(geoms) == 3 and geoms["b"] is geoms[1] is geoms[-2]
    assert [geom.name for geom in geoms[1:]] == ["b", "c"] and geoms["a"] in geoms
    assert geoms == world.find_all("geom") and geoms == world.geom and geoms != [geoms[0]]
    assert repr(geoms).startswith('[<geom name="a" size="1"/>, <geom name="b"')


def test_a_name_that_is_not_there_is_told_with_those_that_are(world: mjcf.Element) -> None:
    with pytest.raises(
        mjcf.MjcfError, match="the geom `d` does not exist here\n.*geoms that exist: a, b, c"
    ) as caught:
        world.geom["d"]
    assert isinstance(caught.value, KeyError) and caught.value.diagnostics[0].span.file == __file__  # type: ignore[union-attr]
    unnamed = world.add("body").add("site").parent
    with pytest.raises(mjcf.MjcfError, match="none of the 1 elements here has a name"):
        unnamed.site["d"]  # type: ignore[union-attr]
    assert world.geom._ipython_key_completions_() == ["a", "b", "c"]
    with pytest.raises(IndexError):
        world.geom[3]


def test_what_is_deleted_from_it_leaves_the_model(world: mjcf.Element) -> None:
    del world.geom["b"]
    del world.geom[0]
    assert [geom.name for geom in world.geom] == ["c"]
    world.geom.clear()
    assert world.geom == [] and world.root.find_all("geom") == []


def test_it_stays_as_it_was_while_the_model_changes(world: mjcf.Element) -> None:
    for geom in world.geom:
        geom.remove()
    assert len(world.geom) == 0
    assert not hasattr(world.geom, "append")


def test_what_is_in_a_list_is_told_by_name_and_by_element() -> None:
    world = mjcf.RootElement().worldbody
    ball, other = world.add("geom", name="ball", size=[1]), mjcf.RootElement().worldbody.add("geom", size=[1])
    assert ball in world.geom and "ball" in world.geom
    assert other not in world.geom and "bal" not in world.geom and None not in world.geom
