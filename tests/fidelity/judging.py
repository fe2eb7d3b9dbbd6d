"""Judges one composition: built, compiled, each part as it is alone, and as MuJoCo's own attach makes it."""

from __future__ import annotations

import importlib.util
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from types import ModuleType

import mujoco
from fidelity import dmcontrol
from fidelity.building import Build, build
from fidelity.corpus import Attachment, Composition
from fidelity.decided import UNLIKE_MJSPEC
from fidelity.recipe import write_recipe
from fidelity.rival import attached
from mjcompose.mujoco.arrays import ROUNDING
from mjcompose.mujoco.compare import KeyMode, Roots, option_differences
from mjcompose.mujoco.match import Difference, Mount
from mjcompose.mujoco.unchanged import compare

Builder = Callable[[Composition, Path], Build]


@dataclass
class Verdict:
    """What came of one composition, as text that can be sent between processes."""

    id: str
    refused: str = ""
    built: bool = False
    compiled: bool = False
    diagnostics: str = ""
    parts: dict[str, list[str]] = field(default_factory=dict)
    counts: list[str] = field(default_factory=list)
    facts: list[str] = field(default_factory=list)
    rival: str = ""
    rival_differences: list[str] = field(default_factory=list)
    dm_control: str = ""
    options: list[str] = field(default_factory=list)
    error: str = ""
    seconds: float = 0.0
    unlike: str = ""

    @property
    def unchanged(self) -> bool:
        return self.compiled and not any(self.parts.values()) and not self.counts and not self.facts

    @property
    def like_rival(self) -> bool:
        """As MuJoCo's attach has it, but for what that has wrong itself; or it has nothing."""
        return self.compiled and (not self.rival_differences or bool(self.unlike))

    @property
    def fine(self) -> bool:
        if self.error:
            return False
        return not self.built and bool(self.diagnostics) if self.refused else self.unchanged and self.like_rival

    @property
    def first_differences(self) -> list[str]:
        found = [self.error] if self.error else []
        if not self.built and not self.refused:
            found += self.diagnostics.splitlines()[:1]
        if self.built and self.refused:
            found.append(f"was built, and should not: {self.refused}")
        found += [f"{prefix or 'base'}: {told}" for prefix, parts in self.parts.items() for told in parts[:2]]
        return found + self.counts[:2] + self.facts[:2] + [f"MjSpec: {told}" for told in self.rival_differences[:2]]


def by_recipe(composition: Composition, out: Path) -> Build:
    """What mjcompose makes of it."""
    return build(write_recipe(composition, out.parent), verified=bool(composition.refused))


def judge(composition: Composition, builder: Builder = by_recipe, roots: Roots = Roots.MOVED) -> Verdict:
    """Build in a folder of its own, compile, and compare. Raises nothing that MuJoCo or a build raises."""
    unlike = composition.unlike or UNLIKE_MJSPEC.get(composition.id, "")
    verdict = Verdict(composition.id, composition.refused, unlike=unlike)
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        done = builder(composition, Path(folder, "out"))
        verdict.diagnostics = done.diagnostics
        verdict.built = done.model is not None
        if verdict.built and not composition.refused:
            try:
                composed = done.load()
            except ValueError as error:
                verdict.error = f"does not compile: {error}".replace("\n", " ")
            else:
                verdict.compiled = True
                _compare(composition, composed, verdict, roots)
    verdict.seconds = time.perf_counter() - start
    return verdict


@lru_cache(maxsize=32)
def _alone(path: Path) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(path))


