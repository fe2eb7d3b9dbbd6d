"""Bundles of strangers, as archives and as folders: `verify`, and `load` without changes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import mjcompose
from fuzz.mutation import json_changed, zip_changed
from fuzz.target import RECIPES, Seed, Target, Tools
from mjcompose.bundle.remote import write_shared
from mjcompose.bundle.staging import write_folder
from mjcompose.bundle.write import write_archive
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.verify.stored import verify_stored

_RECIPE = RECIPES / "arm_gripper.yaml"


@cache
def _folder() -> TemporaryDirectory[str]:
    """A bundle as an archive, as a folder, and as one that shares its assets; removed with this process."""
    folder = TemporaryDirectory(prefix="mjcompose-fuzz-")
    built = build(ModelRequest(_RECIPE), Context(environment={}, folder=RECIPES))
    assert built is not None
    write_archive(built.bundle, Path(folder.name, "whole.zip"), {})
    write_folder(built.bundle, Path(folder.name, "folder"))
    write_shared(built.bundle, Path(folder.name, "shared", "cell"))
    return folder


def _archives(corpus: Path | None) -> Iterator[Seed]:
    yield Seed(Path(_folder().name, "whole.zip").read_bytes())


def _manifests(corpus: Path | None) -> Iterator[Seed]:
    for name in ("folder", "shared/cell"):
        yield Seed(Path(_folder().name, name, "manifest.json").read_bytes())


def check(path: Path, tools: Tools) -> str | None:
    verify_stored(path, Context(environment={}, folder=path.parent), tools.session)
    try:
        mjcompose.load(path)
    except mjcompose.LoadError:
        return None
    return None


def check_manifest(path: Path, tools: Tools) -> str | None:
    shared = path.parent / "beside"
    shutil.copytree(Path(_folder().name), shared)
    for name in ("folder", "shared/cell"):
        shutil.copyfile(path, shared / name / "manifest.json")
        if wrong := check(shared / name, tools):
            return wrong
    return None


ARCHIVE = Target("bundle", ".zip", _archives, zip_changed, check)
MANIFEST = Target("manifest", ".json", _manifests, json_changed, check_manifest)
