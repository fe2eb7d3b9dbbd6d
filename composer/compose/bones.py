"""Rename bodies in skin files, as in every other reference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from composer.compose.editing import Editing
from composer.recipe.fault import Path as KeyPath
from composer.tree.skin_file import BadBone, renamed_skin, skins


def rename_in_skins(editing: Editing, names: Mapping[str, str], at: KeyPath) -> None:
    """Rewrite every skin file in which one of these bodies is a bone."""
    unit, files = editing.linking.base, editing.linking.files
    for skin in skins(unit.root):
        use = next((each for each in files if each.element is skin.element), None)
        source = unit.source_of(skin.path)
        if use is not None:
            source = Path(use.source) if use.content is None else use.content
        try:
            content = renamed_skin(source, names.get)
        except BadBone as fault:
            editing.sink.error("bad-name", str(fault), editing.span(at))
            continue
        if content is None:
            continue
        if use is None:
            unit.contents = {**unit.contents, skin.path: content}
        else:
            # Not shared: another part may use the same file with the old name.
            files[files.index(use)] = use._replace(content=content, shared=False)
