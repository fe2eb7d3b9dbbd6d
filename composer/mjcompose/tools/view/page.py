"""The page of a model: its data, the origins of its elements, and two models side by side."""

from __future__ import annotations

import base64
import html
import json
import lzma
import os
import zlib
from collections.abc import Callable, Collection, Mapping as AbcMapping, Sequence
from dataclasses import field, replace
from itertools import islice
from pathlib import Path, PurePath
from typing import Any

from mjcompose.base import __version__
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.report import json_text
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import unknown_name
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.staging import staged_file, write_files
from mjcompose.contrast.changes import CauseLines, Diff, FieldChange
from mjcompose.contrast.text import render
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.playable import strip
from mjcompose.mujoco.scene import FILE, describe
from mjcompose.pipeline.cache.cells import cells_of
from mjcompose.plan.read import read_recipe
from mjcompose.sides.operand import Operand, OperandKind
from mjcompose.sides.revision import split
from mjcompose.sides.side import End, Side
from mjcompose.sources.context import Context, as_text
from mjcompose.text.node import Mapping, Node, Scalar, find, to_python
from mjcompose.trace import query
from mjcompose.trace.explanation import Reason
from mjcompose.trace.traced import Traced
from mjcompose.tree.classes import given
from mjcompose.tree.select import kind_of

CELL = "cell"
_MOST_CELLS = 200
_NONE = "(no cell)"


class ViewChoice(Struct):
    """Values of parameters and variants, a cell of the matrix, a sample of the drawn values."""

    given: dict[str, Node] = field(default_factory=dict)
    pick: str | None = None
    sample: int | None = None

    def choosing(self, name: str, value: str | float) -> ViewChoice:
        if name == CELL:
            return replace(self, pick=None if value == _NONE else str(value), sample=None)
        is_number = not isinstance(value, str)
        given = {**self.given, name: Scalar(value, Span(f"--set {name}", 1, 1), str(value), plain=is_number)}
        return replace(self, given=given)


def _document(operand: Operand) -> Mapping | None:
    """Return the recipe of an operand, or None for a model and for a recipe that cannot be read."""
    if operand.kind is not OperandKind.RECIPE:
        return None
    context = replace(operand.context, sink=Sink())
    document = read_recipe(context.folder / operand.path, context)
    return document if isinstance(document, Mapping) else None


def parameters(operand: Operand, asked: ViewChoice) -> list[dict[str, Any]]:
    """Return the numbers among the parameters of a recipe, with their values and bounds."""
    document = _document(operand)
    declared = None if document is None else find(document, ("params",))
    if not isinstance(declared, Mapping):
        return []
    rows = []
    for name, (_, node) in declared.entries.items():
        entry = to_python(node)
        form = entry if isinstance(entry, dict) else {"default": entry}
        standard = form.get("default")
        if isinstance(standard, bool) or not isinstance(standard, int | float):
            continue
        chosen = asked.given.get(name)
        rows.append(
            {
                "name": name,
                "value": _number(chosen, standard),
                "standard": standard,
                "low": form.get("min"),
                "high": form.get("max"),
                "whole": isinstance(standard, int) and form.get("type", "int") == "int",
                "unit": str(form.get("unit", "")),
                "doc": str(form.get("doc", "")),
            }
        )
    return rows


def _number(node: Node | None, standard: float) -> float:
    try:
        return standard if not isinstance(node, Scalar) else float(node.text)
    except ValueError:  # an expression, or a value that is refused
        return standard


def choices(operand: Operand, asked: ViewChoice) -> list[dict[str, Any]]:
    """Return the menus of a recipe: its variants, unless a cell sets them, and its cells and samples."""
    document = _document(operand)
    if document is None:
        return []
    context = replace(operand.context, sink=Sink())
    menus: list[dict[str, Any]] = []
    variants = find(document, ("variants",))
    axes = variants.entries.items() if isinstance(variants, Mapping) and asked.pick is None else ()
    for axis, values in ((axis, values) for axis, (_, values) in axes if isinstance(values, Mapping)):
        node = asked.given.get(axis)
        value = node.text if isinstance(node, Scalar) else None
        menus.append({"name": axis, "label": f"variant {axis}", "values": list(values.entries), "value": value})
    has_cells = not {"matrix", "randomize"}.isdisjoint(document.entries)
    cells = cells_of(operand.path, context, dict(asked.given)) if has_cells else []
    if cells:
        names = [_NONE, *(cell.name for cell in cells[:_MOST_CELLS])]
        menus.append({"name": CELL, "label": "cell or sample", "values": names, "value": asked.pick or _NONE})
    return menus


