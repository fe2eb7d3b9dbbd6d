"""The changes to recipes that a page may request: each is checked, and changes one file or nothing."""

from __future__ import annotations

import contextlib
import json
import math
import os
from codecs import BOM_UTF8
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from typing import Any

from mjcompose.base.access import Door, door_of_user, folder_of_recipe
from mjcompose.base.alignment import common_ends
from mjcompose.base.diagnostic import Path as Steps, Span
from mjcompose.base.files import RECIPES, read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.rotation import Pose, normalize
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import ChangedError, replace_text
from mjcompose.language.attach import PLACES, prefix_fault
from mjcompose.language.forms.context import Settings
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.plan.steps import AngleSettings
from mjcompose.sources.fetching import model_files
from mjcompose.sources.menagerie import known_models
from mjcompose.text import node as yaml_tree
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Scalar, Sequence, TextChange, find, is_template, to_python
from mjcompose.tools.view.builder import Shown, Workshop
from mjcompose.tools.view.draft import DraftRefused, PoseDraft, RecipeDraft, Written, name_text, short
from mjcompose.tools.view.targets import MovableItem
from mjcompose.tree.pattern import is_pattern

_MOST = 1e4
"""No number of a page may be larger."""
_MOST_DONE = 200
_MOST_VERSIONS = 4
_MOST_SIZE = 1 << 18
_HINGE = 3
_ELSEWHERE: dict[str, Steps] = {
    "mirror": ("mirror",),
    "scatter": ("replicate", 0, "scatter"),
    "fromto": ("fromto",),
}
"""Keys that set a place other than by an offset."""
_CHANGED = "the model has changed: select it again"
_STALE = "`{}` has changed since this model was built, so nothing is written"
Answer = dict[str, Any]
Done = tuple[str, bytes, bytes, str]
"""A file, its text before and after, and a description of the change."""


