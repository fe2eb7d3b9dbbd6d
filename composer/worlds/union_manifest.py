"""The manifest of a union: it lists the sources of its models instead of the models, which are temporary."""

from __future__ import annotations

from collections.abc import Sequence

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.manifest import Input, Manifest, Read, files_of, from_json, with_manifest

_LICENCES = "LICENSES/"


def of_sources(bundle: Bundle, models: Sequence[Bundle]) -> Bundle:
    """Return a union with the inputs, licences and recipe from the manifests of its models."""
    manifests = [from_json(each.files[MANIFEST]) for each in models]
    texts: dict[str, bytes] = {}
    inputs: dict[tuple[str, str], Input] = {}
    licences: dict[str, dict[str, None]] = {}
    read: dict[tuple[str, str], Read] = {}
    for model, manifest in zip(models, manifests, strict=True):
        moved = {
            path: _free(path, model.files[path], texts) for path in model.files if path.startswith(_LICENCES)
        }
        texts |= {moved[path]: model.files[path] for path in moved}
        for each in manifest.inputs:
            known = each.model_copy(
                update={"licences": tuple(moved.get(path, path) for path in each.licences)}
            )
            inputs.setdefault((each.path, each.sha256), known)
        for licence, parts in manifest.licences.items():
            licences.setdefault(licence, {}).update(dict.fromkeys(parts))
        read |= {(each.path, each.sha256): each for each in manifest.read}
    files = {path: content for path, content in bundle.files.items() if not path.startswith(_LICENCES)}
    whole = Bundle({**files, **texts}, bundle.model)
    made = from_json(bundle.files[MANIFEST])
    return with_manifest(whole, _updated(made, whole, manifests, inputs=inputs, licences=licences, read=read))


def _updated(
    made: Manifest,
    bundle: Bundle,
    models: Sequence[Manifest],
    inputs: dict[tuple[str, str], Input],
    licences: dict[str, dict[str, None]],
    read: dict[tuple[str, str], Read],
) -> Manifest:
    """Return the manifest without `parts`: a part of several models is compared with its source in each of them."""
    first = models[0]
    return made.model_copy(
        update={
            "recipe": first.recipe,
            "seed": first.seed,
            "inputs": tuple(inputs.values()),
            "parts": (),
            "adopted": first.adopted,
            "read": tuple(each for _, each in sorted(read.items())),
            "licences": {licence: tuple(parts) for licence, parts in sorted(licences.items())},
            "files": files_of(bundle),
            "union": len(models),
        }
    )


def _free(path: str, content: bytes, texts: dict[str, bytes]) -> str:
    """Return a path for a licence that no other text has."""
    number, free = 1, path
    while texts.get(free, content) != content:
        number += 1
        free = f"{_LICENCES}{number}/{path.removeprefix(_LICENCES)}"
    return free
