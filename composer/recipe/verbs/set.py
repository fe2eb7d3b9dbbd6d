"""Verb `set`: give attributes new values."""

from __future__ import annotations

from composer.recipe.verbs.assigning import assigning

VERB = assigning(
    "set", "=", "attributes and their new values, `friction[0]` for one number", values="settable"
)
