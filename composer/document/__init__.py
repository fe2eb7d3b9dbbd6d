"""YAML as a located tree: every key and every value knows its file, line and column."""

from __future__ import annotations

from composer.document.load import load
from composer.document.node import Key, Mapping, Node, Scalar, Sequence, locate, to_python

__all__ = ["Key", "Mapping", "Node", "Scalar", "Sequence", "load", "locate", "to_python"]
