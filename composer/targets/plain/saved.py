"""The text of a model as MuJoCo saves it: compiled values, with all copies written out."""

from __future__ import annotations

import re
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.engine.digits import save_all_digits
from composer.grammar.format import number_text
from composer.grammar.number import items, parse_real
from composer.tree.kinds import kind_of

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


def saved(mujoco: Any, spec: Any) -> Node:
    """Return the tree that MuJoCo saves for a compiled spec. Angles are in radians."""
    compiler = spec.compiler
    for setting in ("savecompiled", "savecanonical"):
        if hasattr(compiler, setting):
            setattr(compiler, setting, True)
    save_all_digits(mujoco)
    # A comment may contain `--`, which MuJoCo reads and writes although XML does not allow it.
    root = etree.fromstring(_COMMENT.sub("", spec.to_xml()))
    for text in root.iterfind("custom/text"):
        if text.text and text.get("data") is None:  # MuJoCo saves what has to be escaped as CDATA
            text.set("data", str(text.text))
            text.text = None
    for element in root.iter("*"):
        kind = kind_of(element)
        for name, value in element.items():
            attribute = kind.attributes.get(str(name))
            if attribute is not None and attribute.is_number:
                element.set(str(name), _short(str(value)))
    return root


def _short(value: str) -> str:
    """Return the same numbers with the fewest digits: MuJoCo writes 0.1 as 0.10000000000000001."""
    found = [parse_real(each) for each in items(value)]
    return value if None in found else " ".join(number_text(each) for each in found if each is not None)
