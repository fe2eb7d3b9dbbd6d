"""Cases that are one text file each: their settings, the files that they begin with, and what is expected.

    errors: 2
    -- recipe.yaml --
    recipe: 1
    base: ./arm.xml
    -- arm.xml --
    <mujoco/>
    -- expected --
    recipe.yaml:2:7: error[…]: …

Above the first `--` line stand settings, `key: value`, and comments that begin with `#`. The last section is `expected`.
What is no text (a mesh, a picture, a file in another encoding) stands in the folder beside, which has the name of the case.
"""

from __future__ import annotations

import os
import re
import shutil
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

_SECTION = re.compile(r"^-- (\S.*) --\n", re.MULTILINE)
_EXPECTED = "expected"
_COUNT = re.compile(r"\(\d+ in all\)")


def uncounted(text: str) -> str:
    """The text without the lengths of lists that it cuts off, which each new key or attribute changes.

    >>> uncounted("keys that exist: model, site, … (27 in all)")
    'keys that exist: model, site, … (… in all)'
    """
    return _COUNT.sub("(… in all)", text)


@dataclass(frozen=True)
class Case:
    """A case by the path of its file."""

    path: Path

    @property
    def id(self) -> str:
        """The case with its topic: `limits/limit_dofs`."""
        return f"{self.path.parent.name}/{self.path.stem}"

    @cached_property
    def _sections(self) -> list[str]:
        """The head, then names and texts by turns."""
        return _SECTION.split(self.path.read_text(encoding="utf-8"))

    @cached_property
    def settings(self) -> dict[str, str]:
        lines = [line for line in self._sections[0].splitlines() if line and not line.startswith("#")]
        return dict(line.split(": ", 1) for line in lines)

    @cached_property
    def texts(self) -> dict[str, str]:
        """The files of the case that are text, by their paths."""
        names = self._sections[1::2]
        texts = self._sections[2::2]
        assert names[-1] == _EXPECTED and len(set(names)) == len(names), f"the sections of {self.path}: {names}"
        return dict(zip(names[:-1], texts[:-1], strict=True))

    @property
    def expected(self) -> str:
        return self._sections[-1]

    def lay(self, folder: Path) -> Path:
        """Writes all files of the case into a folder, which is made."""
        folder.mkdir(parents=True)
        if (beside := self.path.with_suffix("")).is_dir():
            shutil.copytree(beside, folder, dirs_exist_ok=True)
        for name, text in self.texts.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8", newline="\n")
        return folder

    def check(self, text: str) -> str:
        """What is expected; with `UPDATE_EXPECTED` in the environment the text, which is written into the case."""
        if not os.environ.get("UPDATE_EXPECTED") or text == self.expected:
            return self.expected
        head = self.path.read_text(encoding="utf-8").removesuffix(self.expected)
        self.path.write_text(head + text, encoding="utf-8", newline="\n")
        return text


def cases(folder: Path) -> list[Case]:
    """The cases in a folder and in the folders of topics below it."""
    found = [*folder.glob("*.txt"), *folder.glob("*/*.txt")]
    return [Case(path) for path in sorted(found) if not path.parent.with_suffix(".txt").exists()]
