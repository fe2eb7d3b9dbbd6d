"""The classes of elements, one for each kind: for annotations and `isinstance`.

    from mjcompose.mjcf import elements

    def lift(body: elements.Body) -> None: ...

`elements.Geom` is the class of every `<geom>` of the world, `elements.DefaultGeom` the class of its default settings.
The stub for type checkers, `elements.pyi`, is written from the grammar by `make schemas`.
"""

from __future__ import annotations

from mjcompose.mjcf.attributed import class_of, kinds


def __getattr__(name: str) -> object:
    kind = None if name.startswith("_") else kinds().get(name)
    if kind is None:
        raise AttributeError(f"module `{__name__}` has no attribute `{name}`", name=name)
    found: object = class_of(kind)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*kinds()]
