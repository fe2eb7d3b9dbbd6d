"""Rename bodies in skin files, as in every other reference."""

from __future__ import annotations

from collections.abc import Callable, Container
from pathlib import Path

from composer.dataclass import dataclass
from composer.diagnostics.call_site import call_site
from composer.mjcf.asset import Files
from composer.mjcf.errors import failure
from composer.mjcf.model import Model
from composer.tree.skin_file import BadBone, renamed_skin, skins

Skins = list[tuple[Model, dict[str, bytes | Path]]]
"""Models, and what their skin files are to be, by written path."""


@dataclass(frozen=True, slots=True)
class _Prefixes:
    """Replaces the prefix `old` of a name by `new`, except in the names in `own`, which are the model's own."""

    old: str
    new: str
    own: Container[str]

    def __call__(self, name: str) -> str | None:
        moved = name.startswith(self.old) and name not in self.own
        return self.new + name[len(self.old) :] if moved else None


def renamed(model: Model, rename: Callable[[str], str | None]) -> dict[str, bytes | Path]:
    """Return the new content of the skin files in which body names change, by their written paths.

    `rename` returns the new name of a body, or None if the name stays the same. Raises `MjcfError` for a name that
    does not fit into a skin file.
    """
    found: dict[str, bytes | Path] = {}
    for skin in skins(model.unit.root):
        try:
            content = renamed_skin(model.unit.source_of(skin.path), rename)
        except BadBone as fault:
            raise failure("bad-name", f"{fault}, `{skin.written}`", call_site()) from None
        if content is not None:
            found[skin.path] = content
    return found


def for_body(model: Model, old: str, new: str) -> Skins:
    """Return the new skin files of a model and of the models above it after a body is renamed."""
    found: Skins = []
    for here, prefix in model.levels():
        changed = renamed(here, {prefix + old: prefix + new}.get)
        if changed:
            found.append((here, changed))
    return found


def for_prefix(parent: Model, old: str, new: str) -> Skins:
    """Return the new skin files of a model and of the models above it after the prefix of a child changes."""
    found: Skins = []
    for here, prefix in parent.levels():
        changed = renamed(here, _Prefixes(prefix + old, prefix + new, here.names.declared.get("body", {})))
        if changed:
            found.append((here, changed))
    return found


def take(skins: Skins) -> None:
    """Set the new skin files on their models."""
    for model, files in skins:
        known = model.unit.contents
        model.unit.contents = (known if isinstance(known, Files) else Files(known)).with_files(files)
