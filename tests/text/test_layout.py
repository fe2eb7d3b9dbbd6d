from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from cases import cases
from hypothesis import assume, example, given, settings, strategies as st
from mjcompose.base.report import render
from mjcompose.base.sink import Sink
from mjcompose.text.layout import format_recipe
from mjcompose.text.load import comments, load, tokens
from mjcompose.text.node import Mapping, Sequence, to_python

ROOT = Path(__file__).parents[2]
RECIPES = {
    "/".join(path.parts[-3:]): path.read_bytes()
    for pattern in ("recipes/*.yaml", "tests/golden/*/*.yaml", "tests/errors/*/*/recipe.yaml")
    for path in sorted(ROOT.glob(pattern))
} | {
    f"{case.id}/{name}": text.encode()
    for folder in ("errors", "language/errors")
    for case in cases(ROOT / "tests" / folder)
    for name, text in case.texts.items()
    if name.endswith(".yaml")
}


def formatted(text: str | bytes) -> str:
    """The layout of a text, which is checked to mean the same and to be its own layout."""
    source = text if isinstance(text, bytes) else text.encode()
    sink = Sink()
    result = format_recipe(source, "recipe.yaml", sink)
    assert result is not None, "\n".join(render(each, lambda _: source.decode(), False) for each in sink.diagnostics)
    assert format_recipe(result, "recipe.yaml", Sink()) == result
    return result.decode()


def values(text: str) -> Any:
    sink = Sink()
    node = load(text, "recipe.yaml", sink)
    assert node is not None and not sink.diagnostics
    return to_python(node)


