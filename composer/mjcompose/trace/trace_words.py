"""The changes of passes and steps in words, with the place of the reason.

A reason is the recorded one, or else the words of the pass or step.

It also finds the attributes that determine a value that MJCF writes elsewhere: the mass of a body is in its
`<inertial>` or its geoms, the `gainprm` of a `<position>` comes from its `kp`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Span
from mjcompose.base.words import value_text
from mjcompose.compose.checks import check_names
from mjcompose.language.assign import MASS
from mjcompose.link import numbers
from mjcompose.link.bodies import bodies
from mjcompose.link.collect import collect
from mjcompose.link.defaults import defaults
from mjcompose.link.files import add_file, dedup, share_in_copies
from mjcompose.link.inertia import has_mass
from mjcompose.link.keyframes import keyframes
from mjcompose.link.link import row_of
from mjcompose.link.settings import compiler
from mjcompose.link.subtree import Subtree
from mjcompose.link.world import sections
from mjcompose.mujoco.attributes import attributes as compared
from mjcompose.plan.plan import DropElements, Plan
from mjcompose.plan.steps import DrawValues, EditElements, Step
from mjcompose.text.node import find, locate
from mjcompose.trace.explanation import Reason, RowExplained
from mjcompose.trace.trace import AttributeChange, Life, NumberOrigin, ParentChange, TracedOperation
from mjcompose.tree.classes import Classes, childclass_of, own
from mjcompose.tree.files import read_settings
from mjcompose.tree.grammar import GRAMMAR, ElementType
from mjcompose.tree.journal import PARENT, Why
from mjcompose.tree.select import kind_of

_NOBODY = {"reference": "the reference configuration", "zero": "0, because no key sets it", "unknown": "not known"}


def row_explained(label: str, numbers: str, origin: NumberOrigin, reason: Reason, written: str | None) -> RowExplained:
    """Return the row; `reason` comes from `reason_of`, `written` is the text at its place."""
    on_the_way = [] if origin.joint is None else [Reason(f"from that number of the joint `{origin.joint}`")]
    on_the_way += [Reason("by `from`", span) for span in origin.taken]
    on_the_way += [Reason(f"moved with the part `{part}`", span) for part, span in origin.moved]
    if origin.lost is not None:
        on_the_way.append(Reason("an edit made the numbers there meaningless:", origin.lost.span))
    return RowExplained(label, numbers, origin.kind, reason=reason, written=written, on_the_way=tuple(on_the_way))


def reason_of(origin: NumberOrigin, edited: Callable[[AttributeChange], Reason]) -> Reason:
    """Return the cause that set the numbers, and its place; `edited` describes an edit or a draw."""
    if origin.change is not None:
        return edited(origin.change)
    if origin.kind == "mujoco":
        return Reason("filled in by MuJoCo, because the row ends in the middle of a joint", origin.span)
    return Reason(_NOBODY.get(origin.kind, ""), origin.span)


def only_place(reasons: Iterable[Reason]) -> Span | None:
    spans = {reason.span for reason in reasons if reason.words not in _NOBODY.values()}
    return spans.pop() if len(spans) == 1 else None


def of_step(cause: TracedOperation, owner: object, attribute: str | None, node: Node | None = None) -> Reason:
    """Return the action of a cause, and its place; `owner` wrote the element or its attribute."""
    done = cause.done
    if isinstance(done, Plan) and attribute == "model":
        named = find(done.document, ("name",)) is not None
        words = "`name` of the recipe" if named else "the name of the recipe's file"
        return Reason(words, locate(done.document, ("name",)) if named else None)
    if isinstance(done, Plan):
        return Reason("the recipe drops it", locate(done.document, ("base", "drop")))
    span = owned(owner, attribute) or getattr(done, "span", None)
    if isinstance(done, EditElements | DropElements):
        written_by_it = span is not None and span.file == done.span.file
        return Reason(done.words, span if written_by_it else done.span)
    if isinstance(done, DrawValues):
        drawn = None if node is None else _drawn(cause, node, done.field.name)
        value = "" if drawn is None else f": {value_text(drawn)} is drawn"
        return Reason(f"{done.reason}{value}", done.span)
    if isinstance(done, Step):
        return Reason(done.reason, span)
    return Reason(_summary(done), span if isinstance(span, Span) else None)


def owned(owner: object, attribute: str | None) -> Span | None:
    if isinstance(owner, Span):
        return owner
    if callable(owner):
        span = owner(attribute)
        return span if isinstance(span, Span) else None
    return None


def _drawn(cause: TracedOperation, node: Node, field: str) -> object | None:
    """Return the draw of a field for an element, or for the body whose mass the element determines."""
    if cause.linking is None:
        return None
    for each in (node, *node.iterancestors("body")):
        if field in (found := cause.linking.notes.drawn.get(each, {})):
            return found[field]
    return None


def _summary(done: object) -> str:
    """Return the words in the row of a pass, or those of another function or class."""
    row = row_of(done)
    if row is not None:
        return row.words
    return "what the subtree alone has" if isinstance(done, Subtree) else "composed"


_OF_SECTIONS = (sections, defaults, compiler, keyframes, bodies)
"""They move elements from a section of a part into the same section of the model, which needs no words."""


def change_reason(change: AttributeChange, life: Life) -> Reason:
    """Return the reason that an attribute changed."""
    return recorded(change.why) or of_step(change.cause, change.owner, change.attribute, node=life.node)


def creation_reason(life: Life) -> Reason:
    """Return the reason that an element exists that was not read from a file."""
    assert life.made_by is not None
    return recorded(life.whys.get(PARENT)) or of_step(life.made_by, life.owner, None)


def value_reason(life: Life, attribute: str) -> Reason:
    """Return the reason that an element that a pass created has this value of an attribute."""
    assert life.made_by is not None
    return recorded(life.whys.get(attribute)) or creation_reason(life)


def removal_reason(life: Life) -> Reason:
    """Return the reason that an element is gone."""
    assert life.gone is not None
    if isinstance(life.gone.done, Subtree):
        place = life.parts[0].span if life.parts else None
        return Reason(f"not needed by `{life.gone.done.body}`, the subtree that the recipe takes", place)
    return recorded(life.why_gone) or of_step(life.gone, None, None)


def move_reason(move: ParentChange) -> Reason | None:
    """Return the reason that an element moved, or None if the move has no meaning, as in a merged section."""
    cause = move.cause
    reason = recorded(move.why)
    if reason is not None or cause.function in _OF_SECTIONS:
        return reason
    if move.before is not None and move.after is not None and move.before.tag == move.after.tag == "mujoco":
        return None
    return of_step(cause, None, None)


def recorded(why: Why | None) -> Reason | None:
    """Return the reason that a pass or step recorded itself."""
    because = None if why is None else why()
    return None if because is None else Reason(because.words, because.span)


def rewrites(cause: TracedOperation) -> bool:
    """Return whether a cause only rewrites a value or renames it. If so, the value keeps its origin."""
    row = row_of(cause.done)
    return (
        row.rewrites if row is not None else cause.function in (add_file, collect, check_names, share_in_copies, dedup)
    )


_INERTIA = "diaginertia"


def is_derived(node: Node, name: str) -> bool:
    """Return whether recipes have this attribute for the element and MJCF does not write it there."""
    return name in derived_names(kind_of(node))


def derived_names(kind: ElementType) -> tuple[str, ...]:
    """Return the attributes that `edit`, `randomize` and `check: equal` accept beyond those in the grammar."""
    if kind.path == "body":
        return (MASS, _INERTIA)
    if kind.family != "actuator":
        return ()
    return tuple(name for name in compared(kind.family) if name not in kind.attributes)


def givers(node: Node, name: str, classes: Classes) -> list[tuple[Node, str]]:
    """Return the elements and attributes in effect that determine it."""
    if node.tag == "body":
        return list(_of_body(node, name, classes))
    general = GRAMMAR.element("actuator/motor").attributes
    return [(node, each) for each in kind_of(node).attributes if each not in general]


def total(found: list[tuple[Node, str]], name: str, values: list[str | None]) -> str | None:
    """Return the value if the elements write it, or None if MuJoCo computes it."""
    if not found and name == MASS:
        return "0"
    if len(found) == 1 and found[0][1] == name and found[0][0].tag == "inertial":
        return values[0]
    if name != MASS or any(attribute != MASS for _, attribute in found):
        return None
    return numbers.text([sum(numbers.first(str(value)) for value in values)])


def _of_body(body: Node, name: str, classes: Classes) -> Iterator[tuple[Node, str]]:
    rule = read_settings(body.getroottree().getroot()).inertiafromgeom
    geoms = [geom for geom in own(body, "geom") if has_mass(geom, classes)]
    inertials = own(body, "inertial")
    if inertials and not (rule == "true" and geoms):
        written = next((each for each in (name, "fullinertia") if inertials[-1].get(each)), name)
        yield inertials[-1], MASS if name == MASS else written
        return
    if rule != "false":
        for geom in geoms:
            mass = classes.effective(geom, childclass_of(geom), MASS)
            yield geom, "density" if mass is None else MASS
