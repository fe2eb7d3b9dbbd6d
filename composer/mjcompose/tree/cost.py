"""The cost of a model after MuJoCo expands it, counted before that."""

from __future__ import annotations

import math
import operator
import re
import struct
from collections.abc import Callable, Iterator
from typing import NamedTuple, cast

from lxml.etree import XPath, _Element as Node

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.files import Memory, Refused, read_regular
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.tree.files import CUBE, join, written_path
from mjcompose.tree.mesh_cost import check_meshes, file_points, number
from mjcompose.tree.unit import Unit, line_of
from mjcompose.tree.values import real

_PNG = b"\x89PNG\r\n\x1a\n"
_HEAD = 24


def pixels(element: Node, attribute: str, unit: Unit) -> int:
    """Return the pixels of the file that an attribute names; 0 if it is not a PNG or does not exist."""
    path = written_path(unit.settings, element, str(element.get(attribute)))
    held = unit.contents.get(path)
    if isinstance(held, bytes):
        return _in_head(held[:_HEAD])
    try:
        return _known.ask(unit.door.admit(str(held or join(str(unit.directory), path))))
    except (OSError, Refused):
        return 0


def _in_head(head: bytes) -> int:
    r"""The width times the height.

    >>> _in_head(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\2\0\0\0\3"), _in_head(b"GIF89a")
    (6, 0)
    """
    if len(head) < _HEAD or not head.startswith(_PNG):
        return 0
    width, height = struct.unpack(">II", head[16:_HEAD])
    return int(width * height)


_known: Memory[int] = Memory(lambda path: _in_head(read_regular(path)[:_HEAD]), lambda _: 0)


_WITH_FACTORS = XPath("ancestor-or-self::frame[@scale or @massscale]")


def scales(frame: Node) -> bool:
    """Return whether a frame changes sizes or masses. Raises NotMjcf.

    >>> from lxml.etree import fromstring
    >>> scales(fromstring('<frame scale="1 1 1"/>')), scales(fromstring('<frame scale="2"/>'))
    (False, True)
    """
    factors = str(frame.get("scale") or "1").split()
    return any(real(factor) != 1 for factor in factors) or bool(real(str(frame.get("massscale") or 0)))


def scaled_above(element: Node | None) -> Node | None:
    """Return the nearest frame that resizes `element`, which may be that frame itself."""
    return next(all_scaled_above(element), None)


def all_scaled_above(element: Node | None) -> Iterator[Node]:
    """Yield the frames that resize `element`, innermost first."""
    # Each part of a chain asks for all frames around it, so C leaves out those without factors.
    around: list[Node] = [] if element is None else _WITH_FACTORS(element)  # type: ignore[assignment]
    yield from (frame for frame in reversed(around) if scales(frame))


def first_scaled(root: Node) -> Node | None:
    return next((frame for frame in root.iter("frame") if scales(frame)), None)


_DOFS = {"free": 6, "ball": 3}


class Weight(NamedTuple):
    """The numbers of elements, bodies and degrees of freedom of a piece, and of its numbers in the mass matrix.

    The matrix has a number for each degree of freedom, and for each pair of which one carries the other. `loose` are
    the degrees of freedom whose body is around the piece; they have no numbers yet. `points` counts the points of
    meshes in models that it attaches.

    >>> joint = Weight(elements=1, dofs=1, loose=1)
    >>> link = joint.in_body()
    >>> link.matrix, link.plus(joint).in_body().matrix
    (1, 3)
    """

    elements: int = 0
    bodies: int = 0
    dofs: int = 0
    matrix: int = 0
    loose: int = 0
    points: int = 0

    def plus(self, other: Weight) -> Weight:
        return Weight(*map(operator.add, self, other))

    def times(self, count: int) -> Weight:
        return Weight(*(count * each for each in self))

    def in_body(self) -> Weight:
        """The weight of a body that contains this piece."""
        own = self.loose
        carried = self.dofs - self.loose
        matrix = self.matrix + own * (own + 1) // 2 + own * carried
        return self._replace(elements=self.elements + 1, bodies=self.bodies + 1, matrix=matrix, loose=0)


