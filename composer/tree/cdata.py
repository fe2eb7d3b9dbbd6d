"""`<![CDATA[…]]>` in a model: MuJoCo saves a `<text>` with quotes in this form."""

from __future__ import annotations

import re

from lxml import etree
from lxml.etree import _Element as Node

_FIRST = re.compile(r"<!\[CDATA\[(.*?)\]\]>", re.DOTALL)


def take_cdata_in(root: Node, data: bytes) -> None:
    """Move the CDATA section of every `<text>` without `data` into this attribute, for the later stages.

    The parsed tree does not distinguish sections from plain text, which MuJoCo ignores, so `data` is parsed again.
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
