from __future__ import annotations

import pytest

from composer.mujoco_errors.message import Fault, parse


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (
            "Error: size 0 must be positive in geom\nElement name 'left/X', id 0, line 38",
            Fault("size 0 must be positive in geom", 38, None, None, "left/X"),
        ),
        (
            "XML Error: Schema violation: unrecognized attribute: 'foo'\nElement 'geom', line 3, column 7\n",
            Fault("Schema violation: unrecognized attribute: 'foo'", 3, 7, "geom"),
        ),
        (
            "XML Error: Error: repeated name 'a' in body\nElement 'body', line 1\n",
            Fault("repeated name 'a' in body", 1, None, "body"),
        ),
        (
            "XML Error: Error: GMSH decoder: no\nElement name '', id -1\nElement 'flexcomp', line 3\n",
            Fault("GMSH decoder: no", 3, None, "flexcomp"),
        ),
        ("Error: Error opening file 'nope.stl'", Fault("Error opening file 'nope.stl'")),
        ("ParseXML: empty file 'model.xml'", Fault("empty file 'model.xml'")),
        ("Error: free joint\nElement name '', id 2, line -1", Fault("free joint")),
        (
            "Error: x\nElement name 'it's, id 4, line 5', id 2, line 7",
            Fault("x", 7, name="it's, id 4, line 5"),
        ),
        ("Error: x\nElement name 'a\nb', id 2", Fault("x", name="a\nb")),
        (
            "timestep: parent has 1\nintegrator: parent has 2",
            Fault("timestep: parent has 1\nintegrator: parent has 2"),
        ),
        (
            "XML parse error 6:\nError=XML_ERROR_PARSING_ELEMENT ID=6 Line number=4: XMLElement name=geom\n",
            Fault("not well-formed XML: parsing element", 4, element="geom"),
        ),
        (
            "XML parse error 14:\nError=XML_ERROR_MISMATCHED_ELEMENT ID=14 Line number=2: odd  it\n",
            Fault("not well-formed XML: mismatched element: odd it", 2),
        ),
        ("", Fault("")),
    ],
)
def test_a_message_is_taken_apart(text: str, fault: Fault) -> None:
    assert parse(text) == fault