NOTHING = Weight()


def joint_dofs(joint: Node, by_default: int) -> int:
    """The degrees of freedom of a joint; `by_default` for a joint that does not set its type.

    >>> from lxml import etree
    >>> joint_dofs(etree.fromstring('<joint type="ball"/>'), 1), joint_dofs(etree.fromstring("<freejoint/>"), 1)
    (3, 6)
    """
    if joint.tag == "freejoint":
        return 6
    kind = joint.get("type")
    return by_default if kind is None else _DOFS.get(kind, 1)


def default_dofs(root: Node) -> int:
    """Return an upper bound of the degrees of freedom of a joint without a type, regardless of its class.

    >>> from lxml import etree
    >>> default_dofs(etree.fromstring('<mujoco><default><joint type="ball"/></default></mujoco>'))
    3
    """
    return max((joint_dofs(each, 1) for each in root.iterfind("default//joint[@type]")), default=1)


CODE = "limit-exceeded"
_FLEX_COUNT = "10 10 10"
_COMPOSITE_COUNT = "1 1 1"
_COUNTED = ("grid", "box", "cylinder", "ellipsoid", "square", "disc", "circle")
"""The types of `<flexcomp>` that make `count` points; others have them from a file or an attribute."""
_COUNT = XPath("count(descendant-or-self::*)")  # compiled once: that takes as long as to count 100 elements
_EXPANDING = ("replicate", "flexcomp", "composite", "attach")
_JOINTS = ("joint", "freejoint")
_HOLDING_JOINTS = ("body", "frame", "replicate")
"""The parents of a joint of the model; constraints, tendons and classes have elements of the same name."""
_DOFS_OF_A_POINT = {"radial": 1, "2d": 2}
_NODES = {"trilinear": 1, "quadratic": 2}
"""The bodies along each of the `cellcount` of a flex, of which one more ends a row; else each point is a body."""
_MOST_DOFS = 6
_COUNTS = (
    ("expansion", "elements", "elements"),
    ("bodies", "bodies", "bodies"),
    ("dofs", "dofs", "degrees of freedom"),
    ("mass-matrix", "matrix", "numbers in the mass matrix"),
)
"""Limits of the expanded model: the name, the bounded field of `Weight`, and its word in messages."""


def written(root: Node) -> int:
    """Return the number of elements in a tree.

    >>> from lxml import etree
    >>> written(etree.fromstring("<mujoco><worldbody><!-- none --><geom/></worldbody></mujoco>"))
    3
    """
    return int(_COUNT(root))  # type: ignore[arg-type]


def check_size(
    unit: Unit, sink: Sink, attached: Callable[[Node], Weight] = lambda _: NOTHING, *, opens_files: bool = True
) -> None:
    """Report a model that is larger than the limits allow, at the element that causes it; expand nothing.

    `attached` has the cost of an `<attach>`. Without `opens_files` the points of mesh files are not counted:
    `all_admitted` does so before MuJoCo opens them.
    """
    limits = in_force()
    elements = written(unit.root)
    if elements > limits.elements:
        message = f"the model has {elements} elements; {limits.elements} are allowed"
        sink.error(CODE, message, unit.origins.span(unit.root, unit.file), help=advice("elements", elements))
        return
    if _is_small(unit.root, elements):
        if check_reserved(unit, elements, sink):
            check_meshes(unit, 0, sink, opens_files=opens_files)
        return
    made, model = _made(unit.root, attached, lambda flexcomp: file_points(flexcomp, unit))
    expansion = model._replace(elements=model.elements - elements)
    if _is_within(unit, expansion, made, sink=sink) and check_reserved(unit, model.elements, sink):
        check_meshes(unit, model.points, sink, opens_files=opens_files)


