from __future__ import annotations

import pytest
from mjcompose.base.diagnostic import Fault
from mjcompose.language.fragment import check_fragment, report_clashing
from mjcompose.tree.grammar import GRAMMAR, Constraint


def check(text: str, bare_angles: bool = True, named: bool = False) -> tuple[object, list[Fault]]:
    faults: list[Fault] = []
    kinds = {**GRAMMAR.element("body").children, **GRAMMAR.section("sensor").children}
    return check_fragment(text, kinds, "`add`", ("xml",), bare_angles, faults, named), faults


def test_kept() -> None:
    text = '\n<!-- a body -->\n<body name="b"><geom size="1"/>\n  <body/></body>\n'
    assert check(text) == (("body", {"name": "b"}), [])


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("<geom", "xml-syntax", "not well-formed XML"),
        ("", "xml-syntax", "not well-formed XML: no element found"),
        ("<geom/>\n<geom/>", "wrong-length", "a fragment is a single element"),
        ("<!DOCTYPE a []><geom/>", "xml-syntax", "a fragment has no `<!DOCTYPE>`"),
        ("<body>\n text</body>", "xml-syntax", "text in `body`"),
        ("<gem/>", "unknown-element", "`gem` is not allowed in `add`"),
        ("<body>\n<clock/>\n</body>", "unknown-element", "`clock` is not allowed in `body`"),
        ("<geom sizes='1'/>", "unknown-attribute", "`sizes` is not an attribute of `geom`"),
        ("<geom size='a'/>", "wrong-type", "`size` of `geom` expects 1 to 3 numbers, got `a`"),
        ("<geom type='cube'/>", "wrong-keyword", "`type` of `geom` expects"),
        ("<inertial pos='0 0 0'/>", "missing-key", "`inertial` lacks `mass`"),
        ("<site quat='1 0 0 0' euler='0 0 0'/>", "wrong-type", "has both `quat` and `euler`"),
    ],
)
def test_refused(text: str, code: str, message: str) -> None:
    result, (fault,) = check(text)
    assert result is None
    assert fault.code == code
    assert message in fault.message
    assert fault.at == ("xml",)


def test_where() -> None:
    """Line, column and width of the element, or of where the reader stopped."""
    _, (fault,) = check("<body>\n  <clock/>\n</body>")
    assert fault.within == (2, 4, 5)
    _, (fault,) = check("<body>\n  <geom>\n</body>")
    assert fault.within == (3, 3, 1) and fault.help is not None


def test_what_is_in_an_unknown_element_is_not_told() -> None:
    _, faults = check("<group><geom foo='1'/><bar/></group>")
    assert [fault.code for fault in faults] == ["unknown-element"]


def test_bare_angles() -> None:
    text = "<body euler='0 90 0'><joint type='hinge' range='0 1'/><joint range='0 1'/></body>"
    assert check(text)[1] == []
    assert [fault.code for fault in check(text, bare_angles=False)[1]] == ["bare-angle", "bare-angle"]


def test_name_from_the_key_is_not_missed() -> None:
    text = "<flexcomp type='grid'/>"
    assert [fault.code for fault in check(text)[1]] == ["missing-key"]
    assert check(text, named=True)[1] == []


def test_entities_do_not_expand() -> None:
    bomb = '<!DOCTYPE a [<!ENTITY x "' + "y" * 1000 + '">]><geom name="' + "&x;" * 1000 + '"/>'
    assert check(bomb)[0] is None


def told(kind: str, bundles: str, present: str) -> list[Fault]:
    faults: list[Fault] = []
    rule = Constraint(kind, tuple(tuple(bundle.split("+")) for bundle in bundles.split()))  # type: ignore[arg-type]
    report_clashing([rule], present.split(), "`e`", (), faults)
    return faults


@pytest.mark.parametrize(
    ("kind", "bundles", "present"),
    [
        ("exclusive", "a b c", "b"),
        ("exclusive", "a+b c+d", "a b"),
        ("oneof", "a+b c", "c"),
        ("oneof", "a+b c", "a b"),
        ("together", "a b", ""),
        ("together", "a b", "b a"),
        ("requires", "a b+c", "b"),
        ("requires", "a b+c", "a b c"),
    ],
)
def test_kept_presence(kind: str, bundles: str, present: str) -> None:
    assert told(kind, bundles, present) == []


@pytest.mark.parametrize(
    ("kind", "bundles", "present", "code", "at"),
    [
        ("exclusive", "a b c", "c a", "wrong-type", ("a",)),
        ("exclusive", "a+b c+d", "b d a", "wrong-type", ("a",)),
        ("oneof", "a+b c", "a", "missing-key", ()),
        ("together", "a b", "b", "missing-key", ("b",)),
        ("requires", "a b+c", "a c", "missing-key", ("a",)),
    ],
)
def test_broken(kind: str, bundles: str, present: str, code: str, at: tuple[str, ...]) -> None:
    (fault,) = told(kind, bundles, present)
    assert (fault.code, fault.at) == (code, at)


def test_the_first_of_two_is_shown_too() -> None:
    (fault,) = told("exclusive", "a b", "b a")
    assert fault.related[0][1] == ("b",)