CASES = {
    "order of the language, each key with its comments and its distance": (
        """\
        # yaml-language-server: $schema=recipe.schema.json
        # About the file.
        attach:   # the parts
          arm: {site: a, model: ./arm.xml}

        # why this name
        name: x   # short

        recipe: 1
        """,
        """\
        # yaml-language-server: $schema=recipe.schema.json
        # About the file.
        recipe: 1

        # why this name
        name: x   # short

        attach:   # the parts
          arm: {model: ./arm.xml, site: a}
        """,
    ),
    "a comment about the first key goes with it": (
        "# the file\n\n# the base\nbase: ./a.xml\nrecipe: 1\n",
        "# the file\n\nrecipe: 1\n# the base\nbase: ./a.xml\n",
    ),
    "names keep their order": (
        "attach:\n  b: {model: x}\n  a: {model: y}\nsensor:\n  z: {site: s, type: force}\n  y: {type: force, site: s}\n",
        "attach:\n  b: {model: x}\n  a: {model: y}\nsensor:\n  z: {type: force, site: s}\n  y: {type: force, site: s}\n",
    ),
    "an anchor stays before its aliases": (
        "base: {subtree: &b arm, model: *b}\nrecipe: 1\n",
        "recipe: 1\nbase: {subtree: &b arm, model: *b}\n",
    ),
    "indentation": (
        "add:\n- to: world\n  body:\n      name: a   # here\n      geom:\n      -   type: box\n          size: [1,1,1]\n",
        "add:\n  - to: world\n    body:\n      name: a   # here\n      geom:\n        - type: box\n          size: [1, 1, 1]\n",
    ),
    "spacing": (
        "option : { cone :   elliptic,impratio: 10 , }\nsize:   {}\n",
        "option: {cone: elliptic, impratio: 10}\nsize: {}\n",
    ),
    "quotes": (
        """name: 'a b'\ndescription: 'say "x"'\nbase: "./\\u00e9.xml"\neulerseq: xyz\n""",
        """name: "a b"\ndescription: 'say "x"'\neulerseq: xyz\nbase: "./\\u00e9.xml"\n""",
    ),
    "lines in brackets stay lines": (
        "custom:\n  numeric:\n    m: {data: [1,0,  # first\n      0, 1\n    ]}\n",
        "custom:\n  numeric:\n    m: {\n      data: [\n        1, 0,        # first\n        0, 1]}\n",
    ),
    "comments in brackets": (
        "a: [ # open\n  # own\n  1 # one\n  , 2, # two\n  # end\n  ]\n",
        "a: [  # open\n  # own\n  1,  # one\n  2    # two\n  # end\n  ]\n",
    ),
    "a comment between key and value": (
        "name: # why\n  # really\n  x\nadd:\n  - # first\n    to: world\n    xml: <geom/>\n",
        "name:  # why\n  # really\n  x\nadd:\n  -  # first\n    to: world\n    xml: <geom/>\n",
    ),
    "comments at the end of what they stand in": (
        "attach:\n    a:\n        model: x\n        # in a\n    # in attach\n# of recipe\nrecipe: 1\n# end\n",
        "# of recipe\nrecipe: 1\nattach:\n  a:\n    model: x\n    # in a\n  # in attach\n# end\n",
    ),
    "what is commented out": (
        "a: 1\n# edit:\n  # - b\n  #   c\nd:\n    e: 1\n    # f:\n    #   g\n      # h\n",
        "a: 1\n# edit:\n  # - b\n  #   c\nd:\n  e: 1\n  # f:\n  #   g\n    # h\n",
    ),
    "columns of comments": (
        "recipe: 1     # a\nname: abc     # b\ndescription: very much longer # c\n",
        "recipe: 1     # a\nname: abc     # b\ndescription: very much longer  # c\n",
    ),
    "blank lines": (
        "\n\nrecipe: 1\n\n\n\nname: x\n\nattach:\n\n  a: {model: x}\n\n\n",
        "recipe: 1\n\nname: x\n\nattach:\n\n  a: {model: x}\n",
    ),
    "block scalars": (
        "name: x\nadd:\n- to: world\n  xml: |   # MJCF\n       <geom>\n         <plugin/>\n\n       </geom>\n\n\n- {to: a, site: {}}\n",
        "name: x\nadd:\n  - to: world\n    xml: |  # MJCF\n      <geom>\n        <plugin/>\n\n      </geom>\n\n  - {to: a, site: {}}\n",
    ),
    "block scalars that begin with spaces, and that keep their end": (
        "a:\n    b: |1+\n       x\n      y\n\n\n    c: >-\n      z\n",
        "a:\n  b: |2+\n      x\n     y\n\n\n  c: >-\n    z\n",
    ),
    "an empty line that would belong to a block scalar": ("base: x\n\nrecipe: |+\n  a\n", "recipe: |+\n  a\nbase: x\n"),
    "a block scalar at the end of the file, without a line break": ("a: |\n   x", "a: |-\n  x\n"),
    "long text on several lines": (
        "description: one\n     two\n\n     three\nname: 'it''s\n   \"me\"'\n",
        "name: 'it''s\n  \"me\"'\ndescription: one\n  two\n\n  three\n",
    ),
    "explicit keys and pairs": ("? a\n: 1\nb: [x: 1]\n", "a: 1\nb: [{x: 1}]\n"),
    "no values in brackets": ("a: {b : , c: }\n", "a: {b: , c: }\n"),
    "directives": ("# x\n%YAML 1.2\n---   # y\nname: a\n...\n# z\n", "# x\n%YAML 1.2\n---\n# y\nname: a\n# z\n"),
    "pieces in variants": (
        "variants: {g: {on: {attach: {a: {site: s, model: m}}, base: b}}}\n",
        "variants: {g: {on: {base: b, attach: {a: {model: m, site: s}}}}}\n",
    ),
    "the names of repeated entries": (
        "attach: {'a${i}': {model: m, for: {i: 2}}}\ncheck: {'c${i}': {lint: {}, for: {i: 2}}}\n",
        'attach: {"a${i}": {for: {i: 2}, model: m}}\ncheck: {"c${i}": {for: {i: 2}, lint: {}}}\n',
    ),
    "the names of repeated entries of lists": (
        "edit: [{select: {body: b}, for: {i: 2}}]\ninterface: {key: [{name: '${i}', for: {i: 2}}]}\n",
        'edit: [{for: {i: 2}, select: {body: b}}]\ninterface: {key: [{for: {i: 2}, name: "${i}"}]}\n',
    ),
    "a list of lists": ("a:\n-  - 1\n   - - 2\n# end\n", "a:\n  - - 1\n    - - 2\n# end\n"),
    "the whole in brackets": ("# x\n{name: a,\n recipe: 1} # y\n", "# x\n{\n  recipe: 1,\n  name: a}\n# y\n"),
}


