"""Write a bundle for a target."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.scratch import scratch
from mjcompose.bundle import manifest as manifests
from mjcompose.bundle.bundle import LICENSES, MANIFEST, WORLDS, Bundle
from mjcompose.bundle.manifest import TargetRecord, UnsupportedFeature, files_of, from_json, with_manifest
from mjcompose.bundle.staging import write_files
from mjcompose.mujoco import engine
from mjcompose.mujoco.attributes import NameTable
from mjcompose.mujoco.index import CompiledIndex, compiled_order, index
from mjcompose.sources.context import Context
from mjcompose.targets.plain import CannotBePlain, plain
from mjcompose.targets.same import differences
from mjcompose.targets.table import FEATURES, PLAIN, TARGETS
from mjcompose.targets.target import Loss, grouped, in_words
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.mujoco.engine import Session

MJCF = ".xml"


def export(mujoco: Any, argument: dict[str, str]) -> dict[str, Any]:
    """Write the files that the target `name` reads for `model` into the folder `out`.

    It is called by `mjcompose.mujoco.engine.call`. It returns the losses, the differences between the plain text and
    the model (if there are any, no file is written), the names of the elements by kind, and, if MuJoCo can read the
    files, its index.
    """
    model = Path(argument["model"])
    out = Path(argument["out"])
    try:
        draft = plain(mujoco, model)
        written = PLAIN.write(draft)
        _put(out, written)
        again = mujoco.MjModel.from_xml_path(str(out / draft.output))
    except (CannotBePlain, ValueError) as error:
        return {"error": " ".join(str(error).split()), "losses": [], "differences": []}
    found: dict[str, Any] = {
        "error": None,
        "differences": list(differences(draft.model, again)),
        "names": NameTable(draft.model).names,
    }
    target = TARGETS[argument["name"]]
    if target is not PLAIN:
        for path in written:
            (out / path).unlink()
        for limit in target.limits:
            limit.apply(draft)
        _put(out, target.write(draft))
    made = out / draft.output
    found |= {"losses": [asdict(each) for each in draft.losses], "model": draft.output, "index": None}
    if made.suffix == MJCF and draft.mujoco_reads:
        found["index"] = asdict(index(mujoco.MjModel.from_xml_path(str(made)), mujoco))
    return found


def _put(folder: Path, files: dict[str, bytes]) -> None:
    for path, content in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)


def exported(bundle: Bundle, target: str, folder: Path, *, session: Session) -> dict[str, Any] | str:
    """Return the answer of `export`, which writes into `out` in a folder, or the reason that nothing can be written."""
    source = folder / "in"
    out = folder / "out"
    source.mkdir()
    out.mkdir()
    write_files(bundle, source)
    asked = {"name": target, "model": str(source / bundle.model), "out": str(out)}
    answer = engine.call(session, export, (), argument=asked)
    wrong = answer.value["error"] if answer.ok else answer.error or answer.crash
    if wrong is not None:
        return engine.without_folder(engine.without_folder(wrong, out), source)
    found: dict[str, Any] = answer.value
    return found


CANNOT = "target-cannot"
LOSS = "target-loss"
FAILED = "target-failed"


def aimed(bundle: Bundle, target: str, model: Unit, *, at: Span, context: Context, session: Session) -> Bundle | None:
    """Return the bundle that `target` reads, made from a bundle that MuJoCo has verified.

    The context reports errors and losses. `model` is the composed model, which knows where elements are
    written; `at` is the place of losses that belong to no element. The result is None if the target cannot express
    the model, or if MuJoCo reads the plain text as another model.
    """
    if WORLDS in bundle.files:
        context.sink.error(CANNOT, f"`{target}` cannot hold worlds", at, help="build without `--as worlds`")
        return None
    with scratch("target") as folder:
        found = exported(bundle, target, Path(folder), session=session)
        if isinstance(found, str):
            context.sink.error(FAILED, f"the model cannot be written for `{target}`: {found}", at)
            return None
        out = Path(folder, "out")
        files = [path for path in sorted(out.rglob("*")) if os.path.isfile(path)]
        made = {path.relative_to(out).as_posix(): path.read_bytes() for path in files}
    for each in found["differences"]:
        context.sink.error(
            FAILED,
            f"MuJoCo reads the plain text of the model back as a different model: {each}",
            at,
            cause=Cause(f"{FAILED} {target}", each),
        )
    losses = [Loss(**each) for each in found["losses"]]
    places = _Places(model, found["names"])
    for loss in losses:
        if loss.refused:
            cause = Cause(f"{loss.feature} {loss.why}", loss.shown)
            span = places.span(loss) or at
            context.sink.error(CANNOT, f"{loss.shown}: {loss.why}", span, help=loss.help, cause=cause)
    _warn(target, [loss for loss in losses if not loss.refused], places, at=at, context=context)
    if found["differences"] or any(loss.refused for loss in losses):
        return None
    return _bundle(bundle, target, found, made=made, losses=losses)


def _warn(target: str, losses: Sequence[Loss], places: _Places, at: Span, context: Context) -> None:
    title = TARGETS[target].title
    groups = sorted(grouped(losses), key=lambda group: group[0].otherwise)
    lines = [(places.span(group[0]) or at, in_words(title, group)) for group in groups]
    ignored = sum(not group[0].otherwise for group in groups)
    if not groups:
        return
    (span, message), *others = lines
    notes: list[Note] = []
    if others:
        if ignored > 1:
            message = f"{title} ignores {ignored} kinds of elements and attributes of the model"
        notes = [Note("\n".join(f"{place}: {words}" for place, words in lines))]
    help = "the manifest names all of these elements under `target`" if others else None
    context.sink.warning(LOSS, message, span, notes=notes, help=help)


def _bundle(
    bundle: Bundle, target: str, found: Mapping[str, Any], made: Mapping[str, bytes], losses: Sequence[Loss]
) -> Bundle:
    """Return the files, with the licenses and the manifest of the model from which they are made."""
    licenses = {path: text for path, text in bundle.files.items() if path.startswith(f"{LICENSES}/")}
    aimed = Bundle({**made, **licenses}, found["model"])
    manifest = from_json(bundle.files[MANIFEST])
    title = TARGETS[target].title
    left_out = tuple(
        UnsupportedFeature(
            feature=FEATURES[group[0].feature],
            tag=group[0].tag,
            why=in_words(title, group),
            count=len(group),
            names=tuple(loss.name for loss in group if loss.name),
        )
        for group in grouped(losses)
    )
    index = None if found["index"] is None else manifests.index_of(CompiledIndex.from_data(found["index"]))
    changed = {
        "model": aimed.model,
        "target": TargetRecord(name=target, left_out=left_out),
        "files": files_of(aimed),
        "index": index,
        "parts": (),
    }
    return with_manifest(aimed, manifest.model_copy(update=changed))


class _Places(Struct, frozen=False):
    """Finds the places where the elements of a compiled model are written."""

    model: Unit
    names: Mapping[str, Sequence[str]]
    _order: Mapping[str, Sequence[Node | None]] = field(default_factory=dict)

    def span(self, loss: Loss) -> Span | None:
        """Return the place of the element, or None for a copy that MuJoCo has made."""
        self._order = self._order or compiled_order(self.model.root)
        nodes = self._order.get(loss.kind, ())
        node = None
        if nodes and len(nodes) == len(self.names.get(loss.kind, ())) and None not in nodes:
            node = nodes[loss.number]
        elif loss.name:
            node = next((each for each in nodes if each is not None and each.get("name") == loss.name), None)
        return None if node is None else self.model.origins.span(node, self.model.file)
