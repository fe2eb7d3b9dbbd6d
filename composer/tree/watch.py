"""Observe the composition of a model. A build has no observer; `mjcompose explain` has one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from composer.tree.unit import Unit


class Watch(Protocol):
    """An observer that is called after everything that may have changed a model. It changes nothing itself."""

    def __call__(self, units: Iterable[Unit], done: object) -> None:
        """Observe that `done` has changed some of the trees in `units`.

        `done` is a source that was read, a plan that is started, a `Linking` whose parts now belong together, a
        pass of the linker, a step of the plan, or another function that has run.
        """


def nobody(units: Iterable[Unit], done: object) -> None:
    """Do nothing: the `Watch` of a build."""
