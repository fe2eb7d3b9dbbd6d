"""Names of bodies in skin files, which follow a rename like every other reference."""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass
from pathlib import Path

from composer.mjcf.asset import Files, asset_of
from composer.mjcf.call_site import call_site
from composer.mjcf.errors import MjcfError, failure
from composer.mjcf.model import Model
from composer.tree.files import written_path
from composer.tree.settings import read_settings
from composer.tree.skin_file import BadBone, BadSkin, rename_bones

Skins = list[tuple[Model, dict[str, bytes | Path]]]
"""Models, and what their skin files are to be, by written path."""


@dataclass(frozen=True, slots=True)
class _Prefixes:
    """A new prefix for the names that have an old one and are not a model's own."""

    old: str
    new: str
    own: Container[str]

    def __call__(self, name: str) -> str | None:
        moved = name.startswith(self.old) and name not in self.own
        return self.new + name[len(self.old) :] if moved else None


def renamed(model: Model, rename: Callable[[str], str | None]) -> dict[str, bytes | Path]:
    """The skin files of a model in which names change. Raises `MjcfError` for a name that does not fit into one.

    `rename` gives None for what keeps its name. A file that cannot be read is told where all files are read.
    """
    found: dict[str, bytes | Path] = {}
    for skin in model.names.declared.get("skin", {}).values():
        file = skin.get("file")
        if not file:
            continue
        try:
            before = asset_of(model, "skin", str(file)).contents
            after = rename_bones(before, lambda name: rename(name) or name)
        except BadBone as fault:
            raise failure("bad-name", f"{fault}, `{file}`", call_site()) from None
        except (MjcfError, BadSkin):
            continue
        if after != before:
            found[written_path(read_settings(model.unit.root), skin, str(file))] = after
    return found


def for_body(model: Model, old: str, new: str) -> Skins:
    """What the skins of a model and of those above it are to be when one of its bodies gets another name."""
    found: Skins = []
    for here in (model, *model.ancestors()):
        changed = renamed(here, {old: new}.get)
        if changed:
            found.append((here, changed))
        old, new = here.prefix + old, here.prefix + new
    return found


def for_prefix(parent: Model, old: str, new: str) -> Skins:
    """The same for a model and those above it when what hangs on it gets another prefix."""
    found: Skins = []
    for here in (parent, *parent.ancestors()):
        changed = renamed(here, _Prefixes(old, new, here.names.declared.get("body", {})))
        if changed:
            found.append((here, changed))
        old, new = here.prefix + old, here.prefix + new
    return found


def take(skins: Skins) -> None:
    """Let the models have these files."""
    for model, files in skins:
        known = model.unit.contents
        model.unit.contents = (known if isinstance(known, Files) else Files(known)).with_files(files)
