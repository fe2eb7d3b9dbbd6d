"""Models read and written by `mjcompose.mjcf`, against lxml's parse and tostring of the same files."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

from lxml import etree
from mjcompose import mjcf

from bench.models import REPOSITORY
from bench.row import Row
from bench.timing import best_times

_LIMIT = 4.0
_ENTRIES = ("franka_emika_panda/panda.xml", "shadow_hand/left_hand.xml", "unitree_g1/g1.xml")


def rows() -> list[Row]:
    return [row for file in _files() for row in _of(file)]


def _of(file: Path) -> list[Row]:
    path = str(file)
    root = mjcf.from_path(file)
    tree = etree.parse(str(file))
    paths = [path, *(os.path.join(os.path.dirname(path), str(each.get("file"))) for each in tree.iter("include"))]
    best = best_times(
        {
            "parse": lambda: [etree.parse(each) for each in paths],
            "from_path": lambda: mjcf.from_path(path),
            "tostring": lambda: etree.tostring(tree),
            "to_xml_string": root.to_xml_string,
        },
        rounds=300,
        seconds=2,
    )
    return [
        Row("mjcompose.mjcf: from_path / lxml parse", best["from_path"] / best["parse"], _LIMIT, file.stem),
        Row(
            "mjcompose.mjcf: to_xml_string / lxml tostring", best["to_xml_string"] / best["tostring"], _LIMIT, file.stem
        ),
    ]


def _files() -> list[Path]:
    """Three robots of the Menagerie and the CMU humanoid, as far as they are at hand; else the project's own arm."""
    menagerie = os.environ.get("MENAGERIE_ROOT") or os.path.join(os.environ.get("MJCOMPOSE_CORPUS", ""), "models")
    found = [Path(menagerie, entry) for entry in _ENTRIES]
    dm_control = importlib.util.find_spec("dm_control")
    if dm_control is not None and dm_control.submodule_search_locations:
        found.append(Path(dm_control.submodule_search_locations[0], "suite", "humanoid_CMU.xml"))
    own = REPOSITORY / "recipes" / "models" / "arm6" / "arm6.xml"
    return [file for file in found if file.is_file()] or [own]
