"""Verb `offset`: add to numbers."""

from __future__ import annotations

from mjcompose.language.verbs.values import assigning

VERB = assigning("offset", "+", "attributes and what is added to them", values="scalable")
