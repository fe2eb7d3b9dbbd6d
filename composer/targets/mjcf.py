"""Write a draft as MJCF."""

from __future__ import annotations

from lxml import etree

from composer.targets.draft import Draft
from composer.tree.files import file_attributes
from composer.tree.write import write


def write_mjcf(draft: Draft) -> dict[str, bytes]:
    """Return the text and the files that it names, by path."""
    etree.indent(draft.root)
    named = {name for _, _, name in file_attributes(draft.root)}
    files = {path: content for path, content in draft.files.items() if path in named}
    return {draft.output: write(draft.root), **files}
