"""The requested outputs: what is built, where it goes, and in which form."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.beside import file_name, hash_of
from composer.bundle.place import Place, is_address, place
from composer.dataclass import dataclass

if TYPE_CHECKING:
    from composer.bundle.form import Form
    from composer.cli.picturing import Picturing


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is built of a recipe, where it goes, and how it is reported; `picturing` draws a picture next to it."""

    out: str
    kind: Form
    verified: bool
    deduplicated: bool
    form: str
    why: bool = False
    licenses: bool = False
    picturing: Picturing | None = None

    def target(self, name: str, mujoco: str | None) -> str:
        """Return the output of a model, by its name and the version of MuJoCo that compiled it."""
        target = self.out.replace("{name}", file_name(name)).replace("{hash}", hash_of(name))
        if self.kind != "mjb":
            return target
        from composer.bundle.mjb import with_version

        return with_version(target, mujoco)

    def place(self, folder: Path, name: str, mujoco: str | None) -> Place | None:
        """Return the output of a model as a place, or None for standard output."""
        return None if self.out == "-" else place(folder, self.target(name, mujoco))

    def elsewhere(self, folder: Path) -> Wanted:
        """Return the same for a process that runs in another folder, without pictures."""
        slash = "/" if self.out.endswith("/") and not is_address(self.out) else ""
        return replace(self, picturing=None, out=f"{place(folder, self.out)}{slash}")

    @property
    def assets_above(self) -> int:
        """How many folders above a model's folder the folder of shared assets is."""
        return 2 if os.path.basename(os.path.dirname(self.out.rstrip("/"))) == "{hash}" else 1

    def text_beside(self, folder: Path) -> Path | None:
        """Return the folder from which text refers to its files, if only text is wanted."""
        if self.kind != "text":
            return None
        return folder if self.out == "-" else Path(os.path.abspath(folder / self.out)).parent


def kind_of_output(out: str | None, models: int = 1) -> Form:
    """Return the form for OUT. Raises OutputError if it is unclear, or if several models would go to one place."""
    from composer.bundle.form import Form, form_of
    from composer.bundle.output_error import OutputError

    if out is None:
        return Form.ARCHIVE
    kind = Form.TEXT if out == "-" else form_of(out)
    known = {"{name}", "{hash}", "{mujoco}"} if kind == "mjb" else {"{name}", "{hash}"}
    if unknown := next((word for word in _PLACEHOLDER.findall(out) if word not in known), None):
        help = f"write {' or '.join(f'`{word}`' for word in sorted(known))}, or leave the braces out"
        raise OutputError("output-kind", f"`{unknown}` stands for nothing in the output `{out}`", help)
    if is_address(out) and kind in (Form.TEXT, Form.USD):
        help = "write a bundle, such as `{name}.zip`"
        raise OutputError("output-kind", f"`{out}` cannot be an address: {_NO_ADDRESS[kind]}", help)
    if models > 1 and "{name}" not in out:
        folder = out if out.endswith("/") else f"{out}/"
        help = f"write for instance `-o '{folder}{{name}}/'` or `-o '{folder}{{name}}.zip'`"
        raise OutputError("output-kind", f"several models cannot all be `{out}`", help)
    return kind


_PLACEHOLDER = re.compile(r"\{\w+\}")
_NO_ADDRESS = {
    "text": "text alone names files of this machine",
    "usd": "USD is written by MuJoCo's converter, to this machine",
}
_NO_SHARING = {
    "archive": "a zip cannot refer to files outside of it",
    "text": "text alone names the sources' own files, and none is copied",
    "mjb": "MuJoCo's binary form has its assets in it",
    "usd": "USD has meshes in its layers",
}


def for_shared_assets(out: str | None, one: bool) -> tuple[str, Form]:
    """Return the output of models that share their assets, and its form. Raises OutputError if they cannot."""
    from composer.bundle.form import Form
    from composer.bundle.output_error import OutputError

    out = "build/{name}/" if out is None else out
    help = "write `--all -o 'build/{name}/'`"
    if one:
        raise OutputError("output-kind", "one model has nobody to share its assets with", help)
    kind = kind_of_output(out, models=2)
    if kind is not Form.FOLDER:
        raise OutputError("output-kind", f"`--shared-assets` is for folders: {_NO_SHARING[kind]}", help)
    above, _, last = os.path.dirname(out.rstrip("/")).rpartition("/")
    if "{name}" in above + last or "{hash}" in above or ("{hash}" in last and last != "{hash}"):
        raise OutputError("output-kind", f"the folders `{out}` do not stand side by side", help)
    return out, Form.SHARED
