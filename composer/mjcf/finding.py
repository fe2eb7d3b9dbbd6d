"""Find elements by tag and name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.mjcf import traversal
from composer.mjcf.arguments import as_name
from composer.mjcf.misspelled import unknown_tag
from composer.mjcf.model import Model, Target
from composer.tree.kinds import Query, kind_of, query, section_of, tags_of
from composer.tree.names import WORLD


def first(here: Target, tag: str, name: str | None) -> Target | None:
    """Return the first match below `here`, or the one with that name. See `Element.find`."""
    from_root = _is_root(here)
    wanted = _query(here, tag, from_root)
    if name is None:
        return next(_matches(here, wanted), None)
    name = as_name("name", name)
    for namespace in wanted.namespaces:
        found = here.model.lookup(namespace, name)
        if found is None:
            continue
        fits = kind_of(found.node).path in wanted.paths or (name == WORLD and namespace == "body")
        if fits and (from_root or traversal.is_below(here, found)):
            return found
    return None


def at_hand(model: Model, tag: str, name: str) -> Any:
    """Return the Element with that name if it is the model's own and was accessed before, which is the common case."""
    wanted = query(tag, None)
    for namespace in wanted.namespaces:
        names = model.names.declared.get(namespace)
        node = None if names is None else names.get(name)
        if node is not None:
            found = model.views.get(node)
            if found is not None and found._kind.path in wanted.paths:
                return found
    return None


def every(here: Target, tag: str, immediate_children_only: bool) -> Iterator[Target]:
    """Yield all matches below `here`. See `Element.find_all`."""
    wanted = _query(here, tag, _is_root(here))
    return traversal.children(*here, wanted) if immediate_children_only else _matches(here, wanted)


def attached(model: Model, prefix: str) -> Model | None:
    """Return the model attached under `prefix`, which ends in the separator, or None. See `Element.enter_scope`."""
    for attachment, rest in model.split(prefix):
        found = attached(attachment.child, rest) if rest else attachment.child
        if found is not None:
            return found
    return None


def _matches(here: Target, wanted: Query) -> Iterator[Target]:
    return traversal.from_root(here.model, wanted) if _is_root(here) else traversal.below(*here, wanted)


def _query(here: Target, tag: str, from_root: bool) -> Query:
    wanted = query(tag, None if from_root else section_of(here.node)) if isinstance(tag, str) else None
    if wanted is None or not (wanted.paths or query(tag, None).paths):
        raise unknown_tag(tag, f"MJCF has no element `{tag}`", tags_of())
    return wanted


def _is_root(here: Target) -> bool:
    return here.node is here.model.unit.root