def _compare(composition: Composition, composed: mujoco.MjModel, verdict: Verdict, roots: Roots) -> None:
    alone = {
        path: _alone(path)
        for path in (composition.parent, *(attachment.child for attachment in composition.attachments))
    }
    parts = _part_differences(composition, alone, composed, roots)
    verdict.parts = {prefix: [str(found) for found in told] for prefix, told in parts.items()}
    verdict.counts = _counts(composition, alone, composed)
    if composition.expected:
        verdict.facts = _facts(composition, composed)
    if dmcontrol.version() is not None:
        verdict.dm_control = _of_dm_control(composition, alone)
    verdict.options = [str(found) for found in option_differences(alone[composition.parent], composed)]
    if not composition.compared:
        return
    try:
        rival = attached(composition)
    except ValueError as error:
        verdict.rival = f"fails: {str(error).splitlines()[0]}"
        return
    wrong = _part_differences(composition, alone, rival, Roots.KEPT)
    excused = {(found.kind, found.name, found.array) for told in wrong.values() for found in told}
    verdict.rival = f"changes the parts in {len(excused)} places" if excused else "right"
    unlike = compare(rival, composed, keys=KeyMode.PREFIX, tolerance=ROUNDING, ignore=_MOVED_IN_KEYS)
    verdict.rival_differences = [str(found) for found in unlike if (found.kind, found.name, found.array) not in excused]


def _of_dm_control(composition: Composition, alone: dict[Path, mujoco.MjModel]) -> str:
    composition = dmcontrol.renamed(composition)
    try:
        model = dmcontrol.attached(composition)
    except ValueError as error:
        return f"fails: {str(error).splitlines()[0]}"
    wrong = _part_differences(composition, alone, model, Roots.KEPT)
    places = sum(map(len, wrong.values()))
    return f"changes the parts in {places} places" if places else "right"


_MOVED_IN_KEYS = ("key_qpos", "key_qvel", "key_mpos", "key_mquat")
"""Attach leaves free bodies of a key where they were alone; the keys of a part are judged with the part."""

_COUNTED = (
    "nbody njnt ngeom nsite ncam nlight nmesh ntex nmat nhfield nskin nflex npair nexclude neq ntendon"
    " nsensor nkey nnumeric ntext ntuple nplugin nmocap nq nv nu na"
).split()


def _counts(composition: Composition, alone: dict[Path, mujoco.MjModel], composed: mujoco.MjModel) -> list[str]:
    found: list[str] = []
    at_least = composition.expected.get("at_least", {})
    for name in _COUNTED:
        given = (composition.expected.get("counts") or {}).get(name)
        if given is None:
            parts = [getattr(alone[attachment.child], name) for attachment in composition.attachments]
            worlds = len(parts) if name == "nbody" else 0
            given = getattr(alone[composition.parent], name) + sum(parts) - worlds
        if getattr(composed, name) != given:
            found.append(f"`{name}` is {getattr(composed, name)}, should be {given}")
    found += [
        f"`{name}` is {getattr(composed, name)}, should be at least {least}"
        for name, least in at_least.items()
        if getattr(composed, name) < least
    ]
    return found


def _part_differences(
    composition: Composition, alone: dict[Path, mujoco.MjModel], composed: mujoco.MjModel, roots: Roots
) -> dict[str, list[Difference]]:
    members = [("", alone[composition.parent])]
    members += [(attachment.prefix, alone[attachment.child]) for attachment in composition.attachments]
    found: dict[str, list[Difference]] = {"": compare(members[0][1], composed, keys=KeyMode.PREFIX)}
    for number, attachment in enumerate(composition.attachments, 1):
        found[attachment.prefix] = compare(
            alone[attachment.child],
            composed,
            prefix=attachment.prefix,
            hung_on=_mount(attachment, composed),
            keys=KeyMode.PREFIX,
            roots_in_keys=roots,
            others=[member for place, member in enumerate(members) if place != number],
        )
    return found


def _mount(attachment: Attachment, composed: mujoco.MjModel) -> Mount:
    x, y, z = attachment.pos
    w, a, b, c = attachment.quat
    return Mount.of(composed, site=attachment.site, body=attachment.body, pos=(x, y, z), quat=(w, a, b, c))


def _facts(composition: Composition, composed: mujoco.MjModel) -> list[str]:
    module = _facts_module(composition.parent.parent.parent / "facts.py")
    return [
        f"{path} {what}: expected {expected}, found {found}"
        for path, what, expected, found in module.diff(composition.expected["facts"], module.facts(composed))
        if not path.lstrip("/").startswith(composition.left_open or ("\0",))
    ]


@cache
def _facts_module(path: Path) -> ModuleType:
    """The corpus's own module of facts, read from the corpus."""
    spec = importlib.util.spec_from_file_location("corpus_facts", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
