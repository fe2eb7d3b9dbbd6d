"""Verb `scale`: multiply numbers."""

from __future__ import annotations

from mjcompose.language.verbs.values import assigning

VERB = assigning("scale", "×", "attributes and what they are multiplied with", values="scalable")
