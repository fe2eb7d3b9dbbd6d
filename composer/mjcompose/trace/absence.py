"""Why an element or an attribute is not in a model: the answers of `mjcompose explain --why-not`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.files import RECIPES
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean
from mjcompose.language.left_out import LeftOut, other_pieces
from mjcompose.language.value import attribute_and_index
from mjcompose.link.existence import WrittenElements
from mjcompose.link.linking import Part
from mjcompose.link.measure import compiled_names
from mjcompose.plan.read import Given as ConcreteGiven, expanded_recipe, read_recipe
from mjcompose.sources.context import Context
from mjcompose.text.node import Mapping
from mjcompose.trace import query
from mjcompose.trace.explanation import Absence, AbsenceExplained, Reason
from mjcompose.trace.query import ExplainQuery, no_attribute, not_found
from mjcompose.trace.trace import Life
from mjcompose.trace.trace_words import change_reason, creation_reason, removal_reason
from mjcompose.trace.traced import Traced, start_tag, trace
from mjcompose.tree.classes import levels
from mjcompose.tree.pattern import BadPattern, fitter, is_pattern
from mjcompose.tree.select import kind_of

_LEVELS = {"element": "the element itself gives it", "mujoco": "MuJoCo's default counts"}


class Absences:
    """The elements that a composition read or made and that its model does not have."""

    def __init__(self, traced: Traced, context: Context, left_out: Callable[[], Iterable[LeftOut]] = tuple) -> None:
        self.traced = traced
        self.context = context
        self.left_out = left_out
        self.present = set(traced.model.root.iter("*"))

    @cached_property
    def successors(self) -> dict[Node, Life]:
        """The elements of the model that replace or copy others, by the element that they replace or copy."""
        lives = [self.traced.watch.life(node) for node in self.present]
        return {source.node: life for life in lives for source in life.sources}

    @cached_property
    def absent(self) -> list[Life]:
        return [life for node, life in self.traced.watch.lives.items() if node not in self.present]

    def answer(self, asked: ExplainQuery) -> AbsenceExplained | None:
        """Explain why the element or attribute of the query is not in the model, or report an error and return None."""
        sink = self.context.sink
        if asked.number is not None or (asked.name is None and asked.line is None and asked.attribute is None):
            message = f"`{asked.text}` names no element that could be missing"
            sink.error("unknown-name", message, help="write its kind and its name, or its line: `gripper.xml:12`")
            return None
        try:
            found = self._absences(asked)
            there = self._there(asked)
        except BadPattern as bad:
            sink.error("selector", bad.message, help=bad.help)
            return None
        if asked.attribute is not None and there:
            return self._attribute(there[0], asked.attribute)
        found += [absence for node in there for absence in self._in_mujoco(node)]
        if not found and not there:
            found += self._not_in_recipe(asked)
        if found:
            return AbsenceExplained(asked.text, tuple(found))
        if there:
            label = self.traced.labels[there[0]]
            self._report_present(f"the {label}", asked.text, self.traced.place_of(self.traced.watch.life(there[0])))
        else:
            self._report_unknown(asked)
        return None

    def _there(self, asked: ExplainQuery) -> list[Node]:
        if asked.line is not None:
            return self.traced.on_line(*asked.line)
        return query.find(asked, self.traced.model.root, self.traced.separator)

    def _absences(self, asked: ExplainQuery) -> list[Absence]:
        """Return the elements that the query names, in the order in which they were read or made."""
        fits = self._fits(asked)
        found = [self._gone(life) for life in self.absent if fits(life)]
        if asked.name is not None and asked.line is None:
            lives = map(self.traced.watch.life, query.ordered(self.traced.model.root))
            found += [
                self._renamed(life, asked.name)
                for life in lives
                if fits(life) and query.name_of(life.node) != asked.name
            ]
        return found + list(self._merged(asked))

    def _not_in_recipe(self, asked: ExplainQuery) -> Iterator[Absence]:
        """Yield the entries with that name that the recipe writes and that a condition or a variant leaves out."""
        tags = asked.tags
        for left in self.left_out():
            reason = Reason(left.words, left.span)
            if asked.line is not None:
                if left.covers(*asked.line):
                    yield Absence(asked.text, "", (), reason)
                continue
            for name in left.names():
                # The elements of a part that is left out were never read: only its prefix is known.
                is_part = name.tag == "part" and (asked.name or "").startswith(f"{name.name}{self.traced.separator}")
                if is_part or (name.is_of(asked.name or "") and (tags is None or name.tag in tags)):
                    called = name.name if is_part else asked.name
                    yield Absence(f"{name.tag} {called}", "", (Reason("written in the recipe", name.span),), reason)

    def _fits(self, asked: ExplainQuery) -> Callable[[Life], bool]:
        tags = asked.tags
        if asked.line is not None:
            file, line = asked.line
            return lambda life: self._is_on(life, file, line)
        name = asked.name or ""
        if is_pattern(name):
            known = {each for life in self.absent for each in names_of(life)}
            meant = set(filter(fitter(name, lambda: known, self.traced.separator), known))
            return lambda life: (tags is None or life.tag in tags) and not meant.isdisjoint(names_of(life))
        return lambda life: (tags is None or life.tag in tags) and name in names_of(life)

    def _is_on(self, life: Life, file: str, line: int) -> bool:
        span = self.traced.place_of(life)
        return span is not None and span.line == line and span.is_in(file)

    def _gone(self, life: Life) -> Absence:
        written = tuple(self.traced.written(life))
        successor = self.successors.get(life.node)
        if successor is not None:
            label = self.traced.labels.get(successor.node, successor.tag)
            reason = creation_reason(successor)
            reason = replace(reason, words=f"written anew: {reason.words}")
            return Absence(_called(life), start_tag(life.tag, life.items), written, reason, now=label)
        reason = removal_reason(life) if life.gone is not None else self._left_behind(life)
        return Absence(_called(life), start_tag(life.tag, life.items), written, reason)

    def _left_behind(self, life: Life) -> Reason:
        """Return why an element of a part did not come into the model with the part."""
        part: Part | None = life.parts[-1] if life.parts else None
        if part is None:
            return Reason("no part of the model")
        if life.tag in ("key", "keyframe"):
            if part.keyframes == "none":
                return Reason(f"the recipe drops the keys of `{part.called}`", part.span)
            return Reason("a key of that name in the recipe or in another part replaces it", part.span)
        return Reason(f"a model has one `<{life.tag}>`, and this one is of the part `{part.called}`", part.span)

    def _renamed(self, life: Life, name: str) -> Absence:
        changes = [each for each in life.of(life.naming) if each.before is not None]
        reason = change_reason(changes[-1], life)
        label = self.traced.labels[life.node]
        called = f"{life.tag} {life.name if is_pattern(name) else name}"
        return Absence(called, start_tag(life.tag, life.items), tuple(self.traced.written(life)), reason, now=label)

    def _merged(self, asked: ExplainQuery) -> Iterator[Absence]:
        for kind, names in self.traced.merged.items():
            other = None if asked.name is None else names.get(asked.name)
            if other is not None and (asked.kinds is None or kind in asked.kinds) and not self._is_recorded(asked.name):
                reason = Reason("an equal one of another part is used")
                yield Absence(f"{kind} {asked.name}", "", (), reason, now=f"{kind} {other}")

    def _is_recorded(self, name: str | None) -> bool:
        return any(name in names_of(life) for life in self.absent)

    def _attribute(self, node: Node, written: str) -> AbsenceExplained | None:
        name, _ = attribute_and_index(written)
        kind = kind_of(node)
        attribute = kind.attributes.get(name)
        if attribute is None:
            no_attribute(node, written, self.context.sink)
            return None
        label = self.traced.labels[node]
        if node.get(name) is not None:
            span = self.traced.written_at(node, name)
            self._report_present(f"`{name}` of {label}", f"{label} {name}", span)
            return None
        life = self.traced.watch.life(node)
        steps = levels(node, kind, attribute, classes=self.traced.classes)
        winner = next((step for step in steps if step.taken), steps[-1])
        value = "" if winner.text is None else f", {winner.text}"
        instead = f"{_LEVELS.get(winner.kind, f'the class `{winner.name}` gives it')}{value}"
        dropped = next((each for each in reversed(life.of(name)) if each.after is None), None)
        reason = Reason("no file and no entry of the recipe writes it")
        text = ""
        if dropped is not None:
            reason = change_reason(dropped, life)
            text = f'{name}="{dropped.before}"'
        about = Absence(f"{name} of {label}", text, tuple(self.traced.written(life)), reason, instead=instead)
        return AbsenceExplained(f"{label} {name}", (about,))

    def _in_mujoco(self, node: Node) -> Iterator[Absence]:
        """Yield why the compiled model lacks an element that the model writes."""
        fault = self._lost_in_mujoco.get(node)
        if fault is not None:
            life = self.traced.watch.life(node)
            written = tuple(self.traced.written(life))
            yield Absence(_called(life), start_tag(life.tag, life.items), written, fault)

    @cached_property
    def _lost_in_mujoco(self) -> dict[Node, Reason]:
        model = self.traced.model
        names = compiled_names(model, self.context)
        if names is None:
            return {}
        written = WrittenElements.of(model.root)
        lost: dict[Node, Reason] = {}
        for fault in replace(written, dropped=frozenset()).faults(names):
            if not fault.is_missing or fault.element is None or not any(fault.names):
                continue
            setting = written.dropped_by(model.root, fault.kind)
            if setting is not None:
                compiler, name = setting
                words = f"MuJoCo leaves it out of the compiled model, by its `{name}`"
                lost[fault.element] = Reason(words, self.traced.written_at(compiler, name))
            elif fault.kind not in written.dropped:
                lost[fault.element] = Reason("MuJoCo drops it: the compiled model does not have it")
        return lost

    def _report_present(self, what: str, text: str, span: Span | None) -> None:
        help = f"to see where it comes from, leave out `--why-not`: `mjcompose explain MODEL '{text}'`"
        self.context.sink.error("not-missing", f"{what} is in the model", span, help=help)

    def _report_unknown(self, asked: ExplainQuery) -> None:
        names = sorted({name for life in self.absent for name in names_of(life)})
        help = None if asked.name is None else did_you_mean(asked.name, names)
        notes = [Note(f"among the elements that the model does not have, {help}")] if help else []
        not_found(asked, self.traced.model.root, self.context.sink, notes=notes)


def explain_absence(
    path: Path, asked: ExplainQuery, context: Context, sample: int = 0, given: ConcreteGiven | None = None
) -> AbsenceExplained | None:
    """Explain why an element is not in the model of a recipe or an MJCF file; return None after an error."""
    traced = trace(path, context, sample, given=given)
    if traced is None:
        return None
    # It reads and expands the recipe again, and only elements that were never made need it.
    left_out = partial(_left_out, path, context, given or {})
    return Absences(traced, context, left_out).answer(asked)


def _left_out(path: Path, context: Context, given: ConcreteGiven) -> tuple[LeftOut, ...]:
    """Return the entries that a recipe leaves out of this model; none for an MJCF file."""
    if path.suffix.lower() not in RECIPES:
        return ()
    own = replace(context, sink=Sink())
    concrete = expanded_recipe(path, given, own)
    written = read_recipe(path, own)
    if concrete is None or not isinstance(written, Mapping):
        return ()
    return (*concrete.left_out, *other_pieces(written, concrete.variants, concrete.scope))


def names_of(life: Life) -> set[str]:
    """Return every name that an element had, also as it is from the recipes around its part."""
    changed = (text for each in life.of(life.naming) for text in (each.before, each.after))
    names = filter(None, (life.name, *changed))
    prefixes = [part.prefix for part in life.parts]
    before = {"".join(reversed(prefixes[:count])) for count in range(len(prefixes) + 1)}
    before |= {"".join(reversed(prefixes[at:])) for at in range(len(prefixes))}
    return {prefix + name for name in names for prefix in before}


def _called(life: Life) -> str:
    named: Iterable[str] = (text for name, text in life.items if name == life.naming)
    return " ".join([life.tag, *named])
