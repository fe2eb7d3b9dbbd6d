"""Passes: models that MuJoCo attaches itself, and their options.

Under `conflict="merge"`, the options that a unit takes from the models it attaches become its own. The model itself
has no `conflict` setting, so the sub-models of one unit cannot change another unit.

Each `<model>` asset goes into the bundle with the files it needs. A sub-model keeps its own compiler settings, because
MuJoCo reads it as a separate model; only its folders change.
"""

from __future__ import annotations

import hashlib
import os
import posixpath
from collections.abc import Callable
from contextlib import suppress
from itertools import chain, count
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import Door, held
from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.base.limits import advice, in_force
from mjcompose.base.naming import portable_step
from mjcompose.base.sink import Sink
from mjcompose.link.agreement import default_of, merge_values, set_value, written_settings
from mjcompose.link.files import ASSETS, NamedFile, add_file, path_in_assets, readable_path, set_path
from mjcompose.link.linking import FileUse, Linking
from mjcompose.link.settings import FOLDERS
from mjcompose.link.unit_keys import remove_keys
from mjcompose.tree import journal
from mjcompose.tree.cost import NOTHING, Weight, expanded
from mjcompose.tree.files import FromFolder, file_attributes, is_recipe, join, written_path
from mjcompose.tree.journal import because, explained
from mjcompose.tree.mesh_cost import file_points, mesh_points
from mjcompose.tree.parse import parse_file, parse_text
from mjcompose.tree.unit import Unit, line_of, set_line
from mjcompose.tree.xml_text import write


def attached_size(unit: Unit) -> Callable[[Node], Weight]:
    """Return a function for the weight of the model of an `<attach>`, which is zero if the model cannot be read."""
    return _sizes_in(unit, {}, 0)


def _sizes_in(unit: Unit, known: dict[str, Weight], depth: int) -> Callable[[Node], Weight]:
    files = {
        str(each.get("name") or Path(str(each.get("file"))).stem): str(each.get("file") or "")
        for each in unit.root.iterfind("asset/model")
    }

    def size(attach: Node) -> Weight:
        file = files.get(str(attach.get("model")), "")
        return _size_of(unit, file, known, depth=depth + 1) if file else NOTHING

    return size


def _size_of(unit: Unit, file: str, known: dict[str, Weight], depth: int) -> Weight:
    if depth > in_force().nesting:  # reported when it is bundled
        return NOTHING
    held = unit.contents.get(file)
    key = str(held) if isinstance(held, Path) else join(str(unit.directory), file)
    if isinstance(held, bytes):
        key = f"{key}#{id(held)}"
    if key not in known:
        known[key] = NOTHING  # a model that contains itself, which is reported when it is bundled
        if (sub := _read(unit, file)) is not None:
            weight = expanded(sub.root, _sizes_in(sub, known, depth), lambda flexcomp: file_points(flexcomp, sub))
            known[key] = weight._replace(points=weight.points + mesh_points(sub))
    return known[key]


_IN_BUNDLE = because("where the bundle has the model")

# MuJoCo merges all of `option`, and these.
_BESIDES = frozenset({"visual/global/realtime", "visual/map/znear", "visual/map/zfar"})


def submodel_options(linking: Linking) -> None:
    """Write the options of units with sub-models. MuJoCo itself merges the options of a model of one unit."""
    if linking.parts:
        for unit in linking.units:
            _adopt_options(unit)


def _adopt_options(unit: Unit) -> None:
    compilers = [each for each in unit.root.iterchildren("compiler") if each.get("conflict")]
    # Without it MuJoCo 4.0 only warns: "parent has 0.002 (default), child has 0.004, keeping parent value".
    if not compilers or compilers[-1].get("conflict") != "merge":
        return
    words = f'required by a model that {unit.file_name} attaches, under its `conflict="merge"`'
    why = because(words, unit.setting_place("conflict"))
    models: dict[str, Unit] = {}
    for element in unit.root.iterfind("asset/model"):
        sub = _read(unit, str(element.get("file") or ""))
        if sub is not None:
            _adopt_options(sub)
            models[str(element.get("name") or sub.model)] = sub
    for attach in unit.root.iter("attach"):
        if (sub := models.get(str(attach.get("model")))) is not None:
            with explained(why):
                _merge(unit, sub, compilers[-1])


def _read(unit: Unit, file: str) -> Unit | None:
    known = unit.contents.get(file) if file else None
    if isinstance(known, bytes):
        return parse_held(unit, file, known, sink=Sink())
    path = known or Path(join(str(unit.directory), file))
    return parse_file(path, Sink(), door=door_of_submodel(unit, path, known)) if file else None


