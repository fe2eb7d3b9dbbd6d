"""New names, which every reference follows: in the model, and in the models it is attached to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Generic, NamedTuple

from composer.tree.editable import M, Reference, uses_of
from composer.tree.kinds import section_of
from composer.tree.name_index import is_list


class NewName(NamedTuple, Generic[M]):
    """A name of a model, by namespace, that becomes another one."""

    model: M
    namespace: str
    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Renaming(Generic[M]):
    """The names by which models refer to what is renamed, old and new, by model and namespace.

    It is made before the first name changes, and carried out after all have: two names can change places.
    """

    followed: dict[tuple[M, str], dict[str, str]] = field(default_factory=dict)

    @classmethod
    def of(cls, names: Iterable[NewName[M]]) -> Renaming[M]:
        """The references that follow these names, those to the copies that MuJoCo makes of them included."""
        renaming: Renaming[M] = cls()
        for model, namespace, old, new in names:
            for here, prefix, used in uses_of(model, namespace, old):
                meant = prefix + new + used[len(prefix) + len(old) :]
                renaming.followed.setdefault((here, namespace), {})[used] = meant
        return renaming

    @classmethod
    def of_prefix(cls, model: M, old: str, new: str) -> Renaming[M]:
        """The references to all that has a prefix in a model and is not its own."""
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
        """References in lists of names that cannot follow, each with the new name: it has a space in it."""
        for (model, namespace), names in self.followed.items():
            for old, new in names.items():
                if len(new.split()) == 1:
                    continue
                for node, attribute in model.names.users(namespace, old):
                    if is_list(node, attribute, section_of(node)):
                        yield Reference(model, node, attribute, namespace, old), new

    def carry_out(self) -> None:
        """Write the new names wherever the old ones are referred to."""
        for (model, namespace), names in self.followed.items():
            model.names.follow(namespace, names)


def unlistable_message(reference: Reference[M], new: str, called: str) -> str:
    """What is wrong with a new name that a list of names, in the element called so, cannot hold."""
    return (
        f"`{reference.name}` cannot be called `{new}`: {called} has it in a list of names, which cannot hold one "
        "with a space"
    )
