"""`<![CDATA[…]]>` in a model: how MuJoCo saves a `<text>` that has quotes in it."""

from __future__ import annotations

import re

from lxml import etree
from lxml.etree import _Element as Node

_FIRST = re.compile(r"<!\[CDATA\[(.*?)\]\]>", re.DOTALL)


def take_cdata_in(root: Node, data: bytes) -> None:
    """Give every `<text>` that has a section and no `data` the one for the other: attributes are what is worked on.

    The parsed tree does not distinguish sections from plain text, which means nothing to MuJoCo: `data` is asked again.
    """
    parser = etree.XMLParser(
        remove_blank_text=True, resolve_entities=False, no_network=True, huge_tree=True, strip_cdata=False,
        recover=True,
    )  # fmt: skip
    texts = etree.fromstring(data, parser).iter("text")
    for node, asked in zip(root.iter("text"), texts, strict=False):
        found = _FIRST.search(etree.tostring(asked, encoding="unicode", with_tail=False))
        if found is not None and node.get("data") is None:
            node.set("data", found.group(1))
            node.text = None
