"""Every code of a diagnostic with its summary, and the page that explains it."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from mjcompose.base.report import Paint

BY_TOPIC: dict[str, dict[str, str]] = {
    "Recipe": {
        "bare-angle": "an angle is written without its unit",
        "cannot-format": "a file has a form that has no canonical layout",
        "cells-not-checked": "a recipe has a matrix, and only one model of it was checked",
        "check-failed": "the model does not meet a check of your recipe",
        "expression": "an expression cannot be read or has no value",
        "measured-format": "a file of measurements has another form than expected",
        "measured-stale": "a file of measurements was measured with another version of the recipe",
        "missing-key": "a required key is missing",
        "out-of-range": "a number is outside of what is allowed",
        "recipe-version": "the recipe names no version of the language, or an unknown one",
        "unknown-key": "a key has no meaning in its place",
        "unused-allow": "`allow` names a warning that does not appear",
        "wrong-keyword": "a word is not one of the allowed ones",
        "wrong-length": "a list has too few or too many entries",
        "wrong-type": "a value has another type than expected",
    },
    "Identify": {
        "errors-not-noise": "the fitted model lacks something that the robot has",
        "held-out": "a fit follows a held-out recording far worse than the recordings that were fitted",
        "not-identifiable": "a number of the recipe cannot be fitted to a recording",
        "recording-column": "a column of a recording is missing, or is nothing of the model",
        "recording-kind": "a file is not a recording that can be read",
        "recording-sign": "a joint of a recording moves against its command",
        "recording-time": "the times of a recording are not those of one motion",
        "recording-unit": "numbers of a recording are far outside of what the model allows",
        "recording-value": "a value of a recording is not a number",
        "worse-than-recipe": "a fit follows a held-out recording worse than the recipe does",
    },
    "YAML": {
        "csv-syntax": "a CSV file is not a table with named rows and columns",
        "yaml-alias": "an alias names nothing; most often a glob that lacks its quotes",
        "yaml-alias-bomb": "aliases expand to far more than the file",
        "yaml-documents": "a file contains more than one YAML document",
        "yaml-duplicate-key": "a mapping has the same key twice",
        "yaml-empty": "a file is empty",
        "yaml-key": "a mapping key is not plain text",
        "yaml-merge-key": "the merge key `<<` is not part of the language",
        "yaml-not-utf8": "a file is not UTF-8 text",
        "yaml-syntax": "a file is not well-formed YAML",
        "yaml-tag": "a YAML tag does not belong to the language",
        "yaml-template-unquoted": "an expression inside `[ ]` or `{ }` lacks its quotes",
        "yaml-too-deep": "a file is nested too deeply",
        "yaml-too-large": "a file is too large",
    },
    "Names and selectors": {
        "bad-name": "a name has characters or a form that it cannot have",
        "interface-extra": "the model has names that its interface does not list",
        "interface-order": "the model cannot have the order of its interface",
        "name-clash": "two elements of one kind would have the same name",
        "reserved-prefix": "the prefix `base` always means the base",
        "selector": "a selector selects nothing, or another number of elements than expected",
        "separator-mismatch": "nested recipes use different prefix separators",
        "still-referred-to": "other elements refer to an element that an edit removes",
        "unknown-name": "a name does not exist in the model",
    },
    "Composition": {
        "attach-cycle": "parts are attached to each other in a circle",
        "attach-place": "the place of a part does not exist or cannot carry it",
        "class-clash": "two default classes would have the same name",
        "compiler-setting": "a compiler setting cannot be kept or set",
        "compiler-unused": "a compiler setting of a part has no effect, because its file writes it",
        "freejoint-on-body": "a free joint would be below another body",
        "mass-rule": "a rule about masses of the base does not reach bodies that the recipe adds",
        "mirror": "a part is not the mirror image of another part",
        "mocap-on-body": "a mocap body would be below another body",
        "option-conflict": "two parts ask for different values of one global setting",
        "part-changed": "a part differs from its source",
        "part-not-compared": "a part cannot be compared with its source",
        "plane-on-body": "a plane would be on a moving body",
        "scatter": "copies have no place on the surface that they are scattered over",
        "subtree-cut": "an element refers to both a subtree and the rest, and is omitted",
        "world-frame": "an element of a moved part depends on the axes or the origin of the world",
    },
    "Actuators and keyframes": {
        "convert-loss": "a converted actuator loses some of its behavior",
        "keyframe-conflict": "two keyframes disagree about the same entry",
        "keyframe-wrong": "a keyframe of the compiled model has a wrong number",
        "not-held": "no control holds the pose of a key",
        "scale-of-zero": "`scale` multiplies zero",
        "without-effect": "a value of the recipe changes nothing in the simulation",
        "stiff-actuator": "a servo is stiffer at its joint than any drive",
    },
    "Sources and lock": {
        "archive-refused": "an archive or repository is broken, too large or harmful",
        "asset-missing": "a mesh, texture or other file that a model names does not exist",
        "file-not-found": "a file or folder does not exist",
        "file-unreadable": "a file exists but cannot be read",
        "git-revision": "a git revision cannot be read",
        "license-missing": "a part has no license",
        "lock-invalid": "a lock cannot be read",
        "interface-changed": "the interface of the model differs from the lock",
        "lock-stale": "the lock does not match the recipe",
        "source-changed": "the bytes of a source differ from the lock",
        "source-cycle": "a recipe or model uses itself, directly or through others",
        "source-fetch": "a repository or archive cannot be fetched",
        "source-kind": "a model reference has an unknown form or file type",
        "source-not-found": "the model of a reference does not exist",
        "source-offline": "a source is not in the store, and `--offline` allows no download",
        "source-outside": "a model, recipe or bundle names a file that it may not read",
        "source-revision": "a repository has no such branch, tag or commit",
        "store-unusable": "the folder of fetched and built models cannot be used",
    },
    "Model files": {
        "not-mjcf": "an XML file is not an MJCF model",
        "not-missing": "`explain --why-not` names something that the model has",
        "not-supported": "valid MJCF or a valid recipe that mjcompose cannot handle yet",
        "unknown-attribute": "an element has no attribute of that name",
        "unknown-element": "MJCF has no element of that name in that place",
        "xml-include": "an `<include>` does not work",
        "xml-syntax": "a file is not well-formed XML",
    },
    "URDF and xacro": {
        "not-urdf": "a file with the name of a URDF is not URDF",
        "urdf-inertia": "a link of a URDF has an inertia that no body can have",
        "urdf-limits": "a joint of a URDF moves without limits, although its type has them",
        "urdf-mass": "links of a URDF have no mass, so their shapes decide it",
        "urdf-roots": "a URDF has several links without a parent",
        "urdf-unread": "elements of a URDF are not in the model",
        "xacro": "a template for xacro cannot be expanded",
    },
    "Meshes": {
        "mesh-look": "a color or texture of a mesh cannot be kept",
        "mesh-shape": "a mesh whose volume matters is flat or open",
        "mesh-size": "a mesh is implausibly large or small",
        "mesh-tools-missing": "a package that works on meshes is not installed",
        "mesh-unreadable": "a mesh cannot be read or converted",
        "mesh-unusable": "no shape can be made from a mesh",
    },
    "MuJoCo": {
        "limit-exceeded": "the model or the work exceeds a limit",
        "mujoco-crash": "MuJoCo crashed while it read or compiled the model",
        "mujoco-missing": "MuJoCo is not installed where mjcompose runs",
        "mujoco-rejects": "MuJoCo does not accept the model",
        "mujoco-timeout": "MuJoCo took longer than the limit",
        "mujoco-warning": "MuJoCo accepts the model and warns about it",
        "not-as-written": "MuJoCo drops or multiplies an element without an error",
        "unstable": "a simulation diverges, so a film of it cannot be made",
    },
    "Bundles and outputs": {
        "bundle-changed": "a file of a bundle differs from its manifest",
        "bundle-manifest": "the manifest of a bundle is missing, broken or about another model",
        "no-rendering": "pictures cannot be made on this machine",
        "no-server": "the page cannot be served at this address",
        "no-video": "films cannot be made on this machine",
        "output-full": "the disk of the output is full",
        "output-kind": "the kind of output is not clear from its name",
        "output-unwritable": "the output cannot be written",
    },
    "Targets": {
        "consumer-missing": "a program that should read the model is not installed",
        "not-installed": "a package or a compiler that this task needs is not installed, or is too old",
        "target-cannot": "a target cannot express the model",
        "target-failed": "a model could not be written for a target",
        "target-loss": "a target cannot express all of the model",
        "usd-loss": "USD does not contain all of the model",
        "usd-missing": "the converter to USD is not installed",
    },
    "Many worlds": {
        "draw-at-run-time": "a compiled model cannot take this draw",
        "not-a-world": "a model has other elements than the other worlds",
        "not-per-world": "worlds differ in a number that the simulator keeps only once",
        "worlds-padded": "cells as worlds need many more geoms than each of them has",
    },
    "Migration": {
        "migrate-cannot": "another version of MuJoCo cannot express an element of the model",
        "migrate-changed": "a migrated model behaves differently",
        "migrate-differs": "a migrated model compiles to another model",
        "migrate-python": "the MuJoCo that a model was written for cannot be run",
        "migrate-version": "the MuJoCo version of a model is not known",
    },
    "Clusters and workers": {
        "cluster-missing": "`--cluster` needs a package that is not installed",
        "cluster-unreachable": "a cluster does not answer, or the connection to it is lost",
        "cluster-worker": "a cluster worker would build other models than this machine",
        "worker-died": "a process that builds models of a matrix ended without an answer",
    },
    "Extensions": {
        "extension-broken": "code of another package that a recipe needs cannot be loaded",
        "extension-clash": "two installed packages provide the same word",
        "extension-refused": "a fetched recipe names code of another package",
    },
}
"""The summary of each code, by topic: the index of the errors has a section for each topic."""

CODES = dict(sorted((code, summary) for codes in BY_TOPIC.values() for code, summary in codes.items()))

RULES: set[str] = set()
"""The codes of the rules of the linter, which add themselves here and to `CODES`. Their pages are in `docs/rules`."""

OF_FILES = ("source-", "archive-", "store-", "lock-", "file-")
"""Prefixes of the codes about files and addresses that do not exist or cannot be reached."""

_PASTED = re.compile(r"(?:(?:error|warning|note)?\[)?([\w-]+)\]?:?")
_LINK = re.compile(r"\[([^]]+)\]\((?!\))[^)]*\)")
_CODE = re.compile(r"`([^`]+)`")
_ITEM = re.compile(r"(?:[-*]|\d+\.) ")
_BLOCK = re.compile(r"^```.*?^```[^\n]*$|^#[^\n]*$|(?:^(?!```|#)[^\n]*\S[^\n]*\n?)+", re.MULTILINE | re.DOTALL)
"""Code between fences, a title, or lines without an empty one."""


def code_of(text: str) -> str | None:
    """Return the code in a text, with or without the decoration of messages. None if it does not exist.

    >>> code_of("error[bare-angle]:"), code_of("bare-angle"), code_of("arm.yaml")
    ('bare-angle', 'bare-angle', None)
    """
    found = _PASTED.fullmatch(text)
    return found[1] if found and found[1] in CODES else None


def page(code: str) -> str:
    """Return the page as Markdown: the copy next to this file in an installed package, `docs` in a clone."""
    here = Path(__file__).resolve()
    folder = "rules" if code in RULES else "errors"
    installed = here.with_name("pages") / folder / f"{code}.md"
    path = installed if os.path.exists(installed) else here.parents[3] / "docs" / folder / installed.name
    return path.read_text(encoding="utf-8")


def address(code: str, urls: Iterable[str] | None = None) -> str | None:
    """Return the address of the page on the published site, or None; the package's metadata names the site."""
    project_urls = _urls() if urls is None else urls
    for each in project_urls:
        label, _, url = each.partition(", ")
        if label.lower() == "documentation":
            return f"{url.rstrip('/')}/{'rules' if code in RULES else 'errors'}/{code}.html"
    return None


