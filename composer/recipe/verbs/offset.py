"""Verb `offset`: add to numbers."""

from __future__ import annotations

from composer.recipe.verbs.assigning import assigning

VERB = assigning("offset", "+", "attributes and what is added to them", values="scalable")
