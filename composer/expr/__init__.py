"""Numeric expressions, `${…}` in a recipe: total, bounded, and with no way out of arithmetic."""

from composer.expr.error import ExpressionError
from composer.expr.template import Template, is_template
from composer.expr.value import Value, shown

__all__ = ["ExpressionError", "Template", "Value", "is_template", "shown"]
