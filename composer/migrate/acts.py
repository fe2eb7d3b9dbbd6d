"""What changes of the table do to a model: each function makes one that is carried out on an `Editing`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from composer.migrate.change import Act
from composer.migrate.editing import Editing, called

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

Test = Callable[[Editing], bool]


def rename(places: str, old: str, new: str, words: dict[str, str] | None = None) -> tuple[Act, Act]:
    """An attribute that has another name, and perhaps other words; both directions."""

    def act(old: str, new: str, words: dict[str, str] | None) -> Act:
        def carry_out(editing: Editing) -> None:
            for node in editing.at(*places.split()):
                value = node.get(old)
                if value is None:
                    continue
                if words is not None and value not in words:
                    editing.refuse(node, f'`{old}="{value}"` of {called(node)} has no word in MuJoCo {editing.after}',
                                   attribute=old)  # fmt: skip
                    continue
                if node.get(new) is not None:
                    editing.unset(node, old)  # MuJoCo takes the new one where both are written
                    continue
                editing.rename(node, old, new, value=value if words is None else words[value])

        return carry_out

    back = None if words is None else {value: key for key, value in words.items()}
    return act(old, new, words), act(new, old, back)


def keep_default(path: str, attribute: str, was: str, now: str, where: Test | None = None) -> tuple[Act, Act]:
    """A setting of the whole model with another default: what was meant is written out; both directions."""

    def act(value: str) -> Act:
        def carry_out(editing: Editing) -> None:
            if any(node.get(attribute) is not None for node in editing.at(path)):
                return
            if where is not None and not where(editing):
                return
            if editing.stage_reads(path, attribute):
                editing.set(editing.within(path), attribute, value)
            elif value != was:
                editing.warn(None, editing.lacking(path, attribute, value))

        return carry_out

    return act(was), act(now)


def keep_of_each(
    places: str, attribute: str, was: str, now: str, of: Callable[[Editing, Node], bool]
) -> tuple[Act, Act]:
    """An attribute of elements with another default: it is written on those that say nothing; both directions."""

    def act(value: str) -> Act:
        def carry_out(editing: Editing) -> None:
            for node in editing.at(*places.split()):
                if (
                    editing.value(node, attribute) is None
                    and of(editing, node)
                    and (editing.stage_reads(places.split()[0], attribute))
                ):
                    editing.set(node, attribute, value)

        return carry_out

    return act(was), act(now)


def drop(places: str, attribute: str, harmless: tuple[str, ...], lost: str | None = None) -> Act:
    """An attribute that is not read any more: taken away; a warning where it said something else than `harmless`."""

    def carry_out(editing: Editing) -> None:
        for node in editing.at(*places.split()):
            value = node.get(attribute)
            if value is None:
                continue
            if harmless and value not in harmless and lost is not None:
                editing.warn(node, lost.format(value=value, called=called(node)), attribute=attribute)
            editing.unset(node, attribute)

    return carry_out


def advise(
    places: str, message: str, help: str | None, of: Callable[[Editing, Node], bool] | None = None
) -> Act:
    """What cannot be migrated by a rule: a located warning for each element that it is about."""

    def carry_out(editing: Editing) -> None:
        for node in editing.at(*places.split()):
            if of is None or of(editing, node):
                editing.warn(node, message.format(called=called(node)), help)

    return carry_out


def refuse(places: str, message: str, help: str, of: Callable[[Editing, Node], bool] | None = None) -> Act:
    """What the other version cannot say at all: a located error for each element that it is about."""

    def carry_out(editing: Editing) -> None:
        for node in editing.at(*places.split()):
            if of is None or of(editing, node):
                editing.refuse(node, message.format(called=called(node)), help)

    return carry_out
