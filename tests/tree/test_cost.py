from __future__ import annotations

import time
from pathlib import Path

import mujoco
import pytest
from hypothesis import given, strategies as st
from lxml import etree
from lxml.etree import fromstring
from mjcompose.base.limits import allow, in_force
from mjcompose.base.sink import Sink
from mjcompose.tree import cost
from mjcompose.tree.cost import Weight, expanded, first_scaled, scaled_above
from mjcompose.tree.parse import parse_text


def told(inside: str) -> list[tuple[str, str, int | None]]:
    """Code, message and line of each error of a model."""
    sink = Sink()
    text = f"<mujoco>\n<worldbody>\n{inside}\n</worldbody>\n</mujoco>"
    parse_text(text, sink, file="m.xml", directory=Path(), label="m")
    return [(each.code, each.message, each.span and each.span.line) for each in sink.errors]


@pytest.mark.parametrize(
    ("inside", "size"),
    [
        ('<replicate count="3"><geom/></replicate>', 4),
        ('<replicate count="3"><body><replicate count="5"><geom/></replicate></body></replicate>', 22),
        ('<replicate count="3"/>', 4),
        ('<replicate count="3"><!-- nothing --></replicate>', 4),
        ("<replicate><geom/></replicate>", 2),
        ('<replicate count="many"><geom/></replicate>', 2),
        ('<replicate count="2e3"><geom/></replicate>', 2001),
        ('<composite count="7 2 1"><geom/></composite>', 29),
        ("<composite><geom/></composite>", 3),
        ("<flexcomp/>", 1001),
        ('<flexcomp count="4 5 6"/>', 121),
        ('<flexcomp type="disc" count="4 5 1"><edge/></flexcomp>', 22),
        ('<flexcomp count="4 5 6" file="ignored.obj"/>', 121),
        ('<flexcomp type="direct" point="0 0 0 1 1 1"/>', 3),
        ('<flexcomp type="mesh" file="a.obj" count="9 9 9"/>', 1),
    ],
)
def test_sizes(inside: str, size: int) -> None:
    assert expanded(etree.fromstring(inside)).elements == size


def test_what_is_attached_counts_each_time() -> None:
    root = etree.fromstring('<body><replicate count="10"><attach/></replicate><attach/></body>')
    weight = expanded(root, lambda _: Weight(100, 7, 5, 15))
    assert weight == Weight(1 + (1 + 10 * 101) + 101, 1 + 11 * 7, 11 * 5, 11 * 15)


BODY = '<body pos="1 0 0">{}<geom size=".1"/></body>'
BALL = '<default><joint type="ball"/></default>'


@pytest.mark.parametrize(
    ("inside", "default"),
    [
        (
            BODY.format("<freejoint/>")
            + BODY.format('<joint type="ball"/>')
            + BODY.format("<joint/><joint axis='1 0 0'/>"),
            "",
        ),
        (BODY.format("<joint/>" + BODY.format("<joint/>" + BODY.format("<joint/>")) + BODY.format("<joint/>")), ""),
        (f'<replicate count="3" offset="9 0 0">{BODY.format("<joint/>" + BODY.format("<joint/>"))}</replicate>', ""),
        (BODY.format(f'<joint/><replicate count="4" offset="9 0 0">{BODY.format("<joint/>")}</replicate>'), ""),
        (BODY.format("<joint/>" + BODY.format("<joint/>")), BALL),
        ('<body name="b"><flexcomp name="f" count="3 3 3" spacing=".1 .1 .1" dim="3" mass="1"/></body>', ""),
        ('<body name="b"><flexcomp name="f" count="3 3 1" spacing=".1 .1 .1" dim="2" mass="1" dof="2d"/></body>', ""),
        (
            '<body name="b"><flexcomp name="f" count="3 3 3" spacing=".1 .1 .1" dim="3" mass="1" dof="trilinear"/></body>',
            "",
        ),
        (
            '<body name="b"><flexcomp name="f" count="3 3 3" spacing=".1 .1 .1" dim="3" mass="1" dof="trilinear" cellcount="2 1 1"/></body>',
            "",
        ),
        (
            '<body name="b"><flexcomp name="f" count="3 3 3" spacing=".1 .1 .1" dim="3" mass="1" rigid="true"/></body>',
            "",
        ),
        (
            '<frame pos="0 0 1">' + BODY.format('<joint name="j"/>') + "</frame></worldbody><equality>"
            '<joint joint1="j"/></equality><worldbody>',
            "",
        ),
    ],
    ids=[
        "kinds",
        "chain",
        "replicated",
        "replicated in a body",
        "by class",
        "soft",
        "2d",
        "trilinear",
        "cells",
        "rigid",
        "in a frame",
    ],
)
def test_what_mujoco_makes_of_it(inside: str, default: str) -> None:
    text = f"<mujoco>{default}<worldbody>{inside}</worldbody></mujoco>"
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        if "cellcount" in text or "dof=" in text:
            pytest.skip(f"this MuJoCo has no such flex: {error}")
        raise
    weight = expanded(etree.fromstring(text))
    assert (weight.bodies, weight.dofs, weight.matrix) == (model.nbody - 1, model.nv, model.nM)