class Writer:
    """Changes the recipes of a workshop's model. A page says which version of the model it shows.

    `_history` has for each recipe the texts that were written one after the other, starting with the text that was
    built.
    """

    def __init__(self, workshop: Workshop) -> None:
        self.workshop = workshop
        self._lock = Lock()
        self._now = workshop.shown
        self._known: dict[int, Shown] = {}
        self._history: dict[str, list[bytes]] = {}
        self._in_editor: dict[str, bytes] = {}
        self._done: list[Done] = []
        self._undone: list[Done] = []
        self._scene: tuple[int, Any] = (-1, None)

    def answer(self, said: Any) -> Answer:
        """Return the answer for the page; `refused` is the reason if nothing has changed."""
        acts: dict[str, Callable[[Any], Answer]] = {
            "look": self._look,
            "place": self._place,
            "edit": self._edit,
            "keyframe": self._keyframe,
            "free": self._free,
            "attach": self._attach,
            "models": self._models,
            "parameter": self._parameter,
            "undo": self._back,
            "redo": self._back,
            "fix": self._fix,
        }
        act = acts[said["kind"]]
        with self._lock:
            now = self.workshop.shown
            self.know(now)
            try:
                self._now = now if act in (self._back, self._fix) else self._version(said)
                found = act(said)
            except DraftRefused as refused:
                return {"refused": str(refused), **refused.more}
            except OutputError as error:
                return {"refused": error.diagnostic.message}
            except OSError as error:
                return {"refused": f"the recipe cannot be read: {(error.strerror or str(error)).lower()}"}
            undo, redo = (stack[-1][3] if stack else None for stack in (self._done, self._undone))
            return {**found, "undo": undo, "redo": redo}

    def know(self, shown: Shown) -> None:
        """Remember a model for pages that still show it."""
        self._known = dict([*self._known.items(), (shown.version, shown)][-_MOST_VERSIONS:])

    # -- the model of the page --------------------------------------------------------------------------------------

    def _version(self, said: Any) -> Shown:
        version = said["version"]
        found = self._known.get(version) if type(version) is int else None
        if found is None:
            raise DraftRefused(_CHANGED, stale=True)
        return found

    @property
    def scene(self) -> Any:
        if self._scene[0] != self._now.version:
            self._scene = self._now.version, json.loads(self._now.text)
        return self._scene[1]

    def _name(self, kind: str, number: Any) -> str:
        names = self.scene[kind]["name"]
        if type(number) is not int or not 0 <= number < len(names) or not names[number]:
            raise DraftRefused(f"this {kind} has no name by which a recipe could mean it")
        return str(names[number])

    def _own(self, file: str) -> Path:
        """Return the path of a recipe that may be written: one of the user's own, in the project's folder."""
        targets = self._now.targets
        path, recipe = (targets.paths.get(each) for each in (file, targets.recipe))
        return self._may_write(file, path, recipe)

    def _may_write(self, file: str, path: Path | None, recipe: Path | None) -> Path:
        if path is not None and recipe is not None and path.suffix.lower() in RECIPES:
            doors = Door.of([folder_of_recipe(recipe)]), door_of_user()
            if all(door.sees(path) for door in doors):
                if not os.access(path, os.W_OK):
                    raise DraftRefused(f"`{file}` may not be written")
                return path
        raise DraftRefused(f"it is written in `{file}`, which is not a recipe of your project")

    def _draft(self, file: str, said: Any, any: bool = False) -> RecipeDraft:
        """Return the draft of a recipe whose text the page shows, with the text that an editor has of it.

        Since the page's model was built, only the page may have changed the file, unless `any` text will do.
        """
        path = self._own(file)
        built = self._now.targets.texts.get(file)
        raw = read_regular(path, in_force().recipe_size)
        history = self._history.get(file, [])
        if not any and (built is None or (raw != built and not (raw in history[-1:] and built in history))):
            raise DraftRefused(_STALE.format(file), stale=True)
        for name, text in (said.get("texts") or {}).items():
            if os.path.realpath(name) == os.path.realpath(path) and text != raw.decode("utf-8-sig"):
                raw = text.encode()
        return RecipeDraft.of(file, path, raw)

    def _recipe(self, said: Any) -> RecipeDraft:
        return self._draft(self._now.targets.recipe, said)

    def _offset(self, target: MovableItem, said: Any) -> PoseDraft:
        mapping = target.mapping
        for key, path in _ELSEWHERE.items():
            if find(mapping, path) is not None:
                raise DraftRefused(f"`{key}` sets this place: change it there")
        if target.is_repeated:
            return self._row_offset(target, said)
        spans = [mapping.entries[key][1].span for key in ("pos", *ORIENTATIONS) if key in mapping.entries]
        files = list(dict.fromkeys(span.file for span in spans)) or [target.span.file]
        if len(files) > 1:
            raise DraftRefused(
                f"{' and '.join(f'`{each}`' for each in files)} set this place together: change it there"
            )
        draft = self._draft(files[0], said)
        holder = self._raw_path(spans[0], key=False)[:-1] if spans else self._raw_path(target.span, key=True)
        return self._offset_in(draft, holder, target, said)

    def _row_offset(self, target: MovableItem, said: Any) -> PoseDraft:
        """Return the offset of one turn of a `for`, which is in a row of a table."""
        columns = target.columns
        maker = f"the `for` at {target.span.file}:{target.span.line}"
        if not columns:
            message = f"{maker} makes this, and no table has its place: change the entry"
            used = self._parameters_of(target, said)
            raise DraftRefused(message, **({"parameters": used} if used else {}))
        if any(place.file not in self._now.targets.texts for place in columns.values()):
            raise DraftRefused(f"{maker} makes this from a table that is not in a recipe: change the table")
        rows = {(place.file, self._raw_path(place, key=False)) for place in columns.values()}
        holders = {(file, path[:-1]) for file, path in rows}
        if len(holders) > 1 or {path[-1] for _, path in rows} != set(columns):
            names = " and ".join(f"`{name}`" for name in columns)
            raise DraftRefused(f"{maker} reads {names} from columns with other names: change the table")
        if target.is_shared:
            raise DraftRefused(f"{maker} makes several from this row of its table: change the row")
        ((file, holder),) = holders
        return self._offset_in(self._draft(file, said), holder, target, said)

    def _parameters_of(self, target: MovableItem, said: Any) -> list[list[str]]:
        """Return the parameters in the expressions that give a target its place."""
        entries = (target.mapping.entries.get(key) for key in ("pos", *ORIENTATIONS))
        nodes = (each.node for entry in entries if entry is not None for each in yaml_tree.walk(entry[1]))
        templates = dict.fromkeys(node.span.template for node in nodes if node.span.template is not None)
        found = {name: number for text in templates for name, number in self._parameters_in(text, said)}
        return [[name, number] for name, number in found.items()]

    def _offset_in(self, draft: RecipeDraft, holder: Steps, target: MovableItem, said: Any) -> PoseDraft:
        known = self._in_editor.get(draft.file) == draft.raw or said.get("texts") is None
        saved = draft.tree if known else load(read_regular(draft.path), draft.file, Sink()) or draft.tree
        before = find(saved, holder)
        now = find(draft.tree, holder)
        if before is None or not isinstance(now, Mapping) or to_python(now) != to_python(before):
            raise DraftRefused("your unsaved text sets another place: save it first", stale=True)
        context = target.plan.angle_context
        found = PoseDraft(draft, holder, context.others.get(draft.file, context.whole))
        computed = found.computed
        if computed:
            key, text = computed[0]
            raise DraftRefused(f"`{key}` is computed: `{text}`", parameters=self._parameters_in(text, said))
        return found

    def _raw_path(self, span: Span, key: bool) -> Steps:
        """Return the path of a key or value in its own file, as it was built."""
        built = self._now.targets.texts.get(span.file)
        visits = [] if built is None else list(yaml_tree.walk(load(built, span.file, Sink()) or Mapping({}, span)))
        at = span.line, span.column
        keys = [each.path for each in visits if each.key and (each.key.span.line, each.key.span.column) == at]
        values = [each.path for each in visits if (each.node.span.line, each.node.span.column) == at]
        found = keys if key and keys else [each for each in values if len(each) == min(map(len, values))]
        if not found:
            raise DraftRefused(_STALE.format(span.file), stale=True)
        if len(found) > 1:
            raise DraftRefused("an alias repeats this entry: write it out first")
        return found[0]

    def _parameters_in(self, text: str, said: Any) -> list[list[str]]:
        """Return the parameters in an expression that the recipe sets as a number, each with its number."""
        with contextlib.suppress(ExpressionError, DraftRefused, OSError):
            tree = self._recipe(said).tree
            names = dict.fromkeys(each.name for each in Template.parse(text).parameters())
            return [[name, str(to_python(node))] for name in names if (node := _parameter(tree, name)[1]) is not None]
        return []

    def _also(self, file: str) -> str:
        """Return in words the other recipes and parts that use a recipe."""
        targets = self._now.targets
        if file == targets.recipe or targets.plan is None:
            return ""
        uses = sum(each.file == file for each in targets.plan.plans())
        name = os.fsencode(os.path.basename(file))
        top = Path(folder_of_recipe(targets.paths[targets.recipe]))
        own = {os.path.realpath(self._own(file))}
        own.add(os.path.realpath(targets.paths[targets.recipe]))
        others = 0
        for path in (top / each for each in model_files(top) if each.endswith(RECIPES)):
            with contextlib.suppress(OSError):
                others += os.path.realpath(path) not in own and name in read_regular(path, _MOST_SIZE)
        words = [f"{uses} parts of this model"] * (uses > 1)
        words += [f"{others} other recipe{'s' * (others > 1)}"] * (others > 0)
        return f"also changes {' and '.join(words)}" if words else ""

    # -- changes -------------------------------------------------------------------------------------------------------

    def _look(self, said: Any) -> Answer:
        """Report the current place of a target, or the reason that it cannot be moved."""
        offset = self._offset(self._target(said), said)
        file = offset.draft.file
        pose = offset.pose
        line = offset.mapping.span.line
        return {"pos": pose.pos, "quat": pose.quat, "also": self._also(file), "where": f"{file}:{line}"}

    def _place(self, said: Any) -> Answer:
        target = self._target(said)
        offset = self._offset(target, said)
        if target.is_repeated:
            written = self._move_row(offset, target, said)
        elif said.get("site") is None:
            written = offset.move(_pose(said))
        else:
            written = [self._to_site(offset, target, self._name("site", said["site"]))]
            written += offset.move(Pose(), anew=True)
        offset.draft.notes += [also] if (also := self._also(offset.draft.file)) else []
        return self._finish(offset.draft, f"{target.label}: {', '.join(written)}", said)

    def _move_row(self, offset: PoseDraft, target: MovableItem, said: Any) -> list[str]:
        """Write a pose into the columns of a row. Columns that the entry does not read stay as they are."""
        if said.get("site") is not None:
            raise DraftRefused("a `for` makes this part, and the others would move, too: change the entry")
        before = to_python(offset.mapping)
        written = offset.move(_pose(said))
        after = offset.draft.wanted
        for step in offset.holder:
            after = after[step]
        added = [key for key in after if key not in before]
        if added:
            raise DraftRefused(f"the table has no column `{added[0]}`: add it to the table and to the entry")
        unread = [key for key in after if after[key] != before[key] and key not in target.columns]
        if unread:
            raise DraftRefused(f"the entry does not read the column `{unread[0]}` of the table")
        return written

    def _target(self, said: Any) -> MovableItem:
        name, line, column = said["at"]
        target = self._now.targets.by_place.get((str(name), int(line), int(column)))
        if target is None:
            raise DraftRefused(_CHANGED, stale=True)
        return target

    def _to_site(self, offset: PoseDraft, target: MovableItem, name: str) -> str:
        draft = offset.draft
        holder = offset.holder
        if "attach" not in target.at[-2:-1]:
            raise DraftRefused("only a part can be attached to a site")
        outer = next((each for each in target.outer if name.startswith(each)), None)
        if outer is None:
            raise DraftRefused(f"`{name}` is outside the recipe that places this part")
        text = name_text(name.removeprefix(outer))
        said = next((each for each in PLACES if each in target.mapping.entries), None)
        node = None if said is None else find(offset.mapping, (said,))
        if said is not None and (not isinstance(node, Scalar) or is_template(node.text)):
            raise DraftRefused(f"`{said}` is computed, or another file sets it: change it there")
        draft.write((*holder, said or "site"), text)
        if said not in (None, "site"):
            draft.rename((*holder, str(said)), "site")
        return f"site: {text}"

    def _edit(self, said: Any) -> Answer:
        """Write an entry of `edit` that moves an element of a source; without `confirmed`, only report it."""
        kind = str(said["of"])
        if kind not in ("body", "site", "camera"):
            raise ValueError
        name = self._name(kind, said["index"])
        pose = _pose(said)
        draft = self._recipe(said)
        if is_pattern(name):
            raise DraftRefused(f"`{name}` would be a pattern in `select`")
        items = find(draft.tree, ("edit",))
        for at, item in enumerate(items.items if isinstance(items, Sequence) else ()):
            entry = find(item, ("set",))
            if isinstance(entry, Mapping) and to_python(find(item, ("select",)) or item) == {kind: name}:
                offset = PoseDraft(draft, ("edit", at, "set"), AngleSettings("radian"))
                if offset.form in (None, "quat") and "pos" in entry.entries and not offset.computed:
                    return self._finish(draft, f"{name}: {', '.join(offset.move(pose))}", said)
        numbers = {"pos": [short(each, 5) for each in pose.pos], "quat": [short(each, 6) for each in pose.quat]}
        values = ", ".join(f"{key}: [{', '.join(each)}]" for key, each in numbers.items())
        text = f"{{select: {{{kind}: {name_text(name)}}}, set: {{{values}}}}}"
        if said.get("confirmed") is not True:
            return {"offer": f"edit:\n  - {text}", "where": draft.file}
        draft.append("edit", text)
        return self._finish(draft, f"{name}: an entry of `edit`", said)

    def _keyframe(self, said: Any) -> Answer:
        """Write the joints and mocap bodies that the page has moved as a keyframe."""
        draft = self._recipe(said)
        name = str(said["name"])
        if find(draft.tree, ("keyframe", name)) is not None:
            raise DraftRefused(f"there is a keyframe `{name}`: choose another name")
        entry: dict[str, Written] = {}
        for key, kind in (("qpos", "joint"), ("mpos", "body"), ("mquat", "body")):
            moved = {self._name(kind, at): self._values(key, at, _numbers(values)) for at, values in said[key]}
            if moved:
                entry[key] = dict(moved)
        if said.get("hold") is True and self.scene["actuator"]["name"]:
            entry["ctrl"] = "hold"
        draft.write(("keyframe", name), entry)
        return self._finish(draft, f"keyframe {name}", said)

    def _values(self, key: str, number: int, values: list[float]) -> str:
        """Return the values of a joint or a mocap body in the form of a keyframe."""
        if key == "qpos" and self.scene["joint"]["type"][number] == _HINGE:
            return f"{short(math.degrees(values[0]), 4)}deg"
        texts = [short(each, 6) for each in values]
        return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"

    def _free(self, said: Any) -> Answer:
        draft = self._recipe(said)
        key = str(said["key"])
        if not isinstance(find(draft.tree, ("keyframe", key)), Mapping):
            raise DraftRefused(f"`{draft.file}` does not write the keyframe `{key}`: save the pose under another name")
        name = self._name("joint", said["joint"])
        values = _numbers(said["qpos"], 7)
        draft.numbers(("keyframe", key, "qpos", name), [short(each, 6) for each in values])
        return self._finish(draft, f"{name} in keyframe {key}", said)

    def _attach(self, said: Any) -> Answer:
        draft = self._recipe(said)
        prefix = str(said["prefix"])
        model = str(said["model"])
        plan = self._now.targets.plan
        fault = prefix_fault(prefix, Settings(separator=plan.separator if plan else "/"))
        if fault is not None:
            raise DraftRefused(fault.message)
        if find(draft.tree, ("attach", prefix)) is not None:
            raise DraftRefused(f"there is a part `{prefix}`: choose another name")
        if model not in self._models(said)["models"]:
            raise DraftRefused(f"`{model}` is not a model of this folder, and no part of the recipe has it")
        site = name_text(self._name("site", said["site"]))
        draft.write(("attach", prefix), f"{{model: {name_text(model)}, site: {site}}}")
        return self._finish(draft, f"attach {prefix}", said)

    def _models(self, said: Any) -> Answer:
        """Return the models for a new part: models of the recipe and of its folder, and robots of Menagerie."""
        targets = self._now.targets
        if targets.plan is None:
            raise DraftRefused("only a recipe can be changed here")
        used = (find(targets.plan.document, (*step.at, "model")) for step in targets.plan.parts)
        texts = [each.text for each in used if isinstance(each, Scalar)]
        recipe = targets.paths[targets.recipe]
        files = [f"./{each}" for each in model_files(recipe.parent) if each != recipe.name]
        robots = [f"menagerie:{robot}/{entry}" for robot, entry, _ in known_models(os.environ)]
        return {"models": list(dict.fromkeys([*texts, *files, *robots]))}

    def _parameter(self, said: Any) -> Answer:
        draft = self._recipe(said)
        name = str(said["name"])
        path, node = _parameter(draft.tree, name)
        (value,) = _numbers([said["value"]], 1)
        if node is None:
            raise DraftRefused(f"`{draft.file}` does not give `{name}` as a number")
        draft.set(path, float(short(value, 6)), TextChange(node.span, short(value, 6)))
        return self._finish(draft, f"params: {name}: {short(value, 6)}", said)

    def _fix(self, said: Any) -> Answer:
        """Carry out the fix of a diagnostic that the page shows, if its file is still as the build read it."""
        faults = self._now.faults
        fault = next((each for each in faults if each.text == said["text"] and each.fixed is not None), None)
        if fault is None or fault.fixed is None or fault.path is None:
            raise DraftRefused("this fault is not there any more")
        path = self._may_write(fault.file, fault.path, self.workshop.recipe)
        draft = RecipeDraft.of(fault.file, path, read_regular(path, in_force().recipe_size))
        if draft.text != fault.source:
            raise DraftRefused(_STALE.format(fault.file), stale=True)
        return self._finish(draft, fault.words, said, after=draft.encoded(fault.fixed))

    def _back(self, said: Any) -> Answer:
        """Restore the text from before the last change exactly, if nothing else has changed the file."""
        both = self._done, self._undone
        stack, other = both if said["kind"] == "undo" else both[::-1]
        if not stack:
            raise DraftRefused("there is nothing to undo or redo")
        file, before, after, words = stack[-1]
        draft = self._draft(file, said, any=True)
        if draft.raw != after and draft.raw != after.removeprefix(BOM_UTF8):
            raise DraftRefused(f"`{file}` has changed since: undo it in your editor", stale=True)
        found = self._put(draft, before, said)
        stack.pop()
        other.append((file, after, before, words))
        return {**found, "said": f"{'undone' if stack is self._done else 'done again'}: {words}"}

    def _finish(self, draft: RecipeDraft, words: str, said: Any, after: bytes | None = None) -> Answer:
        """Write a draft, or the whole text `after`, and remember it for undo."""
        after = draft.result() if after is None else after
        if after == draft.raw:
            return {"said": "it is written like this already"}
        found = self._put(draft, after, said)
        self._done = [*self._done[1 - _MOST_DONE :], (draft.file, draft.raw, after, words)]
        self._undone.clear()
        return {**found, "said": "; ".join([words, *draft.notes]), "file": draft.file}

    def _put(self, draft: RecipeDraft, after: bytes, said: Any) -> Answer:
        """Write a text, or send the replacement to the editor, which may have unsaved text."""
        if said.get("texts") is not None:
            if draft.raw == read_regular(draft.path):
                self._note(draft, after)  # the editor saves it
            else:
                self._in_editor[draft.file] = after
            edit = _difference(draft.text, after.decode("utf-8-sig"))
            return {"edits": [{"file": os.path.realpath(draft.path), **edit}]}
        try:
            recipe = self.workshop.recipe
            replace_text(
                draft.path,
                after,
                before=draft.raw,
                allowed=lambda: self._may_write(draft.file, draft.path, recipe),
            )
        except ChangedError:
            raise DraftRefused(_STALE.format(draft.file), stale=True) from None
        self._note(draft, after)
        return {}

    def _note(self, draft: RecipeDraft, after: bytes) -> None:
        history = self._history.get(draft.file, [])
        earlier = history if draft.raw in history[-1:] else [draft.raw]
        self._history[draft.file] = [*earlier[1 - _MOST_DONE :], after]