def _merge(unit: Unit, sub: Unit, compiler: Node) -> None:
    have = written_settings(unit)
    for path, wanted in written_settings(sub).items():
        own = have.get(path)
        if path.startswith("option/flag/"):
            value = None if wanted.value == default_of(path) else wanted.value
        elif path.startswith("option/") or (path in _BESIDES and own is None):
            value = merge_values(path, own, wanted)
        else:
            value = None
        if value is not None:
            _write(unit, path, value, compiler=compiler)
    for size in sub.root.iterchildren("size"):
        for name in ("memory", "njmax"):
            if size.get(name) and not any(each.get(name) for each in unit.root.iterchildren("size")):
                _write(unit, f"size/{name}", str(size.get(name)), compiler=compiler)


def _write(unit: Unit, path: str, value: str, compiler: Node) -> None:
    """Write a setting. For messages, a new section has the place of the unit's own setting."""
    tag = path.split("/")[0]
    new = next(unit.root.iterchildren(tag), None) is None
    set_value(unit, path, value)
    if new:
        set_line(next(unit.root.iterchildren(tag)), line_of(compiler))


def submodels(linking: Linking) -> None:
    policies = [linking.request.base_keyframes, *(part.keyframes for part in linking.parts)]
    for unit, policy in zip(linking.units, policies, strict=True):
        for element in unit.root.iter("model"):
            file = element.get("file")
            if file:
                bundler = _Bundler(linking, keyed=policy != "none")
                with suppress(_TooManyError), explained(_IN_BUNDLE):
                    bundler.bundle(unit, element, str(file), folder=f"{ASSETS}/{portable_step(unit.label)}/models")


def add_named_file(linking: Linking, file: NamedFile) -> None:
    if file.element.tag != "model":
        add_file(linking, file)
        return
    if is_recipe(file.name):
        message = f"`{file.name}` is a recipe, and `asset` names MJCF for MuJoCo to attach"
        linking.sink.error("source-kind", message, file.span, help="use `attach`, which takes recipes")
        return
    base = linking.base
    recipe = Unit(base.root, file.span.file, file.folder, label="", origins=base.origins, door=file.door)
    bundler = _Bundler(linking, keyed=linking.request.base_keyframes != "none")
    with suppress(_TooManyError):
        bundler.bundle(recipe, file.element, file.name, folder=f"{ASSETS}/models")


class _TooManyError(Exception):
    """There are too many sub-models, or their nesting is too deep, which has been reported. The rest is skipped."""