def test_what_a_flex_pins_counts_too() -> None:
    flex = '<flexcomp name="f" count="3 3 3" dim="3"><pin gridrange="0 0 0 2 2 0"/></flexcomp>'
    assert expanded(etree.fromstring(f"<body>{flex}</body>")).dofs == 81


@pytest.mark.parametrize(
    ("limit", "inside", "said", "line"),
    [
        ({"bodies": 3}, '<replicate count="4"><body/></replicate>', "`<replicate>` makes 4 bodies; 3 are allowed", 3),
        ({"bodies": 3}, "<body><body/></body><body/><body/>", "the model has 4 bodies; 3 are allowed", 1),
        ({"bodies": 3}, '<body/><replicate count="3"><body/></replicate>', "the model has 4 bodies; 3 are allowed", 3),
        ({"dofs": 5}, "<body>\n<freejoint/></body>", "the model has 6 degrees of freedom; 5 are allowed", 1),
        (
            {"dofs": 5},
            '<body>\n<replicate count="2"><body><joint type="ball"/></body></replicate></body>',
            "`<replicate>` makes 6 degrees of freedom; 5 are allowed",
            4,
        ),
        (
            {"dofs": 80},
            '<body>\n<flexcomp name="f" count="3 3 3"/></body>',
            "`<flexcomp>` makes 81 degrees of freedom; 80 are allowed",
            4,
        ),
        (
            {"mass_matrix": 5},
            "<body><joint/><body><joint/><body><joint/></body></body></body>",
            "the model has 6 numbers in the mass matrix; 5 are allowed",
            1,
        ),
        ({"mass_matrix": 5}, "<body><joint/></body>" * 5, None, 0),
    ],
)
def test_the_size_of_the_whole(limit: dict[str, int], inside: str, said: str | None, line: int) -> None:
    with allow(**limit):
        found = told(inside)
    assert found == ([] if said is None else [("limit-exceeded", said, line)])
    with allow(**{name: value + 1 for name, value in limit.items()}):
        assert told(inside) == []


@pytest.mark.parametrize(
    "inside",
    [
        '<replicate count="2000000000"><geom/></replicate>',
        '<replicate count="2000000000"/>',
        '<replicate count="99999999999999999999999999"><geom/></replicate>',
        '<replicate count="1e300"><geom/></replicate>',
        '<body><composite count="9 9999 1"><geom/></composite></body>',
        '<flexcomp count="2000000000 1 1"/>',
    ],
)
def test_a_huge_expansion_is_told_in_no_time_at_its_place(inside: str) -> None:
    begun = time.monotonic()
    ((code, message, line),) = told(inside)
    assert (code, line) == ("limit-exceeded", 3) and "elements; 20000 are allowed" in message
    assert time.monotonic() - begun < 10


