"""What was made of a mesh, and how far it is from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.grammar.format import number_text
from composer.recipe.verbs.collision import in_words


@dataclass(frozen=True, slots=True)
class MadeShapes:
    """`shapes` are the geoms that were made for the geom `of`, or the mesh itself where it was simplified.

    `error` has the distances in metres and the shares that `composer.meshes.measure` measures, `faces` how many the
    mesh has and `made_with` the versions of what made it. `key` is the content that it follows from, and its name where
    it is kept.
    """

    of: str
    mesh: str
    method: str
    wanted: Any
    shapes: tuple[str, ...]
    faces: int
    error: Mapping[str, float | int | None]
    made_with: Mapping[str, str]
    key: str
    span: Span

    @property
    def how(self) -> str:
        """The method with its settings."""
        return in_words(self.method, self.wanted)

    @property
    def words(self) -> str:
        """What `plan` prints, on one line."""
        what = f"{self.mesh} ({self.faces} faces)"
        if self.method == "simplify":
            made = f"simplified, {_mm(self.error['hausdorff'])} off"
        else:
            count = len(self.shapes)
            made = f"{count} geom{'s' * (count != 1)}" + (f" for {self.of}" if self.of else "")
            made += f", {_mm(self.error['beyond'])} beyond it and {_mm(self.error['short'])} short of it"
        volume = self.error["volume"]
        return f"{what}: {made}" + ("" if volume is None else f", {volume:.3g} of its volume")


def _mm(metres: float | int | None) -> str:
    return f"{number_text(float(f'{1000 * (metres or 0):.3g}'))} mm"
