"""Formats of models that mjcompose does not read: the name of each, and how to get something that it reads."""

from __future__ import annotations

from pathlib import PurePath

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Foreign:
    """A format by its name; `advice` has `{file}` and `{stem}` for the path of a file with and without its suffix."""

    name: str
    advice: str

    def message(self, text: str) -> str:
        return f"`{text}` is {self.name}, which mjcompose does not read"

    def help(self, text: str) -> str:
        """Return what to do about a file.

        >>> SDF.help("world/arm.sdf")
        'convert it with Gazebo: `sdf2mjcf world/arm.sdf world/arm.xml`, of the package `sdformat-mjcf`'
        """
        suffix = PurePath(text).suffix
        return self.advice.format(file=text, stem=text.removesuffix(suffix) + "_mjcf" * (suffix == ".xml"))


SDF = Foreign(
    "SDFormat", "convert it with Gazebo: `sdf2mjcf {file} {stem}.xml`, of the package `sdformat-mjcf`"
)
USD = Foreign(
    "USD", "take the MJCF or URDF that it was made from, or let the program that made it export URDF"
)
_FORMATS = {
    **dict.fromkeys((".sdf", ".world"), SDF),
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), USD),
}


def foreign_format(path: PurePath) -> Foreign | None:
    """Return the format of a file by its suffix, if it is one of these. No I/O."""
    return _FORMATS.get(path.suffix.lower())
