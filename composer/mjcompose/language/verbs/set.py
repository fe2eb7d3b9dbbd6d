"""Verb `set`: give attributes new values."""

from __future__ import annotations

from mjcompose.language.verbs.values import assigning

VERB = assigning(
    "set", "=", "attributes and their new values, `friction[0]` for one number", values="settable"
)
