"""Settings of `<compiler>` in a composition: those that a recipe gives for a file, and rules that are of one file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from mjcompose.base.diagnostic import Note, Path
from mjcompose.base.sink import Sink
from mjcompose.language.value import RecipeElement
from mjcompose.link.inertia import INERTIA_RULES
from mjcompose.link.linking import Linking
from mjcompose.plan.plan import Plan
from mjcompose.plan.steps import AddElement
from mjcompose.sources.reference import CompilerSettings
from mjcompose.text.node import locate
from mjcompose.tree.files import SourceSettings
from mjcompose.tree.unit import Unit

UNUSED = "compiler-unused"
_DEFAULT = SourceSettings()
_BODIES = ("body", "flexcomp", "composite")


def check_assumed(settings: CompilerSettings, unit: Unit, plan: Plan, at: Path, sink: Sink) -> None:
    """Warn of settings that the recipe gives for a file, and that the file writes itself with another value."""
    for name, value in settings:
        written = [each for each in unit.root.iterchildren("compiler") if str(each.get(name) or "").strip()]
        if not written or str(written[-1].get(name)).split() == value.split():
            continue
        own = str(written[-1].get(name))
        message = f'`{name}` here has no effect: `{unit.file}` writes `{name}="{own}"` itself'
        notes = (Note("it is written here", unit.origins.span(written[-1], unit.file, name)),)
        help = f"remove `{name}`, or correct it in a copy of the file"
        sink.warning(UNUSED, message, locate(plan.document, (*at, "compiler", name)), notes=notes, help=help)


def _in_words(bodies: Sequence[RecipeElement]) -> str:
    if len(bodies) > 1:
        return f"{len(bodies)} bodies"
    name = bodies[0].attributes.get("name", "")
    return f"the body `{name}`" if name else "the body"


def note_rules_of_base(plan: Plan, linking: Linking) -> None:
    """Note that rules about masses of the base do not reach the bodies that the recipe adds."""
    settings = linking.base.settings
    rules = [name for name in INERTIA_RULES if getattr(settings, name) != getattr(_DEFAULT, name)]
    added = [step for step in plan.steps if isinstance(step, AddElement) and any(_bodies((step.element,)))]
    if not rules or not added or not linking.composed:
        return
    listed = ", ".join(f"`{name}`" for name in rules)
    which = _in_words([body for step in added for body in _bodies((step.element,))])
    verb = "does" if len(rules) == 1 else "do"
    message = f"{listed} of `{linking.base.file}` {verb} not apply to {which} that the recipe adds"
    compilers = linking.base.root.iterchildren("compiler")
    places = ((name, each) for each in compilers for name in rules if each.get(name) is not None)
    notes = [
        Note(f"`{name}` is written here", linking.base.origins.span(each, linking.base.file, name))
        for name, each in places
    ]
    values = ", ".join(f"{name}: {getattr(settings, name)}" for name in rules)
    usable = all(name in ("boundmass", "boundinertia", "settotalmass") for name in rules)
    help = f"to apply the rule to the whole model, write `compiler: {{{values}}}` at the top of the recipe"
    help = help if usable else "write the mass and the inertia of these bodies, as the rules would give them"
    linking.sink.note("mass-rule", message, added[0].span, notes=notes, help=help)


def _bodies(elements: Iterable[RecipeElement]) -> Iterator[RecipeElement]:
    for each in elements:
        if each.tag in _BODIES:
            yield each
        yield from _bodies(each.children)
