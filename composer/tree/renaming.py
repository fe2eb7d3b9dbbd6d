"""Rename elements, and update every reference: in the model, and in the models that it is attached to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import field
from typing import Generic, NamedTuple

from composer.dataclass import dataclass
from composer.tree.editable import M, Reference, uses_of
from composer.tree.kinds import section_of
from composer.tree.name_index import is_list


class NewName(NamedTuple, Generic[M]):
    """A name of a model, by namespace, and its new name."""

    model: M
    namespace: str
    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Renaming(Generic[M]):
    """Old and new texts of references to renamed elements, by model and namespace.

    It is created before the first name changes, and applied after all have changed, so that two names can be
    swapped.
    """

    followed: dict[tuple[M, str], dict[str, str]] = field(default_factory=dict)

    @classmethod
    def of(cls, names: Iterable[NewName[M]]) -> Renaming[M]:
        """Return the references to these names, including those to what MuJoCo makes of it."""
        renaming: Renaming[M] = cls()
        for model, namespace, old, new in names:
            for here, prefix, kind, used in uses_of(model, namespace, old):
                meant = prefix + new + used[len(prefix) + len(old) :]
                renaming.followed.setdefault((here, kind), {})[used] = meant
        return renaming

    @classmethod
    def of_prefix(cls, model: M, old: str, new: str) -> Renaming[M]:
        """Return the references to everything with a prefix in a model that is not its own."""
        renaming: Renaming[M] = cls()
        for here, prefix in model.levels():
            for namespace, uses in here.names.uses.items():
                own = here.names.declared.get(namespace, {})
                for used in uses:
                    if used.startswith(prefix + old) and used not in own:
                        meant = prefix + new + used[len(prefix) + len(old) :]
                        renaming.followed.setdefault((here, namespace), {})[used] = meant
        return renaming

    def unlistable(self) -> Iterator[tuple[Reference[M], str]]:
        """Yield references in lists of names whose new name has a space, which a list cannot hold."""
        for (model, namespace), names in self.followed.items():
            for old, new in names.items():
                if len(new.split()) == 1:
                    continue
                for node, attribute in model.names.users(namespace, old):
                    if is_list(node, attribute, section_of(node)):
                        yield Reference(model, node, attribute, namespace=namespace, name=old), new

    def carry_out(self) -> None:
        """Write the new names into all references."""
        for (model, namespace), names in self.followed.items():
            model.names.follow(namespace, names)


def unlistable_message(reference: Reference[M], new: str, called: str) -> str:
    """Return the message about a new name that a list of names in this element cannot hold."""
    return (
        f"`{reference.name}` cannot be called `{new}`: {called} has it in a list of names, which cannot hold one "
        "with a space"
    )