def _is_small(root: Node, elements: int) -> bool:
    limits = in_force()
    if next(root.iter(*_EXPANDING), None) is not None:
        return False
    if elements > limits.bodies and root.xpath("count(descendant::body)") > limits.bodies:  # type: ignore[operator]
        return False
    dofs = _MOST_DOFS * sum(1 for _ in root.iter(*_JOINTS))
    if dofs <= limits.dofs and dofs * (dofs + 1) // 2 <= limits.mass_matrix:
        return True
    # At most all in one tree carry each other: different trees in the world have nothing in common.
    by_default = default_dofs(root)
    trees = []
    for section in root.iterchildren("*"):
        if section.tag == "worldbody":
            trees += [sum(joint_dofs(joint, by_default) for joint in place.iter(*_JOINTS)) for place in section]
        else:
            joints = (joint for joint in section.iter(*_JOINTS) if _holds_joints(joint.getparent()))
            trees.append(sum(joint_dofs(joint, by_default) for joint in joints))
    return sum(trees) <= limits.dofs and sum(own * (own + 1) // 2 for own in trees) <= limits.mass_matrix


def _holds_joints(above: Node | None) -> bool:
    return above is not None and above.tag in _HOLDING_JOINTS


def _is_within(unit: Unit, total: Weight, made: dict[Node, Weight], sink: Sink) -> bool:
    """Return whether the expanded model is within the limits; if not, report its largest element.

    MuJoCo 4.0 takes four times as long for twice as many bodies or joints, wherever they are: 15 s for 15,000. The
    matrix takes 5 s if it has two million numbers, and eight times that if each body depends on twice as many.
    """
    for limit, count, words in _COUNTS:
        most = getattr(in_force(), limit.replace("-", "_"))
        needed = getattr(total, count)
        if needed > most:
            sizes = {node: getattr(weight, count) for node, weight in made.items()}
            _report_largest(unit, needed, most, sizes=sizes, limit=limit, words=words, sink=sink)
            return False
    return True


def _report_largest(
    unit: Unit, needed: int, most: int, sizes: dict[Node, int], limit: str, words: str, sink: Sink
) -> None:
    """Report the element that is too large by itself, or else the whole model, with its largest element in a note."""
    # An inner one is reported before the one around it, which it may make too large.
    place = next((node for node in reversed(sizes) if sizes[node] > most), None)
    notes: list[Note] = []
    if place is not None:
        message = f"`<{place.tag}>` makes {_count(sizes[place])} {words}"
        help = advice(limit, sizes[place])
    else:
        is_made = limit == "expansion"
        made = " of what is written" if is_made else ""
        message = f"the model {'makes' if is_made else 'has'} {_count(needed)} {words}{made}"
        help = advice(limit, needed)
        largest = max(sizes, key=sizes.__getitem__, default=None)
        if largest is not None and (is_made or sizes[largest] > needed // 2):
            place = largest
            notes = [Note(f"most of them, {sizes[largest]}, here", unit.origins.span(largest, unit.file))]
    span = unit.origins.span(unit.root, unit.file) if place is None else _span_of_copies(place, unit)
    sink.error(CODE, f"{message}; {most} are allowed", span, notes=notes, help=help)


def _count(number: int) -> str:
    return str(number) if number < 10**18 else f"more than {10**18}"


def _span_of_copies(element: Node, unit: Unit) -> Span:
    """Return the place of the attribute that makes the elements: the model, the file, or their number."""
    attribute = "model" if element.tag == "attach" else "file" if element.get("file") else "count"
    return unit.origins.span(element, unit.file, attribute)


def expanded(
    root: Node, attached: Callable[[Node], Weight] = lambda _: NOTHING, in_file: Callable[[Node], int] = lambda _: 0
) -> Weight:
    """The size of a tree after expansion; `in_file` returns the number of points in the file of a `<flexcomp>`.

    >>> from lxml import etree
    >>> expanded(etree.fromstring('<body><replicate count="1000"><geom/><site/></replicate></body>')).elements
    2002
    """
    return _made(root, attached, in_file)[1]


def _made(
    root: Node, attached: Callable[[Node], Weight], in_file: Callable[[Node], int]
) -> tuple[dict[Node, Weight], Weight]:
    """Return the weight of each expanded element, in the order of the tree, and the weight of the whole tree.

    An expanded element does not count the elements that are written in it. It does not recurse, even for a deep model.
    """
    by_default = default_dofs(root)
    nodes = list(root.iter("*"))
    made: dict[Node, Weight] = {node: NOTHING for node in nodes if node.tag in _EXPANDING}
    below: dict[Node, tuple[int, Weight]] = {}
    for node in reversed(nodes):  # inner elements come first
        count, inside = below.pop(node, (0, NOTHING))
        tag = node.tag
        above = node.getparent()
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
        others, beside = below.get(above, (0, NOTHING))
        below[above] = others + 1 + count, beside.plus(weight)
    return made, NOTHING


def _expanded(node: Node, inside: Weight, attached: Callable[[Node], Weight], in_file: Callable[[Node], int]) -> Weight:
    """Return the weight of the elements that replace an element, which itself counts as one more."""
    match node.tag:
        case "replicate":  # MuJoCo (4.0) takes its time for each copy, even where there is nothing to copy
            copied = inside if inside.elements else inside.plus(Weight(1))
            weight = copied.times(_product(str(node.get("count") or "1"), 1))
        case "composite":  # a cable, the last one (MuJoCo 3.17): each body hangs on the one before by a ball joint
            count = _product(str(node.get("count") or _COMPOSITE_COUNT), 3)
            weight = inside.times(count).plus(Weight(count, count, 3 * count, matrix=9 * count * count // 2))
        case "flexcomp":
            points = _points(node, in_file)
            weight = inside.plus(_soft(node, points)._replace(elements=points))
        case _:
            weight = inside.plus(attached(node))
    return weight._replace(elements=weight.elements + 1)


def _soft(flexcomp: Node, points: int) -> Weight:
    """The number of bodies of a flex. Pinned vertices have no body but are counted anyway."""
    if flexcomp.get("rigid") == "true":
        return NOTHING
    dof = flexcomp.get("dof") or "full"
    bodies = points
    dofs = _DOFS_OF_A_POINT.get(dof, 3)
    if dof in _NODES:
        cells = [number(word, 1) for word in str(flexcomp.get("cellcount") or "1 1 1").split()[:3]]
        bodies = math.prod(_NODES[dof] * each + 1 for each in cells)
    return Weight(0, bodies, dofs * bodies, matrix=bodies * dofs * (dofs + 1) // 2)


def _points(flexcomp: Node, in_file: Callable[[Node], int]) -> int:
    if (flexcomp.get("type") or "grid") in _COUNTED:
        return _product(str(flexcomp.get("count") or _FLEX_COUNT), 3)
    return in_file(flexcomp) if flexcomp.get("file") else len(str(flexcomp.get("point") or "").split()) // 3


def _product(text: str, most: int) -> int:
    """Return the product of the first numbers in a text. Anything else is reported elsewhere and counts as 1.

    >>> _product("10 20 1", 3), _product("many", 1)
    (200, 1)
    """
    return math.prod(number(word, 1) for word in text.split()[:most])


_CHANNELS = 3
_OF_A_STEP = 10
"""The weight of a simulated step: it takes at least 1 microsecond."""
_OF_A_KEY = 2000
"""The least weight of a keyframe: MuJoCo 4.0 takes 3 s to make 50,000, and four times that for twice as many."""


def check_reserved(unit: Unit, elements: int, sink: Sink) -> bool:
    """Return whether a model with this many elements reserves no more than allowed; report the attribute if not."""
    most = in_force().reserved
    total = 0
    for node, attribute, count in _reserving(unit, elements):
        total += count
        if total > most:
            span = unit.origins.span(node, unit.file, attribute)
            numbers = str(count) if count < 10**18 else "more than 10^18"
            message = f"`<{node.tag}>` reserves {numbers} numbers; a model may reserve {most}"
            sink.error(CODE, message, span, help=advice("reserved", total))
            return False
    return True


def _reserving(unit: Unit, elements: int) -> Iterator[tuple[Node, str, int]]:
    root = unit.root
    for node in root.iter("texture", "hfield", "size", "lengthrange"):
        if node.tag in ("texture", "hfield"):
            for attribute in ("file", *CUBE):
                if node.get(attribute):
                    yield node, attribute, pixels(node, attribute, unit)
        if node.tag == "texture" and node.get("file") is None:
            width = number(node.get("width"))
            height = number(node.get("height"))
            height = 6 * width if (node.get("type") or "cube") != "2d" else height
            yield node, "width", _CHANNELS * width * height
        elif node.tag == "hfield" and node.get("file") is None:
            yield node, "nrow", number(node.get("nrow")) * number(node.get("ncol"))
        elif node.tag == "lengthrange":
            actuators = int(root.xpath("count(actuator/*)"))  # type: ignore[arg-type]
            yield node, "inttotal", _OF_A_STEP * actuators * _steps(node)
        elif node.tag == "size":
            for name in map(str, node.keys()):
                yield node, name, number(node.get(name)) * _weight(name, elements)


def _weight(name: str, elements: int) -> int:
    if name == "nkey":
        return _OF_A_KEY + elements
    return elements if name.startswith("nuser_") else 1 if name == "nuserdata" else 0


def _steps(lengthrange: Node) -> int:
    """Return the number of steps that MuJoCo simulates for each actuator whose length range it computes."""
    try:
        return int(float(lengthrange.get("inttotal") or 10) / float(lengthrange.get("timestep") or 0.01))
    except (ValueError, OverflowError, ZeroDivisionError):
        return 0


_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_STRETCH = re.compile(rb"<!--.*?-->|[^<>\"]+", re.DOTALL)
"""Text that may be long: a comment, or anything between the delimiters of XML."""
_COLUMNS = 10_000


def check_text(data: bytes, file: str, sink: Sink) -> bool:
    """Return whether XML is within the limits for elements and long texts, and report it otherwise."""
    limits = in_force()
    tags = _tags(data) if len(data) > limits.elements else 0
    if tags > limits.elements:
        tags -= sum(_tags(found.group()[1:]) for found in _COMMENT.finditer(data))
    if tags > limits.elements:
        message = f"`{file}` has {tags} elements; {limits.elements} are allowed"
        sink.error(CODE, message, Span(file, 1, 1), help=advice("elements", tags))
        return False
    return len(data) <= limits.text_size or _check_stretches(data, file, sink)


def check_attributes(root: Node, data: bytes, file: str, sink: Sink) -> bool:
    """Return whether no element of `data` has too many attributes, each of which may be a fault; report the first."""
    most = in_force().attributes
    if not _has_long_tag(data, most * len('a=""')):
        return True
    found = cast(list[Node], root.xpath(f"(descendant-or-self::*[count(@*) > {most}])[1]"))
    for node in found:
        message = f"`<{node.tag}>` has {len(node.attrib)} attributes; {most} are allowed"
        sink.error(CODE, message, Span(file, line_of(node) or 1, 1), help=advice("attributes", len(node.attrib)))
    return not found


def _has_long_tag(data: bytes, length: int) -> bool:
    """Return whether this number of bytes has no `<`, which in a tag only occurs at its start.

    >>> _has_long_tag(b"<a><b/></a>", 4), _has_long_tag(b"<a><b/></a>", 3)
    (False, True)
    """
    at = data.find(b"<")
    while 0 <= at < len(data) - length:
        following = data.rfind(b"<", at + 1, at + 1 + length)
        if following < 0:
            return True
        at = following
    return False


def _tags(data: bytes) -> int:
    return data.count(b"<") - data.count(b"</") - data.count(b"<!") - data.count(b"<?")


def _check_stretches(data: bytes, file: str, sink: Sink) -> bool:
    limit = in_force().text_size
    spans = (found.span() for found in _STRETCH.finditer(data))
    at, end = max(spans, key=lambda span: span[1] - span[0], default=(0, 0))
    if end - at > limit:
        line = data.count(b"\n", 0, at) + 1
        begin = data.rfind(b"\n", 0, at) + 1
        column = len(data[begin:at].decode("utf-8", "replace")) + 1 if at - begin < _COLUMNS else 1
        message = f"an attribute, comment or text has {end - at} bytes; {limit} are allowed"
        sink.error(CODE, message, Span(file, line, column), help=advice("text-size", end - at))
    return end - at <= limit
