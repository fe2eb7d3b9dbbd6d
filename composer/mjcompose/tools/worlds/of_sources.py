"""A model that is made of several others: its build and its manifest."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import MANIFEST, Bundle
from mjcompose.bundle.manifest import Input, Read, files_of, from_json, with_manifest
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.worlds.names import LoadError

_LICENSES = "LICENSES/"


def build_of_sources(
    recipe: Mapping[str, Any], path: Path, models: Sequence[Bundle], context: Context, session: Session
) -> Bundle:
    """Write a recipe, build it, and return it as the bundle of these models. Raises LoadError."""
    path.write_text(json.dumps(recipe))
    own = replace(context, sink=Sink(), timings=[], folder=path.parent)
    made = build(ModelRequest(path), own, session=session)
    if made is None:
        raise LoadError(own.sink.errors)
    return of_sources(made.bundle, models)


def of_sources(bundle: Bundle, models: Sequence[Bundle]) -> Bundle:
    """Return a union with the inputs, licenses and recipe from the manifests of its models."""
    manifests = [from_json(each.files[MANIFEST]) for each in models]
    texts: dict[str, bytes] = {}
    inputs: dict[tuple[str, str], Input] = {}
    licenses: dict[str, dict[str, None]] = {}
    read: dict[tuple[str, str], Read] = {}
    for model, manifest in zip(models, manifests, strict=True):
        moved = {path: _free(path, model.files[path], texts) for path in model.files if path.startswith(_LICENSES)}
        texts |= {moved[path]: model.files[path] for path in moved}
        for each in manifest.inputs:
            known = each.model_copy(update={"licenses": tuple(moved.get(path, path) for path in each.licenses)})
            inputs.setdefault((each.path, each.sha256), known)
        for license, parts in manifest.licenses.items():
            licenses.setdefault(license, {}).update(dict.fromkeys(parts))
        read |= {(each.path, each.sha256): each for each in manifest.read}
    files = {path: content for path, content in bundle.files.items() if not path.startswith(_LICENSES)}
    whole = Bundle({**files, **texts}, bundle.model)
    first = manifests[0]
    changes = {
        "recipe": first.recipe,
        "seed": first.seed,
        "adopted": first.adopted,
        "inputs": tuple(inputs.values()),
        "parts": (),  # a part of several models is compared with its source in each of them
        "read": tuple(each for _, each in sorted(read.items())),
        "files": files_of(whole),
        "union": len(models),
        "licenses": {license: tuple(parts) for license, parts in sorted(licenses.items())},
    }
    return with_manifest(whole, from_json(bundle.files[MANIFEST]).model_copy(update=changes))


def _free(path: str, content: bytes, texts: dict[str, bytes]) -> str:
    number = 1
    free = path
    while texts.get(free, content) != content:
        number += 1
        free = f"{_LICENSES}{number}/{path.removeprefix(_LICENSES)}"
    return free
