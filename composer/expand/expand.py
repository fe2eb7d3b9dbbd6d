"""Make a concrete recipe: choose variants, set parameters, decide conditions, evaluate expressions."""

from __future__ import annotations

from collections.abc import Mapping as Map

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.unknown import unknown_name
from composer.document.merge import without_ids
from composer.document.node import Mapping, Node, find
from composer.document.piece import Path
from composer.expand.parameter import Parameter
from composer.expand.params import read_params, settle
from composer.expand.substitute import Substitution
from composer.expand.variants import Axes, choose, merged, read_axes
from composer.expand.when import Condition
from composer.expr.value import Value

# These keys do not occur in a concrete recipe.
SETTLED = ("extends", "trust", "params", "variants", "matrix")


@dataclass(frozen=True, slots=True)
class Concrete:
    """A recipe without parameters and variants, and the values it was made with.

    `scope` has the values by name, those of variants as text; `lost` the names that are left out or in doubt
    because of errors, `gone` the paths of the keys that are left out.
    """

    document: Mapping
    scope: Map[str, Value]
    parameters: Map[str, Parameter]
    variants: Map[str, str]
    lost: frozenset[str] = frozenset()
    gone: frozenset[Path] = frozenset()


def expand(document: Mapping, given: Map[str, Node], sink: Sink, any: bool = False) -> Concrete:
    """Return the recipe with the values of `given`, and defaults for the rest.

    Faulty pieces are reported and left out. With `any` it has the items of all builds, whatever their `when` says.
    """
    axes = read_axes(document, sink)
    chosen = choose(axes, given, sink)
    document = merged(document, axes, chosen, sink=sink)
    declared = document.entries.get("params")
    parameters = read_params(declared[1] if declared else None, sink)
    _check_names(document, axes, parameters, given=given, sink=sink)
    scope: dict[str, Value] = {**settle(parameters, given, sink, in_cells=_axes(document)), **chosen}
    rest = Mapping(
        {name: entry for name, entry in document.entries.items() if name not in SETTLED}, document.span
    )
    broken = (_declared(document, "params") | _declared(document, "variants")) - scope.keys()
    substitution = Substitution(scope, parameters, broken, sink=sink)
    condition = Condition(scope, axes, broken, sink=sink, any=any)
    substituted = substitution.of(without_ids(condition.kept(rest), sink))
    assert isinstance(substituted, Mapping)
    return Concrete(
        substituted,
        scope,
        parameters,
        variants=chosen,
        lost=frozenset(substitution.lost | condition.in_doubt),
        gone=frozenset(substitution.gone),
    )


def scope_of(document: Mapping, given: Map[str, Node]) -> dict[str, Value]:
    """Return the values by name that `expand` would use, without expanding anything; errors are reported there."""
    sink = Sink()
    axes = read_axes(document, sink)
    chosen = choose(axes, given, sink)
    taken = {axis: _only_params(axes[axis], value) for axis, value in chosen.items()}
    declared = merged(_section(document), taken, chosen, sink=sink).entries.get("params")
    return {**settle(read_params(declared[1] if declared else None, sink), given, sink), **chosen}


def _only_params(values: Mapping, chosen: str) -> Mapping:
    """Return the chosen value of an axis with only the `params` of its piece."""
    key, piece = values.entries[chosen]
    return Mapping({chosen: (key, _section(piece) if isinstance(piece, Mapping) else piece)}, values.span)


def _section(document: Mapping) -> Mapping:
    return Mapping({name: each for name, each in document.entries.items() if name == "params"}, document.span)


def _axes(document: Mapping) -> frozenset[str]:
    """Return the axes that the cells of the matrix set."""
    axes = find(document, ("matrix", "axes"))
    return frozenset(axes.entries) if isinstance(axes, Mapping) else frozenset()


def _check_names(
    document: Mapping, axes: Axes, parameters: Map[str, Parameter], given: Map[str, Node], sink: Sink
) -> None:
    for name in axes.keys() & parameters.keys():
        variants = document.entries["variants"][1]
        assert isinstance(variants, Mapping)
        note = Note("the parameter", parameters[name].span)
        sink.error(
            "name-clash",
            f"`{name}` is a variant and a parameter",
            variants.entries[name][0].span,
            notes=(note,),
        )
    tried = _declared(document, "params") | _declared(document, "variants")
    for name, node in given.items():
        if name not in tried:
            message = f"the recipe has no parameter or variant `{name}`"
            sink.add(unknown_name("name", name, [*axes, *parameters], span=node.span, message=message))


def _declared(document: Mapping, section: str) -> frozenset[str]:
    """Return the names in a section, including those of faulty entries."""
    found = document.entries.get(section)
    return frozenset(found[1].entries) if found is not None and isinstance(found[1], Mapping) else frozenset()
