"""A model that was composed under observation, and its answers to queries."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import field, replace
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.files import MJCF_FILES
from mjcompose.compose.compose import Composer
from mjcompose.compose.elements import settle_joints
from mjcompose.language.value import attribute_and_index
from mjcompose.link.bodies import place_words
from mjcompose.link.collect import collect
from mjcompose.link.files import Merged
from mjcompose.link.measure import measure_with
from mjcompose.link.source_check import check_source
from mjcompose.link.unit_keys import VECTORS
from mjcompose.plan.describe import acknowledge
from mjcompose.plan.matrix import check_sample
from mjcompose.plan.planner import make_plan
from mjcompose.plan.read import Given as ConcreteGiven
from mjcompose.plan.steps import EditElements, SetCollisions
from mjcompose.sources.context import Context
from mjcompose.trace import explanation, query, trace_words
from mjcompose.trace.explanation import AttributeExplained, ChangeExplained, ElementExplained, Explained, Reason
from mjcompose.trace.query import MIRRORED, RecipeLines, no_attribute, not_found, same_words
from mjcompose.trace.trace import TAG, AttributeChange, Life, NumberOrigin, ParentChange, Trace, key_origins, rows
from mjcompose.tree import classes as default_classes
from mjcompose.tree.classes import MAIN, ORIENTATIONS, Classes, class_in_force, given, levels, value
from mjcompose.tree.edit import attached_notes
from mjcompose.tree.parse import parse_file
from mjcompose.tree.pattern import BadPattern
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit

_URDF = "computed by MuJoCo from the URDF"
_WORKED_OUT = "computed by the edit"
_COMES_ALONG = "comes with the recipe's addition there"


@dataclass(eq=False)
class Traced:
    """A model, and the record of its elements."""

    model: Unit
    watch: Trace
    separator: str
    folder: Path
    merged: Merged = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.recipe_lines = RecipeLines(self.folder)
        self.classes = Classes(self.model.root)
        self.labels = query.labels(self.model.root)
        sections = self.model.root.iterchildren("default")
        declared = (each for section in sections for each in section.iter("default"))
        self.declared = {str(each.get("class") or MAIN): each for each in declared}

    def answer(self, asked: query.ExplainQuery, context: Context) -> Explained | None:
        """Return the answer to a query, or None if there is none, which is reported."""
        try:
            found = self.on_line(*asked.line) if asked.line else query.find(asked, self.model.root, self.separator)
        except BadPattern as bad:
            context.sink.error("selector", bad.message, help=bad.help)
            return None
        if not found and (shared := self._shared_for(asked)) is not None:
            found = [shared]
        if not found:
            elsewhere = attached_notes(self.model, asked.name) if asked.name else []
            not_found(asked, self.model.root, context.sink, notes=[*self._left_out(asked), *elsewhere])
            return None
        attribute = None
        if asked.attribute is not None:
            attribute, _ = attribute_and_index(asked.attribute)
            fitting = [
                node
                for node in found
                if attribute in kind_of(node).attributes or trace_words.is_derived(node, attribute)
            ]
            if not fitting:
                no_attribute(found[0], asked.attribute, context.sink)
                return None
            found = fitting
        if len(found) > 1:
            return tuple(self._listed(node, attribute) for node in found)
        return self.element(found[0]) if attribute is None else self.attribute(found[0], attribute)

    def element(self, node: Node) -> ElementExplained:
        life = self.watch.life(node)
        kind = kind_of(node)
        in_force = None
        steps = []
        values = []
        if kind.takes_class:
            in_force = self._in_force(node)
            for name in (each.name for each in default_classes.chain(node, self.classes)):
                declared = self.declared.get(name)
                unset = Reason("the top class, which sets nothing")
                steps.append(explanation.ClassStep(name, unset if declared is None else self._first_written(declared)))
            for attribute, level in given(node, kind, self.classes):
                span = self.written_at(level.writer, attribute.name)
                values.append(explanation.Given(attribute.name, str(level.text), str(level.name), span=span))
        children = node.iterchildren("*") if node.tag == "default" else ()
        sets = [
            explanation.ListedElement(
                f"{child.tag!s} {name!s}", str(text), Reason("", self.written_at(child, str(name)))
            )
            for child in children
            if child.tag != "default"
            for name, text in child.items()
        ]
        holders = (self.labels[each] for each in node.iterancestors() if each.tag == "worldbody" or query.name_of(each))
        return ElementExplained(
            label=self.labels[node],
            text=start_tag(str(node.tag), node.items(), closed=not len(node)),
            holder=next(holders, None),
            shared=self._shared_with(node),
            end_line=life.line if isinstance(life.owner, str) else None,
            written=tuple(self.written(life)),
            parts=tuple(self.parts(life)),
            changes=tuple(self.changes(life)),
            in_force=in_force,
            classes=tuple(steps),
            given=tuple(values),
            sets=tuple(sets),
        )

    def attribute(self, node: Node, name: str) -> AttributeExplained:
        if trace_words.is_derived(node, name):
            return self._derived(node, name)
        kind = kind_of(node)
        attribute = kind.attributes[name]
        steps = levels(node, kind, attribute, classes=self.classes)
        explained = []
        for step in steps:
            words = {"element": f"<{node.tag}>", "mujoco": "MuJoCo's default"}.get(step.kind, str(step.name))
            numbers = (step.text or "").split()
            is_part = step.taken and len(step.taken) < len(numbers)
            origin = self._level_origin(step.kind, step.name, step.writer, attribute=name)
            changes: tuple[ChangeExplained, ...] = ()
            if step.writer is not None and (step.text is not None or step.kind == "element"):
                changes = tuple(self.changes(self.watch.life(step.writer), name))
            explained.append(
                explanation.LevelExplained(
                    step.kind,
                    words,
                    step.text,
                    wins=bool(step.taken),
                    span=origin.span,
                    changes=changes,
                    words=origin.words,
                    part_of_it=" ".join(numbers[step.taken.start : step.taken.stop]) if is_part else None,
                )
            )
        others = [other for other in ORIENTATIONS if other != name and node.get(other)] if name in ORIENTATIONS else []
        note = "`{}` is written on the element too: only one of several orientations counts"
        return AttributeExplained(
            label=self.labels[node],
            attribute=name,
            value=value(steps),
            levels=tuple(explained),
            in_force=self._in_force(node) if kind.takes_class and attribute.in_default else None,
            about=attribute.doc or None,
            notes=tuple(map(note.format, others)),
            rows=tuple(row for _, row in self.key_rows(node, name)) if node.tag == "key" and name in VECTORS else (),
        )

    def _derived(self, node: Node, name: str) -> AttributeExplained:
        """Explain an attribute that other attributes determine: each of them is a level of its own."""
        found = trace_words.givers(node, name, self.classes)
        explained = [self.attribute(giver, attribute) for giver, attribute in found]
        levels = []
        for (giver, attribute), each in zip(found, explained, strict=True):
            called = f"<{giver.tag}>" if giver.tag == "inertial" else each.label
            for level in each.levels:
                if level.wins and (giver is not node or level.kind != "mujoco"):
                    place = {"element": "", "class": f", class {level.name}", "mujoco": f", {level.name}"}[level.kind]
                    levels.append(replace(level, kind="element", name=f"{called} {attribute}{place}"))
        said = trace_words.total(found, name, [each.value for each in explained]) if node.tag == "body" else None
        return AttributeExplained(
            label=self.labels[node],
            attribute=name,
            value=said,
            levels=tuple(levels),
            in_force=None,
            about=None,
            rows=(),
            notes=() if said is not None else (f"MuJoCo computes `{name}` from these",),
        )

    def _listed(self, node: Node, attribute: str | None) -> explanation.ListedElement:
        text = None
        life = self.watch.life(node)
        written = list(self.written(life))
        reason = Reason(written[0].words, next((each.span for each in written if each.span), None))
        if attribute is not None and trace_words.is_derived(node, attribute):
            text = self._derived(node, attribute).value or "computed by MuJoCo"
        elif attribute is not None:
            kind = kind_of(node)
            steps = levels(node, kind, kind.attributes[attribute], classes=self.classes)
            text = value(steps)
            winner = next((step for step in steps if step.taken), steps[-1])
            words = {"element": "written on it", "mujoco": "MuJoCo's default"}.get(winner.kind, f"class {winner.name}")
            origin = self._level_origin(winner.kind, winner.name, winner.writer, attribute=attribute)
            reason = Reason("computed" if origin.words else words, origin.span)
        return explanation.ListedElement(self.labels[node], text, reason)

    def key_rows(self, key: Node, vector: str) -> Iterator[tuple[Node, explanation.RowExplained]]:
        """Yield the numbers of a key by their joint, actuator or mocap body, and by their origin."""
        for holder, numbers, origin in rows(self.model, key, vector, trace=self.watch):
            reason = self._row_reason(key, origin)
            if origin.kind == "entry":
                reason = self.recipe_lines.in_own_form(reason.span, numbers)
            written = origin.written or (None if reason.span is None else self.recipe_lines.text_of(reason.span))
            row = trace_words.row_explained(self.labels[holder], numbers, origin, reason=reason, written=written)
            yield holder, row

    def written(self, life: Life) -> Iterator[Reason]:
        if life.made_by is not None:
            cause = trace_words.creation_reason(life)
            yield Reason(cause.words, cause.span or (None if life.sources else self.place_of(life)))
            yield from (Reason("read from", self.place_of(source)) for source in life.sources)
        elif life.line is None and isinstance(life.owner, str):
            yield Reason(f"started by the recipe `{life.owner}`, which has no base")
        else:
            yield Reason("read from", self.place_of(life))

    def place_of(self, life: Life, attribute: str | None = None) -> Span | None:
        """Return the place where an element was first written; None for an element that is in no file."""
        if isinstance(life.owner, str) and life.line is None:
            return None
        return life.span(self.model.origins, attribute)

    def parts(self, life: Life) -> Iterator[Reason]:
        yield from (Reason(f"`{part.called}` {place_words(part)}", part.span) for part in life.parts)

    def on_line(self, file: str, line: int) -> list[Node]:
        def is_there(life: Life) -> bool:
            span = self.place_of(life)
            last = life.line if isinstance(life.owner, str) else None
            return span is not None and span.is_in(file) and span.line <= line <= (last or span.line)

        lives = ((node, self.watch.life(node)) for node in query.ordered(self.model.root))
        return [node for node, life in lives if any(map(is_there, (life, *life.sources)))]

    def changes(self, life: Life, only: str | None = None) -> Iterator[ChangeExplained]:
        if len(life.sources) == 1:
            for source in life.sources:
                yield from self.changes(source, only)
        yield from self._as_the_recipe_has_it(life, only)
        for change in life.changes:
            if isinstance(change, ParentChange):
                cause = trace_words.move_reason(change) if only is None else None
                if cause is not None:
                    yield ChangeExplained(None, None, None, reason=cause)
            elif only in (None, change.attribute) and change.cause.function is not settle_joints:
                name = "tag" if change.attribute == TAG else change.attribute
                yield ChangeExplained(name, change.before, change.after, reason=trace_words.change_reason(change, life))

    def _as_the_recipe_has_it(self, life: Life, only: str | None) -> Iterator[ChangeExplained]:
        """Yield values that a recipe writes in a different form from MJCF, such as angles in their own unit."""
        if life.made_by is None or life.made_by.is_pass or not callable(life.owner):
            return
        settled = {
            each.attribute: each.after or ""
            for each in life.changes
            if isinstance(each, AttributeChange) and each.cause.function is settle_joints
        }
        element = life.owner(None)
        for name, text in {**life.attributes, **settled}.items():
            span = life.owner(name)
            if only not in (None, name) or span == element:
                continue
            recipe = self.recipe_lines.text_of(span)
            if recipe is not None and not same_words(recipe, text):
                yield ChangeExplained(
                    name, recipe, text, reason=Reason("written in the recipe's own unit or form", span)
                )

    def _in_force(self, node: Node) -> Reason | None:
        force = class_in_force(node)
        if force.attribute is None or force.writer is None:
            return Reason("as the top class: no other is named")
        if force.attribute == "class":
            origin = self.origin_at(force.writer, "class")
            return Reason(f"by its own `class`{': ' if origin.words else ''}{origin.words}", origin.span)
        made = self.watch.life(force.writer).made_by
        if made is not None and made.is_pass and made.part is not None and force.writer.tag == "frame":
            return Reason(f"as the class of the part `{made.part.called}`", made.part.span)
        where = self.labels[force.writer]
        return Reason(f"by `childclass` of `{where}`", self.written_at(force.writer, "childclass"))

    def _first_written(self, node: Node) -> Reason:
        return next(self.written(self.watch.life(node)))

    def _level_origin(self, kind: str, name: str | None, writer: Node | None, attribute: str) -> Reason:
        if writer is not None:
            return self.origin_at(writer, attribute)
        node = self.declared.get(str(name)) if kind == "class" else None
        return Reason("", None if node is None else self._first_written(node).span)

    def written_at(self, node: Node | None, attribute: str) -> Span | None:
        return None if node is None else self.origin_at(node, attribute).span

    def origin_at(self, node: Node, attribute: str) -> Reason:
        """Return the origin of an attribute's value.

        Without words, the value is written at that place, apart from `changes`; words describe any other origin.
        """
        life = self.watch.life(node)
        if node.tag == "key" and attribute in (*VECTORS, "time") and node.get(attribute):
            origins = key_origins(self.model, node, attribute, trace=self.watch)
            span = trace_words.only_place(self._row_reason(node, origin) for origin in origins)
            return self.recipe_lines.in_own_form(span, str(node.get(attribute)) if attribute == "time" else None)
        replaces = life.made_by is not None and life.made_by.is_pass and len(life.sources) == 1
        return self.origin_of(life.sources[0] if replaces else life, attribute)

    def origin_of(self, life: Life, attribute: str) -> Reason:
        for change in reversed(life.of(attribute)):
            if not trace_words.rewrites(change.cause):
                cause = trace_words.change_reason(change, life)
                return Reason("" if cause.span else cause.words, cause.span)
        if life.made_by is not None and (life.made_by.is_pass or isinstance(life.made_by.done, SetCollisions)):
            cause = trace_words.value_reason(life, attribute)
            return cause if cause.words else self.recipe_lines.in_own_form(cause.span, life.attributes.get(attribute))
        return self._as_read(life, attribute)

    def _as_read(self, life: Life, attribute: str) -> Reason:
        """Return the place of an attribute that was read from a file or from the recipe."""
        if attribute not in life.attributes:
            written = next((each for each in reversed(life.of(attribute)) if each.before is None), None)
            return Reason("", self.place_of(life)) if written is None else trace_words.change_reason(written, life)
        if life.line is None and isinstance(life.owner, str):
            return Reason(f"the name of the recipe `{life.owner}`", None)
        span = self.place_of(life, attribute)
        text = life.attributes[attribute]
        if getattr(life.born.done, "format", None) == "urdf":
            return Reason("" if self.recipe_lines.has(span, text) else _URDF, span)
        if isinstance(life.born.done, EditElements) and not self.recipe_lines.has(span, text):
            return Reason(_WORKED_OUT, span)
        if callable(life.owner) and span == life.owner(None) and not self.recipe_lines.has(span, text):
            return Reason(_COMES_ALONG, span)
        if life.tag == "key" and not isinstance(life.owner, str) and not self.recipe_lines.has(span, text):
            return Reason(MIRRORED, span)
        return Reason("", span)

    def _row_reason(self, key: Node, origin: NumberOrigin) -> Reason:
        return trace_words.reason_of(origin, lambda change: trace_words.change_reason(change, self.watch.life(key)))

    def history(self, node: Node, attribute: str) -> list[Span]:
        """Return every place that influenced an attribute: first where it was read or created."""
        life = self.watch.life(node)
        read = life.sources[0] if len(life.sources) == 1 else life
        is_made = read is life and life.made_by is not None and life.made_by.is_pass
        found = [trace_words.creation_reason(life).span if is_made else self.place_of(read, attribute)]
        changes = (each for each in life.of(attribute) if not trace_words.rewrites(each.cause))
        found += [trace_words.change_reason(each, life).span for each in changes]
        return [span for span in dict.fromkeys(found) if span is not None]

    def _shared_for(self, asked: query.ExplainQuery) -> Node | None:
        """Return the asset of another copy that is used instead of the asset that a query names, or None."""
        for kind, names in self.merged.items():
            kept = None if asked.name is None else names.get(asked.name)
            if kept is not None and (asked.kinds is None or kind in asked.kinds):
                return next(each for each in self.model.root.iterfind(f"asset/{kind}") if each.get("name") == kept)
        return None

    def _shared_with(self, node: Node) -> tuple[str, ...]:
        """Return the names of the assets of other copies that an asset replaces."""
        names = self.merged.get(kind_of(node).path, {})
        return tuple(other for other, kept in names.items() if kept == query.name_of(node))

    def _left_out(self, asked: query.ExplainQuery) -> Iterator[Note]:
        replaced = {source.node for life in self.watch.lives.values() for source in life.sources}
        if asked.name is not None:
            for life in self.watch.gone:
                named = dict(life.items).get("name")
                if named is None or life.node in replaced:
                    continue
                prefixes = [part.prefix for part in life.parts]
                called = {"".join(reversed(prefixes[:count])) + named for count in range(len(prefixes) + 1)}
                if asked.name in called | {"".join(reversed(prefixes[at:])) + named for at in range(len(prefixes))}:
                    cause = trace_words.removal_reason(life)
                    yield Note(f"there was a {life.tag} `{named}`: {cause.words}", self.place_of(life))


def start_tag(tag: str, items: Iterable[tuple[object, object]], closed: bool = True) -> str:
    """Return the start tag of an element as XML; `closed`, it has nothing inside."""
    escapes = str.maketrans({"&": "&amp;", "<": "&lt;", '"': "&quot;"})
    attributes = "".join(f' {name!s}="{str(text).translate(escapes)}"' for name, text in items)
    return f"<{tag}{attributes}{'/' if closed else ''}>"


def explain(
    path: Path, asked: query.ExplainQuery, context: Context, sample: int = 0, given: ConcreteGiven | None = None
) -> Explained | None:
    """Return the answer to a query about the model of a recipe or an MJCF file, or None after an error.

    Errors go to `context.sink`. `sample` selects the draws of the model; 0 is the nominal model. `given` are values
    of parameters and variants.
    """
    traced = trace(path, context, sample, given=given)
    return None if traced is None else traced.answer(asked, context)


def trace(path: Path, context: Context, sample: int = 0, given: ConcreteGiven | None = None) -> Traced | None:
    """Compose the model under observation. It compiles only parts that MuJoCo has to measure."""
    watch = Trace()
    if path.suffix.lower() in MJCF_FILES:
        shown = context.shown(context.folder / path)
        for node in (given or {}).values():
            context.sink.error("unknown-name", f"`{shown}` is not a recipe and has no parameters", node.span)
        unit = None if given else parse_file(context.folder / path, context.sink, file=shown)
        if unit is None or not check_source(unit, context.sink):
            return None
        watch([unit], path)
        return Traced(unit, watch, "/", folder=context.folder)
    if path.suffix.lower() in (".zip", ".mjz", ".mjb") or os.path.isdir(context.folder / path):
        _no_recipe(path, context)
        return None
    plan = make_plan(path, context, given, sample=sample)
    if plan is None or not check_sample(plan, sample, context.sink):
        return None
    with watch.recording():
        composed = Composer(context, measure_with(context), watch=watch).compose(plan)
        acknowledge(plan, context.sink, context.shown, whole=False)
        if composed is None:
            return None
        collect(composed.model, composed.files, context.sink, shown=context.shown)
        watch([composed.model], collect)
    return Traced(composed.model, watch, plan.separator, folder=context.folder, merged=composed.merged)


def _no_recipe(path: Path, context: Context) -> None:
    from mjcompose.bundle.bundle import MANIFEST
    from mjcompose.bundle.manifest import from_json
    from mjcompose.bundle.read import ReadError, read

    help = "use its recipe"
    with suppress(ReadError, ValueError, KeyError):
        recipe = from_json(read(context.folder / path).files[MANIFEST]).recipe
        if recipe is not None:
            help = f"use its recipe: `mjcompose explain {recipe.path}`"
    message = f"`{context.shown(context.folder / path)}` has the model, but not where its elements come from"
    context.sink.error("source-kind", message, help=help)
