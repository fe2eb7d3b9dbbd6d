"""Skin files have names of bodies inside: they follow a rename like every other reference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from composer.compose.editing import Editing
from composer.recipe.fault import Path as KeyPath
from composer.tree.files import file_attributes, join, written_path
from composer.tree.skin_file import BadSkin, rename_bones


def rename_in_skins(editing: Editing, names: Mapping[str, str], at: KeyPath) -> None:
    """Rewrite every skin file in which one of these bodies is a bone; one that cannot be read is left for later."""
    unit = editing.linking.base
    for element, _, written in list(file_attributes(unit.root)):
        if element.tag != "skin":
            continue
        use = next((each for each in editing.linking.files if each.element is element), None)
        path = written_path(unit.settings, element, written)
        if use is not None:
            known: bytes | Path = use.content if use.content is not None else Path(use.source)
        else:
            known = unit.contents.get(path, Path(join(str(unit.directory), path)))
        found: list[str] = []

        def new_name(name: str, found: list[str] = found) -> str:
            found.append(name)
            return names.get(name, name)

        try:
            content = rename_bones(known if isinstance(known, bytes) else known.read_bytes(), new_name)
        except OSError:
            continue
        except BadSkin as error:
            if found:
                editing.sink.error("bad-name", str(error), editing.span(at))
            continue
        if names.keys().isdisjoint(found):
            continue
        if use is not None:
            index = editing.linking.files.index(use)
            editing.linking.files[index] = use._replace(content=content, shared=False)
        else:
            unit.contents = {**unit.contents, path: content}
