from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from composer import mjcf
from composer.mjcf import Element, MjcfError


@pytest.fixture
def geom() -> Element:
    body = mjcf.RootElement().worldbody.add("body", name="b")
    return body.add("geom", name="g", type="box", size=[1, 2, 3], pos=[1, 2, 3], user=[1, 2])


def test_an_item_that_is_assigned_is_set(geom: Element) -> None:
    geom.pos[2] = 7
    geom.pos[:2] = [5, 6]
    geom.size[0] += 0.5
    assert geom.pos.tolist() == [5, 6, 7] and geom.size[0] == 1.5
    assert 'pos="5 6 7"' in repr(geom)


def test_computing_in_place_sets_too(geom: Element) -> None:
    geom.pos += [1, 1, 1]
    geom.pos *= 2
    geom.pos /= 4
    pos = geom.pos
    pos -= 1
    pos **= 2
    assert pos.tolist() == geom.pos.tolist() == [0, 0.25, 1]


def test_the_line_that_changed_an_item_is_its_origin(geom: Element) -> None:
    geom.pos[0] = 4
    assert geom.origin_of("pos").file == __file__
    assert geom.origin_of("pos").line > geom.origin_of("size").line


def test_what_was_set_elsewhere_in_the_meantime_stays(geom: Element) -> None:
    pos = geom.pos
    geom.pos = [7, 8, 9]
    pos[0] = 0
    assert geom.pos.tolist() == pos.tolist() == [0, 8, 9]


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("geom.pos[0] = float('nan')", "expects numbers, got `nan`"),
        ("geom.pos[0] = 'x'", "`pos` of `<geom>` `g` cannot take this"),
        ("geom.pos[:2] = [1, 2, 3]", "`pos` of `<geom>` `g` cannot take this"),
        ("geom.pos += [1, 2]", "`pos` of `<geom>` `g` cannot take this"),
        ("geom.pos /= 'x'", "`pos` of `<geom>` `g` cannot take this"),
        ("part = geom.pos[:2]; part[0] = 1", "a part of an attribute's array"),
    ],
)
def test_what_does_not_fit_changes_nothing(geom: Element, statement: str, message: str) -> None:
    before = repr(geom)
    with pytest.raises(MjcfError, match=message):
        exec(statement, {"geom": geom})
    assert repr(geom) == before


def test_a_fraction_is_no_integer(geom: Element) -> None:
    texture = geom.root.asset.add("texture", name="t", builtin="flat", width=8, height=8, gridsize=[1, 1])
    texture.gridsize[1] = 3
    with pytest.raises(MjcfError, match="expects every item to be an integer"):
        texture.gridsize[0] = 1.5
    assert texture.gridsize.tolist() == [1, 3] and texture.gridsize.dtype == np.int64


def test_a_removed_element_tells(geom: Element) -> None:
    pos = geom.pos
    geom.remove()
    with pytest.raises(MjcfError, match="was removed"):
        pos[0] = 1


def test_nothing_else_writes_to_it(geom: Element) -> None:
    pos = geom.pos
    with pytest.raises(ValueError, match="read-only"):
        np.add(pos, 1, out=pos)
    with pytest.raises(ValueError, match="read-only"):
        pos.sort()
    assert geom.pos.tolist() == pos.tolist() == [1, 2, 3]


def test_what_is_computed_from_it_and_copies_are_plain(geom: Element) -> None:
    pos = geom.pos
    plain = [pos + 1, pos * pos, 2 * pos, -pos, np.cross(pos, pos), pos.copy(), np.array(pos)]
    plain += [copy.copy(pos), copy.deepcopy(pos), pickle.loads(pickle.dumps(pos))]
    for each in plain:
        assert type(each) is np.ndarray
        each[0] = 100
    assert isinstance(pos.sum(), np.float64) and type(pos @ pos) is np.float64
    assert geom.pos.tolist() == [1, 2, 3] and repr(pos) == "array([1., 2., 3.])" and str(pos) == "[1. 2. 3.]"
