from __future__ import annotations

import pytest

from composer.diagnostics import Sink, Span
from composer.document import Mapping, Node, Scalar, Sequence, load, locate, to_python

TEXT = """\
sensor:
  imu: {type: force, site: tip}
  type: {site: a, objtype: b}
add:
  - to: world
    body:
      pos: [0, 1]
"""


@pytest.fixture
def tree() -> Node:
    found = load(TEXT, "r.yaml", Sink())
    assert found is not None
    return found


def written(span: Span) -> str:
    return TEXT.splitlines()[span.line - 1][span.column - 1 : (span.end_column or 0) - 1]


@pytest.mark.parametrize(
    ("path", "value", "key"),
    [
        (("sensor", "imu", "site"), "tip", "site"),
        (("sensor", "imu"), "{type: force, site: tip}", "imu"),
        (("add", 0, "body", "pos", 1), "1", "1"),
        (("add", 0, "to"), "world", "to"),
        # Names of alternatives are left out.
        (("sensor", "imu", "force", "site"), "tip", "site"),
        (("function-wrap[x]", "sensor", "dict[str,union]", "imu", "force", "site", "str"), "tip", "site"),
        (("add", 0, "body", "tuple", "pos", "list[int]", 0), "0", "0"),
        # What is missing is looked for as far as it goes.
        (("sensor", "imu", "objtype"), "{type: force, site: tip}", "imu"),
        (("sensor", "gyro"), "imu: {type: force, site: tip}", "sensor"),
        (("add", 7), "- to: world", "add"),
        (("add", -1), "- to: world", "add"),
        (("sensor", 0), "imu: {type: force, site: tip}", "sensor"),
        # The name of an alternative that is a key as well.
        (("sensor", "imu", "type", "site"), "tip", "site"),
    ],
)
def test_locate(tree: Node, path: tuple[str | int, ...], value: str, key: str) -> None:
    assert written(locate(tree, path)) == value
    assert written(locate(tree, path, key=True)) == key


def test_locate_nothing_is_the_root(tree: Node) -> None:
    assert locate(tree, ()) == tree.span
    assert locate(tree, ("nothing", 3)) == tree.span
    assert locate(tree, (), key=True) == tree.span


def test_a_validators_mark_for_keys(tree: Node) -> None:
    assert written(locate(tree, ("sensor", "imu", "[key]"))) == "imu"


def test_to_python(tree: Node) -> None:
    assert to_python(tree) == {
        "sensor": {"imu": {"type": "force", "site": "tip"}, "type": {"site": "a", "objtype": "b"}},
        "add": [{"to": "world", "body": {"pos": [0, 1]}}],
    }


def test_nodes_are_frozen_and_keys_keep_their_order(tree: Node) -> None:
    assert isinstance(tree, Mapping)
    assert list(tree.entries) == ["sensor", "add"]
    added = tree.entries["add"][1]
    assert isinstance(added, Sequence)
    assert isinstance(added.items, tuple)
    with pytest.raises(AttributeError):
        added.items = ()  # type: ignore[misc]
    assert Scalar(1, tree.span, "1", True) == Scalar(1, tree.span, "1", True)
