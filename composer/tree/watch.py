"""Somebody who looks on while a model is put together. A build has nobody; `mjcompose explain` has."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from composer.tree.unit import Unit


class Watch(Protocol):
    """Is notified after each thing that may have changed a model, and changes nothing itself."""

    def __call__(self, units: Iterable[Unit], done: object) -> None:
        """`units` are all the trees there are; `done` is what has just been done to them.

        That is a source that was read, a plan that is begun, a `Linking` whose parts now belong together, a pass of
        the linker, a step of the plan, or another function that has run.
        """


def nobody(units: Iterable[Unit], done: object) -> None:
    """The `Watch` of a build: none."""
