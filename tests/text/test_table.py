from __future__ import annotations

import csv
import io
import random
from typing import Any

import pytest
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.text.node import locate, to_python
from mjcompose.text.table import load_table


def read(text: str | bytes) -> tuple[Any, list[str]]:
    sink = Sink()
    data = text.encode() if isinstance(text, str) else text
    node = load_table(data, "gains.csv", sink)
    return None if node is None else to_python(node), [
        f"{each.span}: {each.code}: {each.message}" for each in sink.errors
    ]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_values_have_the_types_of_yaml(delimiter: str, end: str) -> None:
    rows = [
        ["joint", "kp", "name", "on", "range", "tilt"],
        ["hip", "20", "left hip", "true", '"[-1, 1]"', "30deg"],
        ["knee", "1e-3", '"a ""b"""', "false", '"[0, 0.5]"', "-5deg"],
        ["", "", "", "", "", ""],
        ["foot", "", "~", "", "", ""],
    ]
    text = end.join(delimiter.join(row) for row in rows) + end
    assert read(text) == (
        {
            "hip": {"kp": 20, "name": "left hip", "on": True, "range": [-1, 1], "tilt": "30deg"},
            "knee": {"kp": 0.001, "name": 'a "b"', "on": False, "range": [0, 0.5], "tilt": "-5deg"},
            "foot": {},
        },
        [],
    )


def test_spaces_marks_and_empty_columns_at_the_end_do_not_matter() -> None:
    assert read(b'\xef\xbb\xbfjoint , kp,,\n hip, 2 ,,\n knee,"3" ,,') == ({"hip": {"kp": 2}, "knee": {"kp": 3}}, [])


@pytest.mark.parametrize("start", ["", "\n", "\r\n \n"])
@pytest.mark.parametrize("column", ["mass (kg, measured)", "two\nlines, and more"])
def test_the_delimiter_is_that_of_the_first_line_with_content(start: str, column: str) -> None:
    assert read(f'{start}part;"{column}";kp\nhip;2;3\n') == ({"hip": {column: 2, "kp": 3}}, [])


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_the_column_of_names_needs_no_name(delimiter: str) -> None:
    assert read(f"{delimiter}kp\nhip{delimiter}2\n") == ({"hip": {"kp": 2}}, [])


@pytest.mark.parametrize("text", ["0042", "007", "-01", '"0042"'])
def test_zeros_in_front_of_a_number_are_kept(text: str) -> None:
    assert read(f"arm,serial\nleft,{text}\n") == ({"left": {"serial": text.strip('"')}}, [])


@pytest.mark.parametrize(("text", "number"), [("0", 0), ("-0", 0), ("0.5", 0.5), ("0x10", 16), ("100", 100)])
def test_other_numbers_stay_numbers(text: str, number: float) -> None:
    assert read(f"arm,kp\nleft,{text}\n") == ({"left": {"kp": number}}, [])


def test_every_value_has_its_place() -> None:
    node = load_table(b'joint,about,kp\nhip,"two\nlines",7\nknee,x,  "8" \n', "gains.csv", Sink())
    assert node is not None
    places = {path: locate(node, path) for path in (("hip", "about"), ("hip", "kp"), ("knee", "kp"))}
    assert [(each.line, each.column, each.end_column) for each in places.values()] == [
        (2, 5, 6),
        (3, 8, 9),
        (4, 10, 13),
    ]
    assert str(locate(node, ("knee", "kp"), key=True)) == "gains.csv:1:13"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "gains.csv:1:1: csv-syntax: `gains.csv` has no rows"),
        ("\n\n", "gains.csv:1:1: csv-syntax: `gains.csv` has no rows"),
        ("a,b\nx,1,2\n", "gains.csv:2:5: csv-syntax: row `x` has more values than there are columns"),
        ("a,b\n,1\n", "gains.csv:2:1: csv-syntax: this row has no name"),
        ("a,,c\nx,1,2\n", "gains.csv:1:3: csv-syntax: this column has no name"),
        ("a,b,b\nx,1,2\n", "gains.csv:1:5: yaml-duplicate-key: `b` names two columns"),
        ("a,b\nx,1\nx,2\n", "gains.csv:3:1: yaml-duplicate-key: `x` names two rows"),
        ('a,b\nx,"1\n', "gains.csv:2:3: csv-syntax: a quote has no end, or text follows it"),
        ('a,b\nx,"1" 2\n', "gains.csv:2:3: csv-syntax: a quote has no end, or text follows it"),
        ("a,b\nx,1e999\n", "gains.csv:2:3: out-of-range: `1e999` is too large for a number"),
        ("a,b\nx,\x01\n", "gains.csv:2:3: yaml-syntax: YAML cannot contain the character U+0001"),
    ],
)
def test_faults(text: str, message: str) -> None:
    assert read(text) == (None, [message])


def test_the_values_are_limited() -> None:
    with allow(yaml_values=5):
        assert read("a,b\nx,1\ny,2\n") == (None, ["gains.csv:1:1: yaml-too-large: `gains.csv` has more than 5 values"])


def test_texts_are_those_of_the_standard_library() -> None:
    draw = random.Random(3)
    for _ in range(300):
        texts = ["".join(draw.choices('ab",;\n', k=draw.randrange(5))) for _ in range(6)]
        stream = io.StringIO()
        rows = [["n", "a", "b"], ["x", *texts[:2]], ["y", *texts[2:4]]]
        csv.writer(stream, lineterminator=draw.choice(["\n", "\r\n"])).writerows(rows)
        found, faults = read(stream.getvalue())
        assert not faults
        assert found == {
            row[0]: {name: each for name, each in zip("ab", row[1:], strict=True) if each} for row in rows[1:]
        }
