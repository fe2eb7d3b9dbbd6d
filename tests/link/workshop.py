"""Where the tests of the linker work: models from text, linked, each judged by MuJoCo alone and together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco
import pytest
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.rotation import IDENTITY_QUAT, ORIGIN, Pose, Quat, Vec3, normalize
from mjcompose.base.sink import Sink
from mjcompose.link.collect import collect
from mjcompose.link.link import finish, link
from mjcompose.link.linking import AttachmentPlace, Joint, Linking, LinkRequest, Part
from mjcompose.link.measure import measure_with
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.match import Difference, Mount
from mjcompose.mujoco.unchanged import compare
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write

BASE = '<mujoco model="base"><worldbody><site name="mark" pos="1 2 3"/></worldbody></mujoco>'
"""A base that says next to nothing."""

OLDER = mujoco.mj_versionString().startswith("3.")

OCTAHEDRON = """
v 1 0 0
v -1 0 0
v 0 1 0
v 0 -1 0
v 0 0 1
v 0 0 -1
f 1 3 5
f 3 2 5
f 2 4 5
f 4 1 5
f 3 1 6
f 2 3 6
f 4 2 6
f 1 4 6
"""


def obj(scale: float = 0.1) -> bytes:
    """A mesh file, another one for each scale."""
    lines = OCTAHEDRON.strip().splitlines()
    scaled = [
        "v " + " ".join(str(scale * float(number)) for number in line.split()[1:]) if line[0] == "v" else line
        for line in lines
    ]
    return "\n".join(scaled).encode()


def placed(
    kind: str = "world", name: str | None = None, *, pos: Vec3 = ORIGIN, quat: Quat = IDENTITY_QUAT
) -> AttachmentPlace:
    """A place in the model with an offset."""
    offset: dict[str, str] = {}
    if pos != ORIGIN:
        offset["pos"] = " ".join(map(repr, pos))
    if quat != IDENTITY_QUAT:
        offset["quat"] = " ".join(map(repr, quat))
    return AttachmentPlace(kind, name, offset, Span("recipe.yaml", 1, 1))  # type: ignore[arg-type]


@dataclass
class Piece:
    """A part to be linked: its text, and how it hangs."""

    text: str
    prefix: str = "part/"
    place: AttachmentPlace = field(default_factory=AttachmentPlace)
    files: Mapping[str, bytes | str] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)
    label: str = "part"


class Workshop:
    """Writes models into a folder, links and compiles them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.count = 0

    def write(self, text: str, files: Mapping[str, bytes | str] | None = None, label: str = "model") -> Path:
        """A model in a folder of its own, with its files beside it."""
        self.count += 1
        path = self.folder / f"{self.count}" / f"{label}.xml"
        for name, content in {path.name: text, **(files or {})}.items():
            file = path.parent / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def unit(self, text: str, files: Mapping[str, bytes | str] | None = None, label: str = "model") -> Unit:
        sink = Sink()
        unit = parse_file(self.write(text, files, label), sink)
        assert unit is not None, told(sink)
        return unit

    def link(
        self,
        base: str,
        *pieces: Piece | str,
        files: Mapping[str, bytes | str] | None = None,
        label: str = "base",
        **options: Any,
    ) -> Linked:
        """The pieces linked to the base; nothing is asserted yet."""
        paths = [self.write(base, files, label)]
        parts: list[Part] = []
        sink = Sink()
        taken = [each if isinstance(each, Piece) else Piece(each) for each in pieces]
        base_unit = parse_file(paths[0], sink)
        for piece in taken:
            path = self.write(piece.text, piece.files, piece.label)
            paths.append(path)
            unit = parse_file(path, sink)
            assert unit is not None, told(sink)
            given = {"span": Span("recipe.yaml", len(parts) + 1, 1), **piece.options}
            parts.append(Part(unit, piece.prefix, piece.place, **given))
        assert base_unit is not None, told(sink)
        given = {"measure": measure_with(Context(sink=sink, environment={}, folder=self.folder)), **options}
        asked = {name: given.pop(name) for name in [*given] if name in LinkRequest.__dataclass_fields__}
        linking = Linking(base_unit, parts, sink, LinkRequest(**asked), **given)
        link(linking)
        if not sink.has_errors:
            finish(linking)
        return Linked(self, linking, paths, taken)


