"""Builds a recipe and lets MuJoCo judge: every source in the composition is what it is when compiled alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import mujoco
from feature_cases.members import Member, members
from mjcompose.bundle.write import write
from mjcompose.mujoco.compare import KeyMode, option_differences
from mjcompose.mujoco.match import EXTRA
from mjcompose.mujoco.unchanged import compare
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


@dataclass
class Verdict:
    """`model` is None where nothing was built; then `codes` and `told` say why."""

    model: mujoco.MjModel | None = None
    codes: list[str] = field(default_factory=list)
    told: list[str] = field(default_factory=list)
    differences: list[str] = field(default_factory=list)
    text: str = ""


def judge(recipe: Path, out: Path) -> Verdict:
    """Build into the empty folder `out` and compare. Raises ValueError where the result does not compile."""
    context = Context(environment={}, folder=recipe.parent)
    built = build(ModelRequest(recipe, verified=False), context)
    found = context.sink.diagnostics
    verdict = Verdict(codes=[each.code for each in found], told=[each.message for each in found])
    if built is None:
        return verdict
    verdict.text = built.bundle.files[built.bundle.model].decode()
    write(built.bundle, f"{out}/", environment={})
    verdict.model = mujoco.MjModel.from_xml_path(str(out / built.bundle.model))
    verdict.differences = differences(list(members(recipe)), verdict.model)
    return verdict


def differences(everyone: list[Member], composed: mujoco.MjModel) -> list[str]:
    """What of any member is not as it is alone."""
    alone = [mujoco.MjModel.from_xml_path(str(member.file)) for member in everyone]
    named = [(member.prefix, model) for member, model in zip(everyone, alone, strict=True)]
    added = frozenset[str]().union(*(member.added for member in everyone))
    brought = {member.place.name for member in everyone if member.place.kind == "body"}
    found: list[str] = []
    for number, (member, model) in enumerate(zip(everyone, alone, strict=True)):
        renamed = {"key": {name: member.key(name) for name in _key_names(model)}}
        told = compare(
            model,
            composed,
            prefix=member.prefix,
            hung_on=member.place.mount(composed),
            renamed=renamed,
            keys=KeyMode.NONE if member.keys is None else KeyMode.MERGE,
            others=[other for place, other in enumerate(named) if place != number],
        )
        found += [
            f"{member.prefix or 'base'}: {each}"
            for each in told
            if not (each.field == EXTRA and (each.name in added or each.name in brought))
        ]
    return found


def options(base: Path, composed: mujoco.MjModel) -> list[str]:
    """What of the base's options is other in the composition."""
    return [str(each) for each in option_differences(mujoco.MjModel.from_xml_path(str(base)), composed)]


def _key_names(model: mujoco.MjModel) -> list[str]:
    return [name for index in range(model.nkey) if (name := model.key(index).name)]
