"""Which attributes are required, exclude each other or need each other: the rules of the grammar."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from composer.diagnostics.diagnostic import Note
from composer.grammar.element import Constraint, ElementType
from composer.recipe.fault import EXCLUSIVE, Fault, Path


def report_missing(
    kind: ElementType, present: Collection[str], owner: str, at: Path, faults: list[Fault]
) -> None:
    """Report all required attributes that are missing."""
    missing = [each for each in kind.attributes.values() if each.required and each.name not in present]
    if len(missing) == 1:
        faults.append(missing_key(owner, missing[0].name, at, doc=missing[0].doc))
    elif missing:
        names = " and ".join(f"`{each.name}`" for each in missing)
        notes = tuple(Note(f"`{each.name}` is: {each.doc}") for each in missing if _says(each.name, each.doc))
        help = f"write `{', '.join(f'{each.name}: …' for each in missing)}`"
        message = f"{owner} lacks {names}"
        absent_names = tuple(each.name for each in missing)
        faults.append(Fault("missing-key", message, at, key=True, notes=notes, help=help, names=absent_names))


def missing_key(owner: str, name: str, at: Path, doc: str = "") -> Fault:
    """Return the fault of a missing key. `doc` explains the key."""
    notes = (Note(f"`{name}` is: {doc}"),) if _says(name, doc) else ()
    message = f"{owner} lacks `{name}`"
    help = f"write `{name}: …`"
    return Fault("missing-key", message, at, key=True, notes=notes, help=help, lacks=name, names=(name,))


def report_clashing(
    rules: Iterable[Constraint], present: Collection[str], owner: str, at: Path, faults: list[Fault]
) -> None:
    """Report attributes that exclude or need each other."""
    for rule in rules:
        if rule.kind == "exclusive":
            fault = _exclusive(rule, present, owner, at=at)
        elif rule.kind == "oneof":
            complete = any(all(name in present for name in bundle) for bundle in rule.bundles)
            needed = " or ".join(" with ".join(f"`{name}`" for name in bundle) for bundle in rule.bundles)
            help = _cheapest(rule.bundles, present)
            fault = None
            if not complete:
                choices = tuple(name for bundle in rule.bundles for name in bundle)
                message = f"{owner} needs {needed}"
                fault = Fault("missing-key", message, at, key=True, help=help, names=choices)
        elif rule.kind == "together":
            names = [name for bundle in rule.bundles for name in bundle]
            fault = _incomplete(
                [n for n in names if n in present], [n for n in names if n not in present], owner, at=at
            )
        else:
            asking, asked = rule.bundles
            asking_all = all(name in present for name in asking)
            fault = (
                _incomplete(asking, [n for n in asked if n not in present], owner, at=at)
                if asking_all
                else None
            )
        if fault is not None:
            faults.append(fault)


def report_exclusive(
    names: Iterable[str], present: Collection[str], owner: str, at: Path, faults: list[Fault]
) -> None:
    """Report if more than one of the names is given."""
    report_clashing(
        [Constraint("exclusive", tuple((name,) for name in names))], present, owner, at=at, faults=faults
    )


def _exclusive(rule: Constraint, present: Collection[str], owner: str, at: Path) -> Fault | None:
    """Return the fault of the last of several exclusive keys in the file, or None."""
    bundles = {name: index for index, bundle in enumerate(rule.bundles) for name in bundle}
    there = [name for name in present if name in bundles]
    # A name is in several bundles of a rule only if the rule treats them alike. Therefore the first pair decides.
    clash = next(((a, b) for b in reversed(there) for a in there if bundles[a] != bundles[b]), None)
    if clash is None:
        return None
    first, second = clash
    return Fault(
        EXCLUSIVE,
        f"{owner} has both `{first}` and `{second}`, of which only one may stand",
        (*at, second),
        key=True,
        related=((f"`{first}` is written here", (*at, first)),),
        help=f"leave `{first}` or `{second}` out",
        names=(first, second),
    )


def _cheapest(bundles: Iterable[Iterable[str]], present: Collection[str]) -> str:
    """Return what to add if one of several bundles must be complete: the fewest keys beside the given ones."""
    lacking = min(
        ([name for name in bundle if name not in present] for bundle in bundles),
        key=lambda names: len(names),
    )
    return f"write `{', '.join(f'{name}: …' for name in lacking)}`"


def _incomplete(there: Collection[str], missing: Collection[str], owner: str, at: Path) -> Fault | None:
    if not there or not missing:
        return None
    first = next(iter(there))
    wanted = " and ".join(f"`{name}`" for name in missing)
    help = f"write {wanted} too, or leave `{first}` out"
    message = f"{owner} has `{first}` without {wanted}"
    lacks = next(iter(missing)) if len(missing) == 1 else None
    names = (first, *missing)
    return Fault(
        "missing-key", message, (*at, first), key=True, help=help, lacks=lacks, beside=True, names=names
    )


def _says(name: str, doc: str) -> bool:
    """Return whether an explanation says more than the name itself."""
    return doc not in ("", name)