@pytest.mark.parametrize(("text", "expected"), CASES.values(), ids=CASES.keys())
def test_layout(text: str, expected: str) -> None:
    assert formatted(dedent(text)) == dedent(expected)


@pytest.mark.parametrize("source", RECIPES.values(), ids=RECIPES)
def test_of_every_recipe(source: bytes) -> None:
    sink = Sink()
    node = load(source, "recipe.yaml", sink)
    if not isinstance(node, Mapping | Sequence) or sink.diagnostics:
        assert format_recipe(source, "recipe.yaml", Sink()) is None
        return
    formatted(source)


@pytest.mark.parametrize("path", sorted((ROOT / "recipes").glob("*.yaml")), ids=lambda path: path.name)
def test_shipped_recipes_have_the_layout(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert formatted(text) == text


def test_starter_recipe_has_the_layout() -> None:
    from mjcompose.tools.new import starter

    text = starter("model")
    assert formatted(text) == text


def test_line_breaks_and_byte_order_mark() -> None:
    text = 'name: é\r\n# ü\r\ndescription: |\r\n  a\r\n\r\n  b\r\nrecipe: 1\r\nbase: "a\u2028b"\r\n'
    result = formatted(b"\xef\xbb\xbf" + text.encode())
    assert result.startswith("\ufeffrecipe: 1\r\nname: é\r\n# ü\r\n")
    assert result.count("\n") == result.count("\r\n") == 8
    assert values(result) == values(text)


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ('a: 1\n? "x\n  y"\n: 1\n', "cannot-format", 2),
        ("text\n", "cannot-format", 1),
        ("a: [1\n", "yaml-syntax", 1),
        ("a: 1\na: 2\n", "yaml-duplicate-key", 2),
        ("", "yaml-empty", 1),
        (b"a: \xff\n", "yaml-not-utf8", 1),
    ],
)
def test_what_has_no_layout_is_told(text: str | bytes, code: str, line: int) -> None:
    sink = Sink()
    assert format_recipe(text if isinstance(text, bytes) else text.encode(), "r.yaml", sink) is None
    assert sink.diagnostics[0].code == code
    span = sink.diagnostics[0].span
    assert span is not None and span.line == line


# Texts in every layout: a tree of values, written with whatever spacing, style and comments come along.

KEYS = [
    "recipe",
    "name",
    "base",
    "attach",
    "add",
    "edit",
    "sensor",
    "model",
    "site",
    "type",
    "to",
    "when",
    "a",
    "é",
    "x y",
]
SCALARS = [
    "1",
    "1.50",
    "true",
    "~",
    "abc",
    "a b",
    "12:30",
    "-0",
    "'it''s'",
    "'a b'",
    '"a\\tb"',
    '"\\u00e9 \\"q\\""',
    "'#'",
    "**/x",
    "a#b",
    '"${x[0]}"',
    "ünï",
    "!!str 5",
    "",
    "a\n  b",
    '"one\n\n  two \\\n   three"',
    "'x\n y'",
]
BLOCKS = ["|", ">", "|-", "|+", ">+", ">-"]
SAFE_IN_FLOW = [each for each in SCALARS if "**" not in each]