def _parameter(tree: Mapping, name: str) -> tuple[Steps, Scalar | None]:
    path: Steps = ("params", name)
    if isinstance(find(tree, path), Mapping):
        path = (*path, "default")
    node = find(tree, path)
    is_number = isinstance(node, Scalar) and isinstance(node.value, int | float) and not isinstance(node.value, bool)
    return path, node if isinstance(node, Scalar) and is_number else None


def _numbers(values: Any, count: int | None = None) -> list[float]:
    """Return the numbers of a page: `count` of them, finite, and of a size that a place can have."""
    found = [float(each) for each in values]
    if len(found) != (count or len(found) or 1) or not all(map(math.isfinite, found)):
        raise ValueError
    if any(abs(each) > _MOST for each in found):
        raise DraftRefused(f"a number here can be {_MOST:.0f} at most, so nothing is written")
    return found


def _pose(said: Any) -> Pose:
    x, y, z = _numbers(said["pos"], 3)
    quat = _numbers(said["quat"], 4)
    if math.hypot(*quat) < 1e-6:
        raise ValueError
    return Pose((x, y, z), normalize(quat))


def _difference(before: str, after: str) -> Answer:
    """Return the replacement: lines and columns from 0, in units of UTF-16, as editors count."""
    head, tail = common_ends(before, after)
    ends = []
    for at in (head, len(before) - tail):
        *above, last = yaml_tree.lines_of(before[:at])
        ends += [len(above), len(last.encode("utf-16-le")) // 2]
    return {"range": ends, "text": after[head : len(after) - tail]}