@cache
def _urls() -> tuple[str, ...]:
    from importlib import metadata  # takes longer to import than a page takes to print

    try:
        return tuple(metadata.metadata("mjcompose").get_all("Project-URL") or ())
    except metadata.PackageNotFoundError:
        return ()


def in_terminal(markdown: str, width: int = 100, color: bool = False) -> str:
    paint = Paint(color)
    blocks = (found.rstrip("\n").split("\n") for found in _BLOCK.findall(markdown))
    return "\n\n".join("\n".join(_shown(block, width, paint)) for block in blocks)


def _shown(block: list[str], width: int, paint: Paint) -> Iterator[str]:
    first = block[0]
    if first.startswith("```"):
        yield from (paint("code", f"    {line}") if line else "" for line in block[1:-1])
    elif first.startswith("#"):
        yield paint("bold", first.lstrip("# "))
    elif first.startswith("|"):
        yield from _table(block, paint)
    else:
        for text, indent in _paragraphs(block):
            # Text between backticks is not broken, because it may be a line to paste.
            whole = _CODE.sub(lambda found: found[0].replace(" ", "\0"), _LINK.sub(r"\1", text))
            wrap = textwrap.TextWrapper(width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
            yield from (_colored(line.replace("\0", " "), paint) for line in wrap.wrap(whole))


def _paragraphs(block: list[str]) -> Iterator[tuple[str, str]]:
    text = ""
    indent = ""
    for line in block:
        item = _ITEM.match(line)
        if item is not None:
            if text:
                yield text, indent
            text = line
            indent = " " * len(item[0])
        else:
            text = f"{text} {line.strip()}" if text else line.strip()
    yield text, indent


def _table(block: list[str], paint: Paint) -> Iterator[str]:
    head, _, *body = [[cell.strip() for cell in _LINK.sub(r"\1", line).strip("|").split("|")] for line in block]
    widths = [max(map(len, column)) for column in zip(head, *body, strict=True)]
    for row in (head, *body):
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        yield paint("bold", line) if row is head else _colored(line, paint)


def _colored(line: str, paint: Paint) -> str:
    return _CODE.sub(lambda found: paint("code", found[0]), line)