class ShortNames(Struct, frozen=False):
    """Short unique names for files: the relative path below `folder`, or else the shortest unique end of the path."""

    folder: Path
    _files: dict[str, str] = field(default_factory=dict)

    def of(self, name: str) -> str:
        """Return the short name of the file that messages call `name`."""
        if not os.path.isabs(name) and self.folder != Path(self.folder.anchor):
            return self._files.setdefault(name, name)
        parts = [part for part in PurePath(name).parts if part not in (os.sep, PurePath(name).anchor)]
        for count in range(1, len(parts) + 1):
            short = "/".join(parts[-count:])
            if self._files.setdefault(short, name) == name:
                return short
        return name

    def span(self, span: Span | None) -> Span | None:
        return None if span is None else replace(span, file=self.of(span.file))

    def diff(self, found: Diff) -> Diff:
        """Return a comparison whose text has short names."""

        def short(cause: CauseLines | None) -> CauseLines | None:
            return cause and replace(cause, before=self.span(cause.before), after=self.span(cause.after))

        groups = [replace(each, cause=short(each.cause)) for each in found.groups]
        return replace(found, a=self._end(found.a), b=self._end(found.b), groups=tuple(groups))

    def _end(self, end: End) -> End:
        in_revision = None if os.path.exists(self.folder / end.label) else split(end.label)
        if in_revision is None:
            return replace(end, label=self.of(end.label))
        revision, path = in_revision
        return replace(end, label=f"{revision}:{self.of(path)}")


KINDS = ("body", "joint", "geom", "site", "camera", "light", "tendon", "actuator", "key", "skin", "flex")
_MOST_CHANGES = 12
VALUES: dict[str, tuple[str, ...]] = {
    kind: tuple(attributes.split())
    for kind, attributes in {
        "body": "pos gravcomp",
        "joint": "range damping armature frictionloss stiffness springref actuatorfrcrange solreflimit solimplimit"
        " margin axis",
        "geom": "size friction priority condim margin gap solref solimp contype conaffinity mass density",
        "actuator": "kp kv gear ctrlrange forcerange gainprm biasprm",
    }.items()
}
"""Attributes whose places the page shows next to their values."""


def nodes_of(kind: str, names: Sequence[str], traced: Traced) -> list[Any]:
    """Return the node of each element of a kind, or None: copies made by MuJoCo have no node of their own."""
    asked = query.read(kind, None, Sink())
    nodes = [] if asked is None else query.find(asked, traced.model.root, traced.separator)
    if len(nodes) == len(names):
        return nodes
    known = {name: node for node in nodes if (name := query.name_of(node)) is not None}
    return [known.get(name) for name in names]


Place = list[int] | None  # the number of a file, a line and a column


