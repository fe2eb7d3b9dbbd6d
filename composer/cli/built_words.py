"""The report of `mjcompose build` about a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer.bundle.beside import picture_of
from composer.cli.wanted import Wanted
from composer.diagnostics.secret import hide
from composer.expr.value import shown
from composer.tree.adopted import in_words

if TYPE_CHECKING:
    from composer.cache.result import Made


def said(made: Made, wanted: Wanted) -> str:
    """Return the report about a written model: JSON, or several lines of text."""
    out = hide(wanted.target(made.name, made.mujoco))
    if wanted.form == "json":
        import json

        return json.dumps(_data(made, wanted, out))
    return "\n".join(_lines(made, wanted, out))


def _data(made: Made, wanted: Wanted, out: str) -> dict[str, object]:
    answer: dict[str, object] = {
        "output": out,
        "name": made.name,
        "sha256": made.sha256,
        "sizes": dict(made.sizes or {}),
    }
    if made.merged:
        answer["merged"] = {kind: dict(names) for kind, names in made.merged.items()}
    if adopted := [each for each in made.adopted if each.is_written]:
        answer["adopted"] = [
            {"setting": each.setting, "value": each.value, "parts": each.parts} for each in adopted
        ]
    if made.excluded:
        answer["excluded"] = made.excluded
    if made.replaced:
        answer["replaced"] = dict(made.replaced)
    if wanted.licenses:
        answer["licences"] = [asdict(row) for row in made.licences]
    if wanted.picturing is not None:
        answer["picture"] = picture_of(made.name)
    if wanted.why:
        answer["built"] = made.is_new
        answer["why"] = list(made.why)
    return answer


def _lines(made: Made, wanted: Wanted, out: str) -> Iterator[str]:
    files, be = out, "is"
    if wanted.kind == "mjb":
        from composer.bundle.mjb import manifest_beside

        files, be = f"{out} and {manifest_beside(Path(out)).name}", "are"
    yield f"{files} {be} up to date" if made.is_written else f"wrote {files}"
    if sizes := made.sizes or {}:
        counted = ", ".join(_count(*each) for each in (
            (sizes["nbody"] - 1, "body", "bodies"), (sizes["nsensor"], "sensor"), (sizes["nkey"], "keyframe")
        ))  # fmt: skip
        yield f"  {made.name}: nq {sizes['nq']}, nv {sizes['nv']}, nu {sizes['nu']}, {counted}"
    else:
        yield "  not verified: MuJoCo has not compiled it"
    if wanted.picturing is not None:
        yield f"  picture {picture_of(made.name)}"
    yield from remarks(made, wanted)
    yield f"  contents sha256 {made.sha256}"
    if wanted.licenses and not made.licences:
        yield "  no licences: it takes nothing from other models"
    elif wanted.licenses:
        from composer.bundle.licence_table import licence_table

        yield licence_table(made.licences)


def remarks(made: Made, wanted: Wanted) -> Iterator[str]:
    """Yield one line each for adopted settings, the replaced output, merged assets, and why it was built or not."""
    yield from (f"  adopted {words}" for words in in_words(made.adopted))
    if made.excluded:
        pairs = "pair" if made.excluded == 1 else "pairs"
        yield f"  excluded {made.excluded} {pairs} of bodies from colliding: `mjcompose plan` names them"
    if made.replaced:
        yield _replacing(made.replaced)
    if made.merged:
        yield _merging(made)
    if wanted.why:
        if made.is_new:
            yield from (f"  built: {line}" for line in made.why)
        else:
            yield from (
                f"  not built again: {line}" for line in made.why or ("nothing that it depends on changed",)
            )


def _replacing(before: Mapping[str, Any]) -> str:
    if "recipe" in before:
        return f"  replaced the model of {before['recipe']}"
    values = ", ".join(f"{name} = {shown(value)}" for name, value in before.items())
    return f"  replaced the model with {values}"


def _merging(made: Made) -> str:
    plural = {"mesh": "meshes", "hfield": "hfields", "texture": "textures", "material": "materials"}
    counts = ", ".join(
        f"{len(names)} {kind if len(names) == 1 else plural[kind]}" for kind, names in made.merged.items()
    )
    return f"  merged {counts} into equal ones: the manifest and --json say which name stands for which"


def _count(number: int, noun: str, plural: str | None = None) -> str:
    return f"{number} {noun if number == 1 else plural or noun + 's'}"
