"""Colours for terminal output."""

from __future__ import annotations

_COLOR = {
    "error": "\x1b[1;31m",
    "warning": "\x1b[1;33m",
    "note": "\x1b[1;36m",
    "cell": "\x1b[1;36m",
    "cells": "\x1b[1;36m",
    "help": "\x1b[1;32m",
    "bold": "\x1b[1m",
    "gutter": "\x1b[34m",
    "code": "\x1b[36m",
    "dim": "\x1b[2m",
    "added": "\x1b[32m",
    "removed": "\x1b[31m",
}


class Paint:
    """Wraps text in a colour if enabled. The styles are the keys of `_COLOR`."""

    def __init__(self, enabled: bool) -> None:
        self._enabled = enabled

    def __call__(self, style: str, text: str) -> str:
        return f"{_COLOR[style]}{text}\x1b[0m" if self._enabled else text