class PageOrigins:
    """The origins of elements for the page; `absolute` has files of this machine by their `names`, for editors."""

    def __init__(self, side: Side, names: ShortNames) -> None:
        self.side = side
        self.names = names
        self.absolute: dict[str, str] = {}
        self._files: dict[str, int] = {}
        self._parts: dict[tuple[Reason, ...], int] = {}
        self._part_rows: list[Any] = []
        self._numbers: dict[str, int] = {}

    def data(self, names: AbcMapping[str, Sequence[str]], excluded: Sequence[tuple[str, str]]) -> dict[str, Any]:
        """Return for each kind the place, part, words and changes of each element, and rows for `excluded` pairs."""
        traced = self.side.traced
        of: dict[str, list[Any]] = {}
        values: dict[str, list[Any]] = {}
        if traced is not None:
            nodes = {kind: nodes_of(kind, names[kind], traced) for kind in KINDS if kind in names}
            of = {kind: list(map(self._element, each)) for kind, each in nodes.items()}
            values = {kind: [self._values(node, kind) for node in nodes[kind]] for kind in VALUES if kind in nodes}
        exclude = self._of_excludes(excluded)  # before `files`, which lists its files too
        parts = self._part_rows
        return {"files": list(self._files), "parts": parts, "of": of, "values": values, "exclude": exclude}

    def _values(self, node: Any, kind: str) -> dict[str, Place]:
        """Return the place of each attribute that acts on an element: its own, or the attribute of a default class."""
        traced = self.side.traced
        if node is None or traced is None:
            return {}
        levels = given(node, kind_of(node), traced.classes)
        writers = {each.name: level.writer for each, level in levels}
        writers |= {name: node for name in VALUES[kind] if node.get(name) is not None}
        written = [(name, writers[name]) for name in VALUES[kind] if name in writers]
        places = {name: self._place(traced.written_at(writer, name)) for name, writer in written}
        return {name: place for name, place in places.items() if place is not None}

    def _of_excludes(self, pairs: Sequence[tuple[str, str]]) -> list[Any]:
        """Return for each pair its place, its words, and the reason for its exclusion, or null."""
        why = {frozenset((each.one, each.other)): each.why for each in self.side.excluded if each.why}
        traced = self.side.traced
        nodes = () if traced is None else traced.model.root.iterfind("contact/exclude")
        found = {frozenset((str(node.get("body1")), str(node.get("body2")))): node for node in nodes}
        rows = []
        for pair in map(frozenset, pairs):
            place, _, words, _ = self._element(found.get(pair)) or (None, -1, "", [])
            rows.append([place, words, why.get(pair)])
        return rows

    def _element(self, node: Any) -> list[Any] | None:
        traced = self.side.traced
        if node is None or traced is None:
            return None
        life = traced.watch.life(node)
        written = list(traced.written(life))
        place = next((self._place(each.span) for each in written if each.span is not None), None)
        words = " ".join(dict.fromkeys(each.words for each in written if each.words != "read from"))
        changes = [
            [each.attribute or "", each.before, each.after, each.reason.words, self._place(each.reason.span)]
            for each in islice(traced.changes(life), _MOST_CHANGES)
        ]
        return [place, self._part(tuple(traced.parts(life))), words, changes]

    def _part(self, chain: tuple[Reason, ...]) -> int:
        """Return the number of a part, or -1 for none. `chain` has the part and then the parts around it.

        A recipe that is used twice has the same inner parts twice, so the whole chain tells them apart.
        """
        if not chain:
            return -1
        if chain not in self._parts:
            outer = self._part(chain[1:])
            self._parts[chain] = len(self._parts)
            self._part_rows.append([chain[0].words, self._place(chain[0].span), outer])
        return self._parts[chain]

    def _place(self, span: Span | None) -> Place:
        if span is None or span.file.startswith("--"):
            return None
        if span.file not in self._numbers:  # `located` is slow
            operand = self.side.operand
            name = self.names.of(operand.located(span).file)
            path = os.path.abspath(operand.context.folder / span.file)
            if os.path.isfile(path):
                self.absolute.setdefault(name, path)
            self._numbers[span.file] = self._files.setdefault(name, len(self._files))
        return [self._numbers[span.file], span.line, span.column]


class Description(Struct):
    """A model as JSON for the page. `used` are the names of its blobs, and `blobs` has the bytes of new blobs."""

    title: str
    text: str
    used: tuple[str, ...]
    blobs: dict[str, bytes]
    keys: tuple[str, ...] = ()

    def has_key(self, key: str | None, sink: Sink) -> bool:
        """Return whether the keyframe exists, or none is requested; report a missing one."""
        if key is None or key in self.keys:
            return True
        sink.add(unknown_name("keyframe", key, filter(None, self.keys), written="--key {}"))
        return False


