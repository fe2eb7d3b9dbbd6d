"""The keywords of a version of MuJoCo, by which tests hold the grammar against it."""

from __future__ import annotations

from mjcompose.tree.grammar import Attribute, exists_in


def keywords_in(attribute: Attribute, version: str) -> tuple[str, ...]:
    """The keywords that this MuJoCo accepts."""
    versions = attribute.keyword_versions
    return tuple(word for word in attribute.keywords if exists_in(version, *versions.get(word, (None, None))))
