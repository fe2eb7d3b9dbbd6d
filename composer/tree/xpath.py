"""Evaluate an XPath of a recipe in limited time.

An XPath may take time exponential in its steps, and libxml2 cannot be interrupted. Anything more than a path with
simple conditions runs in a process of its own, with the same time limit as a regular expression.
"""

from __future__ import annotations

import re
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.grammar.characters import NOT_XML, code_point
from composer.tree.pattern import SECONDS, TooSlow, asked_aside, length_fault

_TAG = r"(?:[A-Za-z][\w.-]*|\*)"
_CONDITION = r"""\[\s*(?:\d+|last\(\)|(?:not\()?@[\w.-]+\)?|@[\w.-]+\s*!?=\s*(?:'[^']*'|"[^"]*"))\s*\]"""
_STEP = rf"{_TAG}(?:{_CONDITION})*"
_PLAIN = re.compile(rf"(?:\.?//?)?(?:{_STEP}/)*(?:{_STEP}//)?(?:{_STEP}/)*{_STEP}")
_UNITED = 10
_CHILD = """
import json, sys
path, pattern, text = json.load(sys.stdin)
sys.path[:] = path
from lxml import etree
root = etree.fromstring(text, etree.XMLParser(huge_tree=True, resolve_entities=False))
try:
    found = root.xpath(pattern)
except etree.XPathError as error:
    answer = str(error).lower()
else:
    numbers = {node: number for number, node in enumerate(root.iter())}
    is_nodes = isinstance(found, list) and all(isinstance(each, etree._Element) for each in found)
    answer = [numbers[each] for each in found] if is_nodes else None
json.dump(answer, sys.stdout)
"""


class BadXPath(Exception):
    """An XPath that is invalid, that does not select elements, or (`is_slow`) that takes too long."""

    def __init__(self, message: str, *, is_slow: bool = False) -> None:
        super().__init__(message)
        self.is_slow = is_slow


def is_plain(xpath: str) -> bool:
    """Return whether it is a path with simple conditions, which visits each element of a model at most once.

    >>> is_plain("worldbody//geom[@type='mesh'][1]"), is_plain("//*[count(//*) > 1]"), is_plain("//body//body")
    (True, False, False)
    """
    each = xpath.split("|")
    return len(each) <= _UNITED and all(
        path.count("//") <= 1 and _PLAIN.fullmatch(path.strip()) is not None for path in each
    )


def nodes_at(root: Node, xpath: str) -> list[Node]:
    """Return the elements that an XPath selects from the top of a tree, without the top itself. Raises `BadXPath`."""
    if (wrong := length_fault(xpath)) is not None:
        raise BadXPath(wrong)
    if odd := NOT_XML.search(xpath):
        raise BadXPath(f"it has the character {code_point(odd.group())}, which XML cannot hold")
    found = _here(root, xpath) if is_plain(xpath) else _aside(root, xpath)
    if not isinstance(found, list) or not all(
        isinstance(each, etree._Element) and isinstance(each.tag, str) for each in found
    ):
        raise BadXPath("it gives no elements")
    return [each for each in found if each is not root]


def _here(root: Node, xpath: str) -> Any:
    try:
        return root.xpath(xpath)
    except etree.XPathError as error:
        raise BadXPath(str(error).lower()) from None


def _aside(root: Node, xpath: str) -> Any:
    import sys

    text = etree.tostring(root, encoding="unicode")
    try:
        answer = asked_aside(_CHILD, [sys.path, xpath, text])
    except TooSlow:
        raise BadXPath(f"it takes longer than {SECONDS:g} seconds", is_slow=True) from None
    if isinstance(answer, str):
        raise BadXPath(answer)
    if answer is None:
        return None
    nodes = list(root.iter())
    return [nodes[number] for number in answer]