def described(
    side: Side,
    session: Session,
    known: Collection[str] = (),
    editor: str | None = None,
    names: ShortNames | None = None,
    extend: Callable[[dict[str, Any]], object] | None = None,
    **more: Any,
) -> Description | None:
    """Return the description of a model that `session` keeps, or None if MuJoCo fails, which is reported.

    Blobs in `known` are not created again. With an `editor` address, in which `{file}`, `{line}` and `{column}`
    are a place, it has paths of this machine; without it there are none, and the same model gives the same bytes.
    `names` are the file names shared with another model on the page. `more` is added to the JSON, and `extend` adds to
    it.
    """
    with scratch("scene") as folder:
        answer = engine.call(session, describe, [side.kept], argument={"folder": str(folder), "known": sorted(known)})
        if not answer.ok:
            message = f"`{side.operand.label}` cannot be shown: {answer.error or answer.crash}"
            side.operand.context.sink.error("mujoco-crash", message)
            return None
        scene = json.loads(Path(folder, FILE).read_text(encoding="utf-8"))
        used = tuple(answer.value["blobs"])
        blobs = {name: path.read_bytes() for name in used if os.path.exists(path := Path(folder, name))}
    origins = PageOrigins(side, names or ShortNames(side.operand.context.folder))
    tables = ((kind, columns) for kind, columns in scene.items() if isinstance(columns, dict))
    elements = {kind: columns["name"] for kind, columns in tables if "name" in columns}
    elements |= {kind: [each["name"] for each in scene[kind]] for kind in ("skin", "flex")}
    bodies = scene["body"]["name"]
    excluded = scene["exclude"]
    pairs = [(bodies[one], bodies[two]) for one, two in zip(excluded["body1"], excluded["body2"], strict=True)]
    scene["origins"] = origins.data(elements, pairs)
    name = side.cell or (Path(side.operand.label).stem if side.plan is None else side.plan.name)
    scene["title"] = title = as_text(str(name))
    if editor is not None:
        scene["editor"] = {"template": editor, "files": origins.absolute}
    scene["made"] = f"mjcompose {__version__}"
    scene |= more
    if extend is not None:
        extend(scene)
    text = json_text(scene, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return Description(title, text, used, blobs=blobs, keys=tuple(scene["key"]["name"]))


_ABSENT = -1
_PLACES = ("body_pos", "body_quat")


def write_comparison(a: Side, b: Side, found: Diff, out: Path, context: Context, session: Session) -> bool:
    """Write the page of two models that `session` keeps; return False after an error, which is reported."""
    names = ShortNames(context.folder)
    changes = difference(names.diff(found))
    before = described(a, session, names=names, difference=changes)
    after = None if before is None else described(b, session, before.used, names=names, difference=changes)
    if before is None or after is None:
        for side in (a, b):
            side.operand.report(context.sink)
        return False
    return _wrote(alone(before, after).encode(), out, context, inputs=(*a.inputs, *b.inputs))


def _wrote(content: bytes, out: Path, context: Context, inputs: Sequence[Path]) -> bool:
    with context.sink:
        with staged_file(context.folder / out, "--html", inputs=inputs) as stage:
            stage.write_bytes(content)
        return True
    return False


def difference(found: Diff) -> dict[str, Any]:
    """Return the comparison as data for the page: its text, and for each model the elements that differ."""
    changes = [each for each in found.contrast.changes if not each.follows]
    return {
        "label": f"{found.a.named} → {found.b.named}",
        "text": render(found),
        "before": {what: _elements(changes, what, 0) for what in ("removed", "changed", "moved")},
        "after": {what: _elements(changes, what, 1) for what in ("added", "changed", "moved")},
    }


def _elements(changes: list[FieldChange], what: str, side: int) -> list[str]:
    found = (
        f"{each.kind} {each.index[side]}"
        for each in changes
        if each.index[side] != _ABSENT
        and what == ("moved" if each.kind == "body" and each.field in _PLACES else each.what)
    )
    return list(dict.fromkeys(found))


BUILT = Path(__file__).with_name("built")
# Only content of the file: no requests at all.
_ALONE = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:;"
    " form-action 'none'; base-uri 'none'"
)
# MuJoCo's bindings create functions from text, and the browser loads the WebAssembly from the file itself.
_PLAYED = _ALONE.replace("'unsafe-inline';", "'unsafe-inline' 'unsafe-eval'; connect-src blob:;", 1)
_LINE = 4096


