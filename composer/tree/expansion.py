"""How large a model is once MuJoCo has expanded it: counted before anything is expanded."""

from __future__ import annotations

import math
from collections.abc import Callable

from lxml.etree import XPath
from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.limits import advice, in_force
from composer.tree.file_points import file_points
from composer.tree.mesh_points import check_meshes
from composer.tree.reserved import check_reserved
from composer.tree.unit import Unit
from composer.tree.weight import NOTHING, Weight, default_dofs, joint_dofs

CODE = "limit-exceeded"
_FLEX_COUNT, _COMPOSITE_COUNT = "10 10 10", "1 1 1"
_COUNTED = ("grid", "box", "cylinder", "ellipsoid", "square", "disc", "circle")
"""The types of `<flexcomp>` that make `count` points; others have them from a file or an attribute."""
_COUNT = XPath("count(descendant-or-self::*)")  # compiled once: that takes as long as to count 100 elements
_EXPANDING = ("replicate", "flexcomp", "composite", "attach")
_JOINTS = ("joint", "freejoint")
_HOLDING_JOINTS = ("body", "frame", "replicate")
"""What a joint of the model stands in; constraints, tendons and classes have elements of the same name."""
_DOFS_OF_A_POINT = {"radial": 1, "2d": 2}
_NODES = {"trilinear": 1, "quadratic": 2}
"""The bodies along each of the `cellcount` of a flex, of which one more ends a row; else each point is a body."""
_MOST_DOFS = 6
_COUNTS = (
    ("bodies", "bodies", "bodies"),
    ("dofs", "dofs", "degrees of freedom"),
    ("mass-matrix", "matrix", "numbers in the mass matrix"),
)
"""Limits of the whole model: the name, what of a `Weight` it bounds, and how messages call that."""


def written(root: Node) -> int:
    """How many elements stand in a tree.

    >>> from lxml import etree
    >>> written(etree.fromstring("<mujoco><worldbody><!-- none --><geom/></worldbody></mujoco>"))
    3
    """
    return int(_COUNT(root))  # type: ignore[arg-type]


def check_size(
    unit: Unit,
    sink: Sink,
    attached: Callable[[Node], Weight] = lambda _: NOTHING,
    *,
    opens_files: bool = True,
) -> None:
    """Report a model that is larger than the limits allow, at the element that makes it so. Nothing is expanded.

    `attached` says what an `<attach>` brings. Without `opens_files` the points of mesh files are not counted:
    `tree/admitted.py` does so before MuJoCo opens them.
    """
    limits = in_force()
    elements = written(unit.root)
    if elements > limits.elements:
        sink.error(
            CODE,
            f"the model has {elements} elements; {limits.elements} are allowed",
            unit.origins.span(unit.root, unit.file),
            help=advice("elements", elements),
        )
        return
    if _is_small(unit.root, elements):
        if check_reserved(unit, elements, sink):
            check_meshes(unit, 0, sink, opens_files=opens_files)
        return
    made, model = _made(unit.root, attached, lambda flexcomp: file_points(flexcomp, unit))
    # An inner one is reported before the one around it, which it may make too large.
    for node in reversed(made):
        if made[node].elements > limits.expansion:
            said = f"`<{node.tag}>` makes {_number(made[node].elements)} elements"
            said = f"{said}; {limits.expansion} are allowed"
            _report(unit, node, said, "expansion", made[node].elements, sink)
            return
    total = model.elements - elements
    if total > limits.expansion:
        largest = max(made, key=lambda node: made[node].elements)
        said = f"the model makes {_number(total)} elements of what is written"
        note = Note(f"most of them, {made[largest].elements}, here", unit.origins.span(largest, unit.file))
        said = f"{said}; {limits.expansion} are allowed"
        _report(unit, largest, said, "expansion", total, sink, note)
        return
    if _is_heavy(unit, model, made, sink=sink):
        return
    if check_reserved(unit, elements + total, sink):
        check_meshes(unit, model.points, sink, opens_files=opens_files)