def test_replicates_without_end_in_one_another() -> None:
    inside = '\n<replicate count="9"><body>' * 500 + "<geom/>" + "</body></replicate>" * 500
    ((code, _, line),) = told(inside)
    assert (code, line) == ("limit-exceeded", 3 + 500 - 4)  # the innermost that is too much


def test_the_limit_is_exact_and_can_be_raised() -> None:
    exact = '<replicate count="20001"><geom/></replicate>'  # one of these stands there
    assert told(exact) == []
    ((_, message, _),) = told(exact.replace("20001", "20002"))
    assert message == "`<replicate>` makes 20001 elements; 20000 are allowed"
    with allow(expansion=20001):
        assert told(exact.replace("20001", "20002")) == []


TREES = st.recursive(
    st.sampled_from(["<joint/>", "<freejoint/>", '<joint type="ball"/>', "<geom/>"]),
    lambda inside: st.tuples(st.sampled_from(["body", "frame"]), st.lists(inside, max_size=4)).map(
        lambda each: f"<{each[0]}>{''.join(each[1])}</{each[0]}>"
    ),
    max_leaves=40,
)


@given(st.lists(TREES, max_size=6), st.sampled_from(["", '<default><joint type="ball"/></default>']))
def test_what_is_small_at_a_glance_is_so_when_it_is_counted(trees: list[str], default: str) -> None:
    other = "<body><joint/><joint/></body><tendon><fixed><joint/></fixed></tendon><equality><joint/></equality>"
    root = etree.fromstring(f"<mujoco>{default}<worldbody>{''.join(trees)}</worldbody>{other}</mujoco>")
    whole = expanded(root)
    with allow(dofs=max(whole.dofs - 1, 1), mass_matrix=10**9):
        assert not cost._is_small(root, 1) or whole.dofs == 1
    with allow(dofs=10**9, mass_matrix=max(whole.matrix - 1, 1)):
        assert not cost._is_small(root, 1) or whole.matrix <= 1


def test_many_small_trees_are_small_at_a_glance() -> None:
    bodies = "<body><freejoint/></body>" * 800 + "<frame><body><joint/></body></frame>" * 200
    root = etree.fromstring(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    assert in_force().mass_matrix < 6 * 1000 * 6001 // 2 and cost._is_small(root, 2000)


def test_many_that_are_small() -> None:
    ((code, message, line),) = told('<replicate count="5002"><geom/></replicate>\n' * 4)
    assert (code, line) == ("limit-exceeded", 3)
    assert message == "the model makes 20004 elements of what is written; 20000 are allowed"


def test_elements_that_are_written() -> None:
    with allow(elements=10):
        assert told("<geom/>" * 8) == []
        ((code, message, line),) = told("<geom/>" * 9)
        assert (code, message, line) == ("limit-exceeded", "`m.xml` has 11 elements; 10 are allowed", 1)
        assert told("<!-- <geom/><geom/><geom/> -->" + "<geom/>" * 8) == []


def test_text_that_is_long() -> None:
    with allow(text_size=100):
        assert told(f'<geom name="{"x" * 100}"/>') == []
        for long in (f'<geom name="{"x" * 101}"/>', f"<!--{'x' * 100}-->", "\n" * 101):
            ((code, message, line),) = told(long)
            assert (code, line) == ("limit-exceeded", 2 if long[0] == "\n" else 3) and "100 are allowed" in message


@pytest.mark.parametrize(
    ("attributes", "scales"),
    [
        ("", False),
        ('scale="1 1 1" massscale="0"', False),
        ('scale="2"', True),
        ('scale="1 1 3"', True),
        ('massscale="3"', True),
    ],
)
def test_a_frame_scales_all_that_is_in_it(attributes: str, scales: bool) -> None:
    root = fromstring(f"<worldbody><frame {attributes}><body><site/></body></frame><site/></worldbody>")
    inside, outside = root.iter("site")
    assert (first_scaled(root) is not None) == scales
    assert (scaled_above(inside) is not None) == scales
    assert scaled_above(outside) is None
