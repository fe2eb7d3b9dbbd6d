"""MJCF as data: `from composer.grammar import GRAMMAR`."""

from composer.grammar.attribute import Attribute
from composer.grammar.element import Constraint, ElementType
from composer.grammar.grammar import GRAMMAR, Grammar

__all__ = ["GRAMMAR", "Attribute", "Constraint", "ElementType", "Grammar"]
