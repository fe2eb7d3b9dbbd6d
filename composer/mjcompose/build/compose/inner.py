"""MJCF that attaches recipes gets their models in memory."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.files import Refused
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.build.plan.plan import Plan
from mjcompose.link.files import ASSETS, path_in_assets
from mjcompose.link.settings import FOLDERS
from mjcompose.tree.files import file_attributes, join, written_path
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write


@dataclass(slots=True)
class InnerModels:
    """Puts the models that a unit attaches into its contents, next to their files, as compositions have them.

    `plans` has the plans of recipes by their real paths; `compose` returns the model of a plan, or None after errors.
    """

    plans: Mapping[str, Plan]
    compose: Callable[[Plan], Unit | None]
    sink: Sink
    shown: Callable[[Path], str]
    count: int = 0

    def embed(self, unit: Unit, above: tuple[str, ...] = ()) -> bool:
        """Put all models that a unit attaches into its contents. Return whether there were no errors."""
        before, contents = self.sink.error_count, dict(unit.contents)
        for element in unit.root.iterfind("asset/model"):
            file = str(element.get("file") or "")
            if file and file not in unit.contents:
                sub = self._model(unit, element, join(str(unit.directory), file), above=above)
                if sub is not None:
                    self._put(unit, element, sub, contents=contents)
        unit.contents = contents
        return self.sink.error_count == before

    def _model(self, unit: Unit, element: Node, path: str, above: tuple[str, ...]) -> Unit | None:
        span, limits = unit.origins.span(element, unit.file, "file"), in_force()
        self.count += 1
        if (plan := self.plans.get(os.path.realpath(path))) is not None:
            return self.compose(plan)
        if path in above:
            message = f"the model `{self.shown(Path(path))}` contains itself"
            self.sink.error("source-cycle", message, span, help="remove this `<model>`, or name another file")
        elif len(above) >= limits.nesting:
            message = f"models attach models more than {limits.nesting} levels deep"
            self.sink.error("limit-exceeded", message, span, help=advice("nesting"))
        elif self.count > limits.submodels:
            message = f"there are more than {limits.submodels} models that models attach"
            if self.count == limits.submodels + 1:
                self.sink.error("limit-exceeded", message, span, help=advice("submodels"))
        else:
            sub = parse_file(Path(path), self.sink, file=self.shown(Path(path)), span=span, door=unit.door)
            return sub if sub is not None and self.embed(sub, (*above, path)) else None
        return None

    def _put(self, unit: Unit, element: Node, sub: Unit, contents: dict[str, bytes | Path]) -> None:
        """Put a model and its files into the contents of the unit that attaches it."""
        label, number = sub.label, 1
        while f"{ASSETS}/{unit.label}/models/{label}.xml" in contents:
            number += 1
            label = f"{sub.label}-{number}"
        folder = f"{ASSETS}/{unit.label}/models/{label}"
        taken: dict[str, bytes | Path] = {}
        for inner in sub.root.iterfind("asset/model"):  # they and their files are in memory already
            file = str(inner.get("file") or "")
            start = file.removesuffix(".xml") + "/"
            taken.update({path: data for path, data in sub.contents.items() if path == file or path.startswith(start)})
            inner.set("file", f"{label}/{file}")
        for each, attribute, name in list(file_attributes(sub.root)):
            written = written_path(sub.settings, each, name)
            source = sub.contents.get(written)
            try:
                source = Path(sub.door.admit(join(str(sub.directory), written))) if source is None else source
            except Refused as refused:
                refused.report(self.sink, sub.origins.span(each, sub.file, attribute), shown=self.shown)
                continue
            below = path = path_in_assets(sub.settings, written)
            number = 1
            while taken.setdefault(path, source) != source:
                number += 1
                path = f"{number}/{below}"
            each.set(attribute, f"{label}/{path}")
        for compiler in sub.root.iterchildren("compiler"):
            for name in (*FOLDERS, "strippath"):
                compiler.attrib.pop(name, "")
        contents.update({f"{folder}/{path}": data for path, data in taken.items()})
        contents[f"{folder}.xml"] = write(sub.root)
        if not element.get("name"):  # MuJoCo reads it from the file
            element.set("name", sub.model)
        element.set("file", f"{folder}.xml")
        unit.origins.texts.update(sub.origins.texts)