@st.composite
def recipes(draw: st.DrawFn) -> str:
    """A YAML text, mostly well-formed."""
    count = 0
    anchors: list[str] = []

    def noise(indent: int) -> str:
        nonlocal count
        lines = ""
        for kind in draw(st.lists(st.sampled_from(["", "#"]), max_size=2)):
            count += 1
            deep = draw(st.sampled_from([indent, indent, 0, indent + 3]))
            lines += " " * deep + f"# c{count}\n" if kind else draw(st.sampled_from(["\n", "  \n"]))
        return lines

    def behind() -> str:
        nonlocal count
        if draw(st.integers(0, 4)):
            return "\n"
        count += 1
        return draw(st.sampled_from([" ", "     "])) + f"# c{count}\n"

    def anchor() -> str:
        if draw(st.integers(0, 6)):
            return ""
        anchors.append(f"n{len(anchors)}")
        return f"&{anchors[-1]} "

    def scalar(options: list[str]) -> str:
        if anchors and not draw(st.integers(0, 7)):
            return f"*{draw(st.sampled_from(anchors))} "
        return anchor() + draw(st.sampled_from(options))

    def keys(low: int = 1) -> list[str]:
        found = draw(st.lists(st.sampled_from(KEYS), min_size=low, max_size=4, unique=True))
        return [draw(st.sampled_from([key, f'"{key}"', f"'{key}'"])) for key in found]

    def flow(depth: int, indent: int) -> str:
        def gap() -> str:
            kind = draw(st.integers(0, 9))
            if kind == 0:
                return "\n" + " " * (indent + 1)
            return behind() + " " * (indent + 2) if kind == 1 else draw(st.sampled_from(["", " ", "  "]))

        def one() -> str:
            return flow(depth - 1, indent) if depth and draw(st.booleans()) else scalar(SAFE_IN_FLOW)

        mapping = draw(st.booleans())
        if mapping:
            items = [f"{key}: {one()}" for key in keys(0)]
        else:
            items = [one() or "1" for _ in range(draw(st.integers(0, 3)))]
        text = ",".join(f"{gap()}{item}{gap() if not item.endswith('*') else ' '}" for item in items) + gap()
        return anchor() + ("{" + text + "}" if mapping else "[" + text + "]")

    def value(depth: int, indent: int, in_mapping: bool) -> str:
        kind = draw(st.sampled_from(["scalar", "flow", "lines", "mapping", "list"] if depth else ["scalar", "flow"]))
        if kind == "scalar":
            return " " * draw(st.integers(1, 3)) + scalar(SCALARS).replace("\n", "\n" + " " * indent) + behind()
        if kind == "flow":
            return " " + flow(2, indent) + behind()
        if kind == "lines":
            inner = " " * (indent + draw(st.integers(1, 4)))
            lines = draw(st.lists(st.sampled_from(["x", "  y", "", "# no comment", "z: 1 "]), max_size=4))
            body = "".join(f"{inner}{line}\n" if line else "\n" for line in ["first", *lines])
            return f" {draw(st.sampled_from(BLOCKS))}" + behind() + body
        deeper = indent + draw(st.integers(1, 4))
        if kind == "list" and in_mapping and draw(st.booleans()):
            deeper = indent
        return f" {anchor()}".rstrip() + behind() + block(kind == "mapping", depth - 1, deeper)

    def block(mapping: bool, depth: int, indent: int) -> str:
        margin = " " * indent
        if mapping:
            return "".join(f"{noise(indent)}{margin}{key}:{value(depth, indent, True)}" for key in keys())
        count = draw(st.integers(1, 3))
        return "".join(f"{noise(indent)}{margin}-{value(depth, indent, False)}" for _ in range(count))

    text = block(True, 3, 0) + noise(0)
    if draw(st.booleans()):
        text = text.rstrip("\n")
    return text.replace("\n", draw(st.sampled_from(["\n", "\n", "\r\n", "\r"])))


@settings(max_examples=300, deadline=None)
@given(recipes())
@example("attach: &a\n  - {edit: 1, model: 1}\nrecipe: *a\n")  # what stands twice, once where the order counts
def test_nothing_is_lost(text: str) -> None:
    sink = Sink()
    node = load(text, "recipe.yaml", sink)
    assume(node is not None and not sink.diagnostics)
    result = formatted(text)
    assert values(result) == values(text)
    assert sorted(comments(tokens(result))) == sorted(comments(tokens(text)))
    assert "\r\n" in text or "\r" not in result


@settings(max_examples=300, deadline=None)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
        max_leaves=20,
    ),
    st.sampled_from([None, 1, 4]),
)
def test_json_is_a_recipe_too(value: Any, indent: int | None) -> None:
    text = json.dumps({"name": value}, ensure_ascii=False, indent=indent)
    sink = Sink()
    assume(load(text, "recipe.yaml", sink) is not None and not sink.diagnostics)
    assert values(formatted(text)) == values(text)
