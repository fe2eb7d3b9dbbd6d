"""The models that a model attaches with `<model file=…>`: they are migrated with it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import Path

from composer.context import Context
from composer.dataclass import dataclass
from composer.migrate.editing import Meaning
from composer.tree.files import join
from composer.tree.parse import parse_file
from composer.tree.unit import Unit


@dataclass(slots=True, eq=False)
class Piece:
    """A model with those that it attaches, by the names that its `<attach>` elements have for them."""

    unit: Unit
    attached: dict[str, Piece] = field(default_factory=dict)


@dataclass(slots=True)
class Pieces:
    """A model and all that are attached, each once, the model itself first; `left` says what stays as it is."""

    context: Context
    every: list[Piece] = field(default_factory=list)
    left: list[Meaning] = field(default_factory=list)
    _known: dict[str, Piece] = field(default_factory=dict)

    @classmethod
    def of(cls, unit: Unit, context: Context) -> Pieces:
        """Read what a model attaches; errors go to the sink."""
        found = cls(context)
        found._read(unit, (os.path.realpath(unit.directory / os.path.basename(unit.file)),))
        return found

    def _read(self, unit: Unit, above: tuple[str, ...]) -> Piece:
        """`above` are the files that lead to it, and its own: MuJoCo 4.0 crashes where a model is made of itself."""
        piece = Piece(unit)
        self.every.append(piece)
        for element in unit.root.iterfind("asset/model"):
            file = str(element.get("file") or "")
            path = Path(os.path.normpath(join(str(unit.directory), file)))
            shown, real = self.context.shown(path), os.path.realpath(path)
            span = unit.origins.span(element, unit.file, "file")
            if real in above:
                help = "take this `<model>` out, or name another file"
                message = f"the model `{file}` is made of itself"
                self.context.sink.error("source-cycle", message, span, help=help)
                continue
            if not file or not unit.door.exists(path):
                continue  # MuJoCo says so
            if "urdf" in f"{element.get('content_type')} {path.suffix}".lower():
                self.left.append(
                    Meaning("attached", f"`{shown}` is URDF, and stays as it is", span, help=None)
                )
                continue
            inner = self._known.get(real)
            if inner is None:
                attached = parse_file(path, self.context.sink, file=shown, span=span, door=unit.door)
                if attached is None:
                    continue
                inner = self._known[real] = self._read(attached, (*above, real))
            piece.attached[str(element.get("name") or inner.unit.model)] = inner
        return piece

    def measured(self, piece: Piece, values: Mapping[str, object]) -> dict[str, object]:
        """What was measured of the whole model, by the names that a piece has for its own actuators.

        An actuator that is there several times has a value if all of them have the same.
        """
        kv = values.get("kv")
        if piece is self.every[0] or not isinstance(kv, dict):
            return dict(values)
        prefixes = [prefix for each, prefix in _placed(self.every[0], "") if each is piece]
        found = {}
        for node in piece.unit.root.iterfind("actuator/*"):
            name = str(node.get("name") or "")
            several = {kv.get(prefix + name) for prefix in prefixes}
            if name and len(several) == 1 and None not in several:
                found[name] = several.pop()
        return {"kv": found}


def _placed(piece: Piece, prefix: str) -> Iterator[tuple[Piece, str]]:
    """The pieces as MuJoCo attaches them, with what stands before their names. A compiled model has an end."""
    yield piece, prefix
    for attach in piece.unit.root.iter("attach"):
        inner = piece.attached.get(str(attach.get("model") or ""))
        if inner is not None:
            yield from _placed(inner, prefix + str(attach.get("prefix") or ""))