@dataclass
class Linked:
    """What came of it."""

    workshop: Workshop
    linking: Linking
    paths: list[Path]
    pieces: list[Piece]

    @property
    def sink(self) -> Sink:
        return self.linking.sink

    @property
    def xml(self) -> str:
        return write(self.linking.base.root).decode()

    @property
    def fault(self) -> Diagnostic:
        """The one error."""
        assert len(self.sink.errors) == 1, told(self.sink)
        return self.sink.errors[0]

    @property
    def codes(self) -> list[str]:
        return [found.code for found in self.sink.diagnostics]

    def bundled(self) -> dict[str, bytes]:
        """The files of the model."""
        if OLDER and self.sink.has_errors:
            for number in range(len(self.paths)):
                self.alone(number)
        assert not self.sink.has_errors, told(self.sink)
        files = collect(self.linking.base, self.linking.files, self.sink)
        assert not self.sink.has_errors, told(self.sink)
        return files

    def model(self) -> mujoco.MjModel:
        """The linked model, compiled in a folder that has only its bundle."""
        files = self.bundled()
        text = self.xml
        out = self.workshop.folder / f"out{self.workshop.count}"
        for name, content in {**files, "model.xml": text.encode()}.items():
            file = out / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        try:
            return mujoco.MjModel.from_xml_path(str(out / "model.xml"))
        except ValueError as error:
            raise AssertionError(f"{error}\n{text}") from error

    def alone(self, number: int) -> mujoco.MjModel:
        """The base (0) or a part (from 1) by itself.

        Models of these tests are in the words of the newest MuJoCo, some of which an older one lacks.
        """
        try:
            return mujoco.MjModel.from_xml_path(str(self.paths[number]))
        except ValueError as error:
            if OLDER:
                pytest.skip(f"this MuJoCo refuses the model itself: {str(error).splitlines()[0]}")
            raise

    def differences(self, **options: Any) -> list[Difference]:
        """What is no longer as it was in the base and in each part; parts that nothing gave are extra."""
        members = [("", self.alone(0))]
        members += [(piece.prefix, self.alone(at)) for at, piece in enumerate(self.pieces, 1)]
        composed = self.model()
        given = {"keys": KeyMode.MERGE, **options}
        found = compare(members[0][1], composed, **given)
        for at, (piece, part) in enumerate(zip(self.pieces, self.linking.parts, strict=True), 1):
            others = None
            if not part.joints and not part.mocap:
                others = [member for place, member in enumerate(members) if place != at]
            keys = KeyMode(part.keyframes)
            found += compare(
                members[at][1],
                composed,
                **{
                    "prefix": piece.prefix,
                    "hung_on": mount(self.linking, part, composed),
                    "others": others if piece.prefix else None,
                    **options,
                    "keys": keys,
                },
            )
        return found

    def check(self, **options: Any) -> mujoco.MjModel:
        """Every unit must be what it is alone; the compiled model, for more."""
        found = self.differences(**options)
        assert not found, "\n".join([*map(str, found), self.xml])
        return self.model()


def mount(linking: Linking, part: Part, composed: mujoco.MjModel) -> Mount:
    """Where the world of a part stands."""
    if part.joints or part.mocap:
        return Mount(part.prefix)
    offset = part.place.offset
    x, y, z = map(float, offset.get("pos", "0 0 0").split())
    w, a, b, c = map(float, offset.get("quat", "1 0 0 0").split())
    place = part.place
    if place.kind == "site":
        return Mount.of(composed, site=place.name, pos=(x, y, z), quat=(w, a, b, c))
    if place.kind == "frame":
        body = next((each for each in linking.attachments[part].mount.iterancestors("body")), None)
        return Mount(None if body is None else str(body.get("name")), None)
    return Mount(place.name if place.kind == "body" else None, Pose((x, y, z), normalize((w, a, b, c))))


def told(sink: Sink) -> str:
    """All faults as text."""
    return "\n".join(f"{found.span}: {found.code}: {found.message}" for found in sink.diagnostics)


def hinge(**attributes: str) -> Joint:
    return Joint("joint", {"type": "hinge", "class": "main", **attributes})
