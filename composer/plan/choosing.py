"""Whether the values of parameters choose which models a recipe is made of."""

from __future__ import annotations

from composer.document.node import Mapping, Node, Scalar, Sequence

_OF_MODELS = ("base", "model", "with")
_OF_PIECES = ("variants", "matrix")


def parameters_choose(recipe: Node | None) -> bool:
    """Whether another value of a parameter may give other models: by `when`, or an expression that names them.

    No I/O.
    """
    waiting = [(recipe, False)]
    while waiting:
        node, naming = waiting.pop()
        if isinstance(node, Scalar):
            if naming and "${" in node.text:
                return True
        elif isinstance(node, Sequence):
            waiting += [(each, naming) for each in node.items]
        elif isinstance(node, Mapping):
            if "when" in node.entries:
                return True
            waiting += [(value, naming or name in _OF_MODELS) for name, (_, value) in node.entries.items()]
    return False


def is_one_choice(recipe: Node | None) -> bool:
    """Whether a recipe is made of the same models however it is built. No I/O."""
    pieces = isinstance(recipe, Mapping) and any(name in recipe.entries for name in _OF_PIECES)
    return not pieces and not parameters_choose(recipe)
