from __future__ import annotations

import pytest
from mjcompose.base.sink import Sink
from mjcompose.build.plan.parts import in_order
from mjcompose.language.validate import validate
from mjcompose.text.load import load
from mjcompose.text.node import Mapping


def ordered(parts: str) -> tuple[str, Sink]:
    """The order of the parts in `a, b before c`, by the first letters of their keys."""
    sink = Sink()
    lines = ["recipe: 1", "attach:"]
    for part in parts.split(", "):
        key, *moves = part.split()
        asked = "".join(f", {word}: {other}" for word, other in zip(moves[::2], moves[1::2], strict=True))
        lines.append(f"  {key}: {{model: ./m.xml{asked}}}")
    document = load("\n".join(lines), "recipe.yaml", sink)
    assert isinstance(document, Mapping)
    recipe = validate(document, sink)
    assert recipe is not None
    return "".join(in_order(recipe.attach, document, sink)), sink


@pytest.mark.parametrize(
    ("parts", "order"),
    [
        ("a, b, c", "abc"),
        ("a, b, c before a", "cab"),
        ("a after c, b, c", "bca"),
        ("a, b before d, c before d, d", "abcd"),
        ("x, a after x, b after x, y", "xaby"),
        ("x, a after x, b after x, c after a", "xacb"),
        ("a after b, b after c, c", "cba"),
        ("a, b, c after a before b", "acb"),
    ],
)
def test_order(parts: str, order: str) -> None:
    found, sink = ordered(parts)
    assert found == order
    assert not sink.diagnostics


@pytest.mark.parametrize(
    ("parts", "code", "words"),
    [
        ("a before a", "part-order", "in a ring: `a` before `a`"),
        ("a after b, b after c, c after a", "part-order", "`a` after `b`, `b` after `c`, `c` after `a`"),
        ("a before b, b before c, c after b", "part-order", "`b` before `c`, `c` after `b`"),
        ("a, b, c after b before a", "part-order", "`c` shall stand after `b` and before `a`, which"),
        ("a, table, b after tabel", "unknown-name", "the part `tabel` for `b` to stand after does not exist"),
        ("a before base", "unknown-name", "the part `base` for `a` to stand before does not exist"),
    ],
)
def test_what_cannot_be(parts: str, code: str, words: str) -> None:
    found, sink = ordered(parts)
    (fault,) = sink.diagnostics
    assert fault.code == code
    assert words in fault.message
    assert fault.help is not None or "base" not in parts
    assert len(found) == len("".join(part.split()[0] for part in parts.split(", ")))