def _is_small(root: Node, elements: int) -> bool:
    """Whether a model is within the limits of the whole, however its bodies hang together."""
    limits = in_force()
    if next(root.iter(*_EXPANDING), None) is not None:
        return False
    if elements > limits.bodies and root.xpath("count(descendant::body)") > limits.bodies:  # type: ignore[operator]
        return False
    dofs = _MOST_DOFS * sum(1 for _ in root.iter(*_JOINTS))
    if dofs <= limits.dofs and dofs * (dofs + 1) // 2 <= limits.mass_matrix:
        return True
    # At most all in one tree carry each other: what hangs in the world at different places has nothing in common.
    by_default, trees = default_dofs(root), []
    for section in root.iterchildren("*"):
        if section.tag == "worldbody":
            trees += [
                sum(joint_dofs(joint, by_default) for joint in place.iter(*_JOINTS)) for place in section
            ]
        else:
            joints = (joint for joint in section.iter(*_JOINTS) if _holds_joints(joint.getparent()))
            trees.append(sum(joint_dofs(joint, by_default) for joint in joints))
    return sum(trees) <= limits.dofs and sum(own * (own + 1) // 2 for own in trees) <= limits.mass_matrix


def _holds_joints(above: Node | None) -> bool:
    return above is not None and above.tag in _HOLDING_JOINTS


def _is_heavy(unit: Unit, model: Weight, made: dict[Node, Weight], sink: Sink) -> bool:
    """Whether MuJoCo would take too long for a model; that is reported at what makes most of it.

    MuJoCo 4.0 takes four times as long for twice as many bodies or joints, wherever they are: 15 s for 15,000. The
    matrix takes 5 s where it has two million numbers, and eight times that where each body hangs on twice as many.
    """
    for name, count, words in _COUNTS:
        most = getattr(in_force(), name.replace("-", "_"))
        total = getattr(model, count)
        if total <= most:
            continue
        sizes = {node: getattr(weight, count) for node, weight in made.items()}
        node = next((each for each in reversed(made) if sizes[each] > most), None)
        if node is not None:
            said = f"`<{node.tag}>` makes {_number(sizes[node])} {words}; {most} are allowed"
            _report(unit, node, said, name, sizes[node], sink)
            return True
        said = f"the model has {_number(total)} {words}; {most} are allowed"
        largest = max(made, key=sizes.__getitem__, default=None)
        if largest is not None and sizes[largest] > total // 2:
            note = Note(f"most of them, {sizes[largest]}, here", unit.origins.span(largest, unit.file))
            _report(unit, largest, said, name, total, sink, note)
        else:
            sink.error(CODE, said, unit.origins.span(unit.root, unit.file), help=advice(name, total))
        return True
    return False


def expanded(
    root: Node,
    attached: Callable[[Node], Weight] = lambda _: NOTHING,
    in_file: Callable[[Node], int] = lambda _: 0,
) -> Weight:
    """How large a tree is once it is expanded; `in_file` says how many points the file of a `<flexcomp>` has.

    >>> from lxml import etree
    >>> expanded(etree.fromstring('<body><replicate count="1000"><geom/><site/></replicate></body>')).elements
    2002
    """
    return _made(root, attached, in_file)[1]


def _made(
    root: Node, attached: Callable[[Node], Weight], in_file: Callable[[Node], int]
) -> tuple[dict[Node, Weight], Weight]:
    """What each that is expanded makes, in the order of the tree, and how large the tree is with all that.

    Of what one makes, the elements are those that are not written. Without recursion, however deep a model is.
    """
    by_default = default_dofs(root)
    nodes = list(root.iter("*"))
    made: dict[Node, Weight] = {node: NOTHING for node in nodes if node.tag in _EXPANDING}
    below: dict[Node, tuple[int, Weight]] = {}
    for node in reversed(nodes):  # what is inside comes before what it is in
        count, inside = below.pop(node, (0, NOTHING))
        tag, above = node.tag, node.getparent()
        if node in made:
            weight = _expanded(node, inside, attached, in_file=in_file)
            made[node] = weight._replace(elements=weight.elements - 1 - count)
        elif tag == "body":
            weight = inside.in_body()
        elif tag in _JOINTS and (above is None or _holds_joints(above)):
            dofs = joint_dofs(node, by_default)
            weight = Weight(1, 0, dofs, matrix=0, loose=dofs)
        else:
            weight = inside._replace(elements=inside.elements + 1)
        if above is None or node is root:
            return made, weight
        known = below.get(above)
        below[above] = (1 + count, weight) if known is None else (known[0] + 1 + count, known[1].plus(weight))
    return made, NOTHING


def _expanded(
    node: Node,
    inside: Weight,
    attached: Callable[[Node], Weight],
    in_file: Callable[[Node], int],
) -> Weight:
    """What stands in the place of an element, which itself counts as one more."""
    one = Weight(1)
    if node.tag == "replicate":
        # MuJoCo (4.0) takes its time for each copy, even where there is nothing to copy.
        copied = inside if inside.elements else inside.plus(one)
        return one.plus(copied.times(_product(str(node.get("count") or "1"), 1)))
    if node.tag == "composite":
        count = _product(str(node.get("count") or _COMPOSITE_COUNT), 3)
        # A cable, the last one that there was (MuJoCo 3.17): each body hangs on the one before by a ball joint.
        chain = Weight(count, count, 3 * count, matrix=9 * count * count // 2)
        return one.plus(inside.times(count)).plus(chain)
    if node.tag == "flexcomp":
        points = _points(node, in_file)
        return one.plus(inside).plus(_soft(node, points)._replace(elements=points))
    return one.plus(inside).plus(attached(node))


def _soft(flexcomp: Node, points: int) -> Weight:
    """The bodies of a flex; those that it pins, which are none, are counted too."""
    if flexcomp.get("rigid") == "true":
        return NOTHING
    dof = flexcomp.get("dof") or "full"
    bodies, dofs = points, _DOFS_OF_A_POINT.get(dof, 3)
    if dof in _NODES:
        cells = [_count(word) for word in str(flexcomp.get("cellcount") or "1 1 1").split()[:3]]
        bodies = math.prod(_NODES[dof] * each + 1 for each in cells)
    return Weight(0, bodies, dofs * bodies, matrix=bodies * dofs * (dofs + 1) // 2)


def _points(flexcomp: Node, in_file: Callable[[Node], int]) -> int:
    if (flexcomp.get("type") or "grid") in _COUNTED:
        return _product(str(flexcomp.get("count") or _FLEX_COUNT), 3)
    return in_file(flexcomp) if flexcomp.get("file") else len(str(flexcomp.get("point") or "").split()) // 3


def _product(text: str, most: int) -> int:
    """The product of the first numbers in a text; what is not a number is reported elsewhere and counts as one.

    >>> _product("10 20 1", 3), _product("many", 1)
    (200, 1)
    """
    return math.prod(_count(word) for word in text.split()[:most])


def _count(word: str) -> int:
    try:
        return max(1, int(float(word)))
    except (ValueError, OverflowError):
        return 1


def _number(count: int) -> str:
    return str(count) if count < 10**18 else f"more than {10**18}"


def _report(unit: Unit, node: Node, message: str, limit: str, needed: int, sink: Sink, *notes: Note) -> None:
    attribute = "model" if node.tag == "attach" else "file" if node.get("file") else "count"
    span = unit.origins.span(node, unit.file, attribute)
    sink.error(CODE, message, span, notes=notes, help=advice(limit, needed))