def alone(description: Description, *others: Description, played: AbcMapping[str, bytes] | None = None) -> str:
    """Return the page of one or two models, which share blobs; with files of a bundle in `played`, it has MuJoCo."""
    policy = _ALONE
    body = ""
    programs = ["page.js"]
    for number, each in enumerate((description, *others)):
        new = [(name, each.blobs[name]) for name in each.used if name in each.blobs]
        body += _packed("model", each.text.encode(), new, more=f" data-number={number}")
    if played is not None:
        policy = _PLAYED
        programs = ["physics.js", "page.js"]
        program = lzma.decompress((BUILT / "mujoco.wasm.xz").read_bytes())
        body += _packed("physics", b"null", [*played.items(), ("mujoco.wasm", program)])
    body += "".join(_compressed("program", (BUILT / name).read_bytes()) for name in programs)
    head = f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
    return shell(description.title, head, body, style=f"<style>{_built('page.css')}</style>", script=_START)


def live(title: str) -> str:
    """Return the page of a server, which serves the program and the models separately."""
    style = "<link rel=stylesheet href=page.css>"
    script = "<script src=page.js></script>"
    return shell(title, "", "", style=style, script=script).replace("<html lang=en>", "<html lang=en data-live>")


# Runs the compressed programs of a page, one after the other.
_START = (
    "<script>void async function(){for(const each of document.querySelectorAll('script.program')){"
    "const bytes=Uint8Array.from(atob(each.textContent.replace(/\\s/g,'')),(one)=>one.charCodeAt(0));"
    "const read=new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));"
    "const made=document.createElement('script');made.textContent=await new Response(read).text();"
    "document.head.append(made)}}()</script>"
)


def shell(title: str, head: str, body: str, style: str, script: str) -> str:
    """Return the page around a model."""
    notice = _built("NOTICE")
    return (
        "<!doctype html>\n<html lang=en>\n<meta charset=utf-8>\n"
        '<meta name=viewport content="width=device-width,initial-scale=1">\n'
        f"<link rel=icon href=data:,>\n{head}\n<title>{html.escape(title)}</title>\n"
        f"<!--\n{notice.replace('--', '- -')}-->\n"
        f"{style}\n<div id=page></div>\n{body}{script}\n</html>\n"
    )


def _built(name: str) -> str:
    return (BUILT / name).read_text(encoding="utf-8")


def _packed(what: str, text: bytes, blobs: list[tuple[str, bytes]], more: str = "") -> str:
    """Return compressed bytes of the class `what` for the page: a line of JSON with sizes, the text, and the blobs."""
    head = json.dumps([len(text), [[name, len(content)] for name, content in blobs]], separators=(",", ":"))
    return _compressed(what, b"".join([head.encode(), b"\n", text, *(content for _, content in blobs)]), more)


def _compressed(what: str, content: bytes, more: str = "") -> str:
    data = base64.b64encode(zlib.compress(content, 9)).decode("ascii")
    lines = "\n".join(data[at : at + _LINE] for at in range(0, len(data), _LINE))
    return f'<script type="application/octet-stream" class={what}{more}>\n{lines}\n</script>\n'


def write_page(side: Side, out: Path, key: str | None, context: Context, session: Session) -> int | None:
    """Write the page of a model that `session` keeps; return its size in bytes, or None after an error.

    Errors are reported. `key` is the initial keyframe; the default is the first. If the side has its bundle, the
    page can simulate it.
    """
    made = described(side, session, key_named=key)
    if made is None or not made.has_key(key, context.sink):
        return None
    text = alone(made, played=None if side.bundle is None else _played(side.bundle, session)).encode()
    return len(text) if _wrote(text, out, context, inputs=side.inputs) else None


def _played(bundle: Bundle, session: Session) -> dict[str, bytes]:
    """Return only the files that MuJoCo reads, because others reveal their origin; visual meshes are tiny."""
    names = [name for name in bundle.files if name.startswith("assets/")]
    with scratch("physics") as folder:
        source = folder / "in"
        source.mkdir()
        write_files(bundle, source)
        asked = {"model": str(source / bundle.model), "out": str(folder / "out")}
        answer = engine.call(session, strip, (), argument=asked)
        model = Path(answer.value) if answer.ok else source / bundle.model
        return {"model.xml": model.read_bytes(), **{name: (model.parent / name).read_bytes() for name in names}}
