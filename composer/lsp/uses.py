"""All names in a recipe, with their places."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Scalar, Sequence, to_python
from composer.lsp.cursor import Path
from composer.lsp.language import Form, forms_at, forms_below
from composer.lsp.places import Wanted, wanted_key, wanted_value


@dataclass(frozen=True, slots=True)
class Use:
    """A name in a recipe, as a value or a key, and the names that are allowed there."""

    text: str
    span: Span
    path: Path
    wanted: Wanted
    is_key: bool = False


def uses_in(tree: Node | None) -> Iterator[Use]:
    """Yield the names in a recipe, in the order of the text."""
    if isinstance(tree, Mapping):
        data = to_python(tree)
        yield from _walk(tree, data, (), forms_at((), data), [], None)


def _walk(
    node: Node, data: Any, path: Path, forms: list[Form], above: list[Form], around: Any
) -> Iterator[Use]:
    if isinstance(node, Scalar):
        wanted = wanted_value(path, above, around) if path and isinstance(node.value, str) else None
        if wanted is not None:
            yield Use(node.text, node.span, path, wanted)
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            inner = data[index]
            below = forms_below(forms, index, inner)
            yield from _walk(item, inner, (*path, index), below, [*forms, *above], around)
    else:
        wanted = wanted_key(path)
        for name, (key, value) in node.entries.items():
            if wanted is not None:
                yield Use(name, key.span, (*path, name), wanted, True)
            inner = data[name]
            yield from _walk(value, inner, (*path, name), forms_below(forms, name, inner), forms, data)


def scalars(node: Node | None, path: Path = ()) -> Iterator[tuple[Path, Scalar]]:
    """Yield every value of a tree with its path."""
    if isinstance(node, Scalar):
        yield path, node
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield from scalars(item, (*path, index))
    elif node is not None:
        for name, (_, value) in node.entries.items():
            yield from scalars(value, (*path, name))
