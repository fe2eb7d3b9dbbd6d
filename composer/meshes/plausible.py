"""Whether a mesh can be what was meant: enormous or in millimetres, flat, open. One judgement for all who read meshes.

`measures` and `is_flat` run in the child process, where the vertices are; `doubts` judges their answer here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from composer.dataclass import dataclass

SIZE, SHAPE = "mesh-size", "mesh-shape"
"""The codes of the warnings."""
_LARGE, _SMALL = 20.0, 1e-3
"""In metres: halls and screws. Beyond these a mesh is doubtful, but not in a model that is as large itself."""
_TIMES = 50.0
"""By the distance of neighbouring bodies."""
_LEAST_REACH = 0.1
_THIN = 1e-6
"""Relative: MuJoCo keeps coordinates with seven digits, so that what is thinner than this is flat."""
_MOST = 1e9
_FACTORS = {"large": (0.001, "its file is in millimetres"), "small": (1000, "it is scaled twice")}
"""What the scale of a mesh would be multiplied with, and why."""


@dataclass(frozen=True, slots=True)
class Measured:
    """What a mesh measures: `size` is the diagonal of the box around it, in metres, as it stands in the model.

    It is closed if every edge has two faces. `open_edges` of `edges` have not; None where nobody counted.
    """

    size: float
    is_flat: bool = False
    is_closed: bool = True
    open_edges: int | None = None
    edges: int | None = None


@dataclass(frozen=True, slots=True)
class Doubt:
    """Why a mesh is hardly what was meant: `large`, `small`, `flat` or `open`, as the end of a sentence (`what`)."""

    kind: str
    what: str

    @property
    def code(self) -> str:
        return SIZE if self.kind in _FACTORS else SHAPE

    def advice(self, scale: Sequence[float], write: str, between: str = " ") -> str:
        """Return the help for a wrong size; `write` is what sets the scale of the mesh, with `{}` for the numbers.

        >>> Doubt("large", "").advice((1, 1, 2), 'scale="{}"')
        'if its file is in millimetres, write `scale="0.001 0.001 0.002"`'
        """
        factor, why = _FACTORS[self.kind]
        return f"if {why}, write `{write.format(between.join(f'{each * factor:g}' for each in scale))}`"


def doubts(
    mesh: Measured, reach: float, *, touches: bool = True, inside: str | None = None
) -> Iterator[Doubt]:
    """Yield what is doubtful of a mesh. `reach` is the greatest distance of neighbouring bodies, in metres.

    What is only seen (`touches` is false) may be flat. `inside` says what needs an inside, as a clause; a mesh may be
    open without it, for MuJoCo lets its convex hull collide.

    >>> [each.what for each in doubts(Measured(300.0), 0.4)]
    ['is 300 m from corner to corner, and neighbouring bodies are at most 0.4 m apart']
    >>> [each.code for each in doubts(Measured(0.2, is_closed=False), 0.4, inside="its mass is computed from it")]
    ['mesh-shape']
    """
    reach = max(reach, _LEAST_REACH)
    if mesh.size > _LARGE and mesh.size > _TIMES * reach:
        yield Doubt("large", _far(mesh, reach))
    elif 0 < mesh.size < _SMALL and reach > _TIMES * mesh.size:
        yield Doubt("small", _far(mesh, reach))
    if touches and mesh.is_flat:
        yield Doubt("flat", "is flat: it has no volume, so that nothing is inside it")
    elif inside is not None and not mesh.is_closed:
        counted = ""
        if mesh.open_edges:
            counted = f" ({mesh.open_edges} of {mesh.edges} edges have no second face)"
        yield Doubt("open", f"is open{counted}, and {inside}")


def _far(mesh: Measured, reach: float) -> str:
    size = f"{mesh.size:.3g} m" if mesh.size >= 1 else f"{1000 * mesh.size:.3g} mm"
    return f"is {size} from corner to corner, and neighbouring bodies are at most {reach:.2g} m apart"


def measures(vertices: Any, faces: Any) -> dict[str, Any]:
    """Return the extents in metres, the volume, whether it is flat, and how many edges have not exactly two faces."""
    import numpy

    extents = vertices.max(axis=0) - vertices.min(axis=0)
    _, same = numpy.unique(vertices, axis=0, return_inverse=True)
    corners = same.ravel()[faces]
    corners = corners[
        (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 0] != corners[:, 2])
    ]
    edges = numpy.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, counts = numpy.unique(edges, axis=0, return_counts=True)
    return {
        "extents": [min(float(each), _MOST) for each in extents],
        "volume": min(_volume(vertices, faces), _MOST),
        "flat": is_flat(vertices),
        "open": int((counts % 2).sum()),
        "edges": len(counts),
    }


def measured(facts: dict[str, Any], scale: Sequence[float]) -> Measured:
    """Return what `measures` found, for a mesh with this scale."""
    size = math.dist((0, 0, 0), [factor * each for factor, each in zip(scale, facts["extents"], strict=True)])
    return Measured(size, facts["flat"], not facts["open"], open_edges=facts["open"], edges=facts["edges"])


def is_flat(vertices: Any) -> bool:
    """Whether vertices, shape (n, 3), are a point, a line or in a plane, however that is turned."""
    import numpy

    centred = vertices - vertices.mean(axis=0)
    _, lengths, axes = numpy.linalg.svd(centred, full_matrices=False)
    thick = numpy.ptp(centred @ axes.T, axis=0)
    return len(lengths) < 3 or bool(thick.min() <= _THIN * thick.max())


def _volume(vertices: Any, faces: Any) -> float:
    import numpy

    a, b, c = (vertices[faces[:, corner]] - vertices.mean(axis=0) for corner in range(3))
    return float(abs((a * numpy.cross(b, c)).sum()) / 6)