class _Bundler(Struct):
    """Bundles models that other models refer to, with their keys if they are `keyed`."""

    linking: Linking
    keyed: bool

    def bundle(self, unit: Unit, element: Node, file: str, *, folder: str, above: tuple[str, ...] = ()) -> None:
        """Bundle a model that another model refers to. `above` are the models that lead to it."""
        known = unit.contents.get(file)
        source = held(known if isinstance(known, Path) else join(str(unit.directory), file))
        if isinstance(known, bytes):
            steps = file.split("/")
            if len(steps) == 4 and steps[0] == ASSETS and steps[2] == "models":  # where this pass puts them
                self._bundled_before(unit, element, file=file, model=known)
                return
            source = held(f"{source}#{hashlib.sha256(known).hexdigest()}")  # two may have one path
        if source in above:
            help = "MuJoCo attaches a copy of this file: remove this `<model>`, or name another file"
            message = f"the model `{file}` contains itself"
            self.linking.sink.error("source-cycle", message, self.linking.span(unit, element, "file"), help=help)
            return
        self._count(unit, element, depth=len(above))
        before = self.linking.sink.error_count
        if isinstance(known, bytes):
            shown = file
            sub = parse_held(unit, file, known, sink=self.linking.sink)
        else:
            shown = source
            if known is None:  # messages name it by its place next to the file of the unit
                inside = os.path.relpath(source, unit.directory)
                shown = os.path.normpath(os.path.join(os.path.dirname(unit.file), inside))
            at = self.linking.span(unit, element, "file")
            door = door_of_submodel(unit, Path(source), known)
            sub = parse_file(Path(source), self.linking.sink, file=shown, span=at, door=door)
        if sub is None or self.linking.sink.error_count > before:
            return
        # MuJoCo names a `<model>` without a name after the `model` attribute in its file. Written here, the name stays
        # when the file gets another path.
        if not element.get("name"):
            journal.write(element, "name", sub.model, because("named by the `model` of its file"))
        path = self._free(f"{folder}/{portable_step(sub.label)}" + ("" if self.keyed else "-without-keys"), source)
        if not self.keyed:
            remove_keys(sub.root)
        self._own_files(sub, path, above=(*above, source))
        self.linking.notes.attached[element] = sub.root
        sub.origins.own(sub.root, shown)
        unit.origins.adopt(sub.origins)  # to report a missing file at the element that names it
        journal.write(element, "file", f"{path}.xml")
        use = FileUse(element, "file", f"{path}.xml", source=source, content=write(sub.root), shared=False)
        self.linking.files.append(use)

    def _count(self, unit: Unit, element: Node, depth: int) -> None:
        """Count one more sub-model, because models that each refer to two others would grow exponentially."""
        limits = in_force()
        self.linking.submodels += 1
        if depth >= limits.nesting:
            message = f"models attach models more than {limits.nesting} levels deep"
            limit = "nesting"
        elif self.linking.submodels > limits.submodels:
            message = f"there are more than {limits.submodels} models that models attach"
            limit = "submodels"
        else:
            return
        self.linking.sink.error("limit-exceeded", message, self.linking.span(unit, element, "file"), help=advice(limit))
        raise _TooManyError

    def _bundled_before(self, unit: Unit, element: Node, file: str, model: bytes) -> None:
        """Bundle the sub-model of a composition, whose files are next to it in a folder with its name."""
        taken = {use.path: use.content if use.content is not None else Path(use.source) for use in self.linking.files}
        folder = file.rsplit("/", 1)[0]
        start = file.removesuffix(".xml") + "/"
        files: dict[str, bytes | Path] = {path: each for path, each in unit.contents.items() if path.startswith(start)}
        files = {path.removeprefix(folder): content for path, content in {file: model, **files}.items()}
        if not self.keyed:
            files = {path: _without_keys(path, content) for path, content in files.items()}
        free = next(
            each
            for each in chain([folder], (f"{folder}-{number}" for number in count(2)))
            if all(_same_bytes(taken.get(each + path, content), content) for path, content in files.items())
        )
        journal.write(element, "file", free + file.removeprefix(folder))
        kept = files[file.removeprefix(folder)]
        if isinstance(kept, bytes) and (again := parse_held(unit, file, kept, sink=Sink())) is not None:
            self.linking.notes.attached[element] = again.root
        for path, content in files.items():
            data = content if isinstance(content, bytes) else None
            source = held(folder + path if isinstance(content, bytes) else content)
            self.linking.files.append(FileUse(element, "file", free + path, source=source, content=data, shared=False))

    def _free(self, path: str, source: str) -> str:
        taken = {use.path: use.source for use in self.linking.files}
        paths = chain([path], (f"{path}-{number}" for number in count(2)))
        return next(each for each in paths if taken.get(f"{each}.xml", source) == source)

    def _own_files(self, sub: Unit, path: str, *, above: tuple[str, ...]) -> None:
        """Bundle the files of a sub-model in a folder next to it. Its paths to them are relative to its own folder."""
        beside = path.rsplit("/", 1)[1]
        taken: dict[str, str] = {}
        for element, attribute, file in file_attributes(sub.root):
            written = written_path(sub.settings, element, file)
            known = sub.contents.get(written)
            if known is None:
                file_path = join(str(sub.directory), written)
                source = readable_path(self.linking, sub, element, attribute=attribute, path=file_path)
            else:
                source = held(known if isinstance(known, Path) else join(str(sub.directory), written))
            if source is None:
                continue
            below = path_in_assets(sub.settings, written)
            names = chain([below], (f"{number}/{below}" for number in count(2)))
            name = next(each for each in names if taken.setdefault(each.lower(), source) == source)
            set_path(element, attribute, f"{beside}/{name}", file)
            content = known if isinstance(known, bytes) else None
            use = FileUse(element, attribute, f"{path}/{name}", source=source, content=content, shared=False)
            self.linking.files.append(use)
        for nested in sub.root.findall("asset/model"):
            model_file = nested.get("file")
            if model_file:
                self.bundle(sub, nested, model_file, folder=f"{path}/models", above=above)
                journal.write(nested, "file", f"{beside}/models/" + str(nested.get("file")).rsplit("/", 1)[-1])
        # Its files are already named from its present place: MuJoCo would put the folders in front of that once more.
        for compiler in sub.root.iterchildren("compiler"):
            for name in FOLDERS:
                journal.drop(compiler, name)


def _without_keys(path: str, content: bytes | Path) -> bytes | Path:
    if not isinstance(content, bytes) or not path.endswith(".xml"):
        return content
    root = etree.fromstring(content)
    remove_keys(root)
    return write(root)


def parse_held(unit: Unit, file: str, data: bytes, sink: Sink) -> Unit | None:
    """Parse a sub-model in memory. Its files are in memory too, relative to its own folder."""
    folder, _, name = join("", file).rpartition("/")
    return parse_text(
        data,
        sink,
        file=file,
        directory=Path(join(str(unit.directory), folder)) if folder else unit.directory,
        label=posixpath.splitext(name)[0],
        contents=FromFolder(unit.contents, folder),
        door=unit.door,
    )


def door_of_submodel(unit: Unit, path: Path, known: bytes | Path | None) -> Door:
    """Return the files that a sub-model may read: the model's, and those in its own folder if a recipe names it."""
    return unit.door if known is None else unit.door.wider((path.parent,))


def _same_bytes(one: bytes | Path, other: bytes | Path) -> bool:
    if one == other:
        return True
    try:
        first, second = (file if isinstance(file, bytes) else read_regular(file) for file in (one, other))
    except OSError:  # reported when all files are read
        return False
    return first == second
