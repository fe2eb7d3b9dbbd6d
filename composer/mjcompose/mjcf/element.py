"""Elements and models in Python: views of one node each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, TypeVar, cast, overload

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import ALL
from mjcompose.base.diagnostic import Note, call_site
from mjcompose.base.report import short_traceback
from mjcompose.base.suggest import unknown_name
from mjcompose.link.linking import Policy
from mjcompose.mjcf import edit, traversal
from mjcompose.mjcf.asset import ModelFiles, as_index, as_name
from mjcompose.mjcf.attributed import targets, view
from mjcompose.mjcf.compile import to_spec
from mjcompose.mjcf.edit import remove
from mjcompose.mjcf.errors import MjcfKeyError, error_of, failure, unknown_tag
from mjcompose.mjcf.include import duplicate, include_copy
from mjcompose.mjcf.model import UNNAMED, ModelState, ReferencedNode
from mjcompose.mjcf.node_view import NodeView, RootView, attach, model_of, set_model_name
from mjcompose.mjcf.physics import Physics, page_with_picture
from mjcompose.tree.grammar import ElementType
from mjcompose.tree.names import SEPARATOR
from mjcompose.tree.select import WORLD_SECTION
from mjcompose.tree.unit import Unit


class Element(NodeView):
    """One element of a model.

    Its MJCF attributes are Python attributes: numbers and arrays are returned as numpy values, references as Elements,
    files as `Asset`, keywords and names as text. An attribute that is not set is None, and setting it to None removes
    it. Changes to an array are written to the element: `body.pos[2] += 1`. `class` is spelled `dclass`, and a trailing
    underscore is dropped (`global_`). Children are found by tag: one that can occur only once as an Element
    (`model.visual.headlight`), others as a list (`body.geom`) that also accepts names. `dir(element)` lists all of
    them, `help(element)` explains them, `print(element)` shows the element as MJCF.

    There is one Element for each element of a model: `a.find('joint', 'j') is a.find('joint', 'j')`.
    """

    __slots__ = ()

    # -- the element itself ----------------------------------------------------------------------------------

    @property
    def parent(self) -> Element | None:
        """The element that contains this one, or None for a root. `parent_model` gives the model it is attached to.

        >>> from mjcompose import mjcf
        >>> arm = mjcf.RootElement().worldbody.add('body', name='arm')
        >>> arm.add('geom', size=[1]).parent is arm
        True
        """
        parent = self._alive()._node.getparent()
        return None if parent is None else view(self._model, parent)

    @property
    def root(self) -> RootElement:
        """The root of the model that the element belongs to, whether or not that model is attached to another.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement('arm')
        >>> model.worldbody.add('geom', size=[1]).root is model
        True
        """
        return cast(RootElement, view(self._alive()._model, self._model.unit.root))

    # -- adding and removing ---------------------------------------------------------------------------------

    @short_traceback
    def add(self, tag: str, /, **attributes: object) -> Element:
        """Append a child and return it.

        Values may be numbers, arrays, text, booleans and Elements; None omits an attribute. MJCF refers to
        elements by name, so an Element without a name that is used as a value gets one, such as `unnamed_joint_0`.

        Raises `MjcfError` for a tag or attribute that MJCF does not have here (with the names that exist), for a value
        of a wrong type or length, and for a name that is already used. After an error the model is unchanged.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement()
        >>> model.worldbody.add('geom', name='ball', type='sphere', size=[0.1])
        <geom name="ball" type="sphere" size="0.1"/>
        """
        return self._add(tag, None, attributes)

    @short_traceback
    def insert(self, tag: str, /, position: int, **attributes: object) -> Element:
        """Insert a child before the child at index `position`, and return it. See `add`.

        As with `list.insert`, a negative index counts from the end, and one that is too large appends.

        >>> from mjcompose import mjcf
        >>> world = mjcf.RootElement().worldbody
        >>> last = world.add('geom', name='last', size=[1])
        >>> first = world.insert('geom', 0, name='first', size=[1])
        >>> [geom.name for geom in world.geom]
        ['first', 'last']
        """
        return self._add(tag, as_index("position", position), attributes)

    def _add(self, tag: str, position: int | None, attributes: Mapping[str, object]) -> Element:
        self._alive()
        kind = self._child_kind(tag)
        once = kind.max_count == 1 or self._kind.tag == "mujoco"
        existing = next(self._node.iterchildren(kind.tag), None) if once else None
        if existing is not None and (len(existing) or existing.attrib):
            message = f"{self._described()} has a `<{kind.tag}>` already, and can have one only"
            raise failure("name-clash", message, notes=(Note("it is here", self._model.span(existing)),))
        checked = edit.check(self._model, kind, targets(attributes))
        if existing is None and self._kind.tag == "mujoco":
            existing = self._model.section(kind.tag)
        if existing is not None:
            edit.write(self._model, existing, checked)
            self._model.unit.origins.own(existing, call_site())
            return cast(Element, view(self._model, existing))
        made = edit.create(self._model, self._node, kind.tag, edit=checked, position=position)
        return cast(Element, view(self._model, made))

    @short_traceback
    def remove(self, cascade: bool = False) -> None:
        """Remove the element and everything below it from the model, and detach the models attached there.

        Elements that refer to it stay; when the model is written, an error lists each of them by name. With
        `cascade` they are removed too: references to classes and materials are dropped from the elements that have
        them, and any other referring element is removed as a whole (a tendon is removed with a site of its path). A
        top-level section stays in the model and is emptied. Raises `MjcfError` for the root of a model.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement()
        >>> hinge = model.worldbody.add('body', name='arm').add('joint', name='hinge')
        >>> motor = model.actuator.add('motor', joint=hinge)
        >>> hinge.remove(cascade=True)
        >>> model.find_all('actuator')
        []
        """
        self._alive()
        remove(self._model, self._node, cascade)

    @short_traceback
    def attach(self, other: RootElement) -> Element:
        """Attach a model to this site, body, frame or worldbody, and return the attachment frame.

        The child keeps its own names and can still be edited; in this model its names have its prefix
        (`gripper/left_pad`). The frame has an offset (`frame.pos` in meters, `frame.quat`, …) and accepts joints.
        Without a joint the child is fixed and no body is added. Raises `MjcfError` if the child is already attached,
        contains this model, or has the same prefix as another child.

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> flange = arm.worldbody.add('site', name='flange', pos=[0, 0, 1])
        >>> frame = flange.attach(gripper)
        >>> frame.add('joint', name='turn', axis=[0, 0, 1]).full_identifier
        'gripper/turn'
        """
        model = self._alive()._model
        return cast(Element, view(model, attach(model, self._node, model_of(other, "what is attached"))))

    # -- finding ---------------------------------------------------------------------------------------------

    @short_traceback
    def find(self, tag: str, name: str | None = None) -> Element | None:
        """Return the first match below this element in document order, or None.

        `tag` may be a family: `joint` also finds `freejoint`, and `actuator`, `sensor`, `equality`, `tendon` and `key`
        find all elements of that kind. `name` is the name in this element's model; for elements of attached models
        it includes the prefix (`gripper/left_pad`). Raises `MjcfError` for a tag that MJCF does not have.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement()
        >>> hinge = model.worldbody.add('body', name='arm').add('joint', name='hinge')
        >>> model.find('joint', 'hinge') is model.find('body', 'arm').find('joint') is hinge
        True
        >>> model.find('joint', 'slide') is None
        True
        """
        model = self._model
        node = self._node
        if type(name) is str and type(tag) is str and node is model.unit.root:
            known: Element | None = traversal.cached_element(model, tag, name)
            if known is not None:
                return known
        found = traversal.find_first(ReferencedNode(self._alive()._model, node), tag, name)
        return None if found is None else view(*found)

    @short_traceback
    def find_all(
        self, tag: str, immediate_children_only: bool = False, exclude_attachments: bool = False
    ) -> list[Element]:
        """Return a list of all matches below this element in document order, each attached model at its host.

        With `exclude_attachments`, return only elements of this element's own model, including attachment frames. The
        model may be edited while iterating over the list. Raises `MjcfError` for a tag that MJCF does not have.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement()
        >>> arm = model.worldbody.add('body', name='arm')
        >>> hand = arm.add('body', name='hand')
        >>> model.find_all('body') == [arm, hand]
        True
        >>> model.worldbody.find_all('body', immediate_children_only=True) == [arm]
        True
        """
        here = ReferencedNode(self._alive()._model, self._node)
        every = traversal.find_every(here, tag, immediate_children_only)
        return [view(*found) for found in every if not exclude_attachments or found.model is here.model]

    def enter_scope(self, prefix: str) -> RootElement | None:
        """Return the model attached under a prefix, such as `gripper` or `arm/gripper/`, or None if there is none.

        In that model, elements are found by their own names: `root.enter_scope('gripper').find('joint', 'left')`.

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> arm.enter_scope('gripper') is gripper
        True
        """
        model = self._alive()._model
        prefix = as_name("prefix", prefix)
        found = traversal.find_attached(model, prefix if prefix.endswith(SEPARATOR) else prefix + SEPARATOR)
        return None if found is None else cast(RootElement, view(found, found.unit.root))

    def all_children(self) -> list[Element]:
        """Return a list of the children in document order, without those of attached models.

        >>> from mjcompose import mjcf
        >>> arm = mjcf.RootElement().worldbody.add('body', name='arm')
        >>> children = [arm.add('joint'), arm.add('geom', size=[1])]
        >>> arm.all_children() == children
        True
        """
        return [view(self._model, node) for node in self._alive()._node.iterchildren("*")]

    def _child_kind(self, tag: str) -> ElementType:
        kind = self._kind.children.get(tag) if isinstance(tag, str) else None
        if kind is None:
            raise unknown_tag(tag, f"`<{self.tag}>` cannot have a `{tag}`", self._kind.children)
        return kind


if TYPE_CHECKING:
    from mjcompose.mjcf.elements import Mujoco
else:
    Mujoco = Element  # finds its sections and attributes on access


class RootElement(RootView, Mujoco):
    """A whole model. Its sections are attributes, created when first accessed.

    >>> from mjcompose import mjcf
    >>> model = mjcf.RootElement('pendulum')
    >>> pole = model.worldbody.add('body', name='pole', pos=[0, 0, 1])
    >>> hinge = pole.add('joint', name='hinge', axis=[0, 1, 0])
    >>> model.actuator.add('motor', name='drive', joint=hinge).joint is hinge
    True
    """

    __slots__ = ()

    def __init__(self, model: str | None = None) -> None:
        """Make an empty model named `model`. Paths of files added to it are relative to the working directory."""
        super().__init__(
            ModelState(Unit(etree.Element("mujoco"), UNNAMED, Path(), label=UNNAMED, contents=ModelFiles(), door=ALL)),
            etree.Element("mujoco"),
        )
        object.__setattr__(self, "_node", self._model.unit.root)
        self._model.views[self._node] = self
        self._model.unit.origins.own(self._node, call_site())
        if model is not None:
            set_model_name(self._model, model)

    @property
    def parent_model(self) -> RootElement | None:
        """The root of the model that this one is attached to, or None if it is not attached.

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.parent_model is arm, arm.parent_model is None
        (True, True)
        """
        hung = self._model.hung
        return None if hung is None else _root_of(hung.parent)

    @property
    def root_model(self) -> RootElement:
        """The root of the whole composition, which is this root itself if the model is not attached.

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.root_model is arm.root_model is arm
        True
        """
        return _root_of(self._model.top)

    @property
    def attached_models(self) -> list[RootElement]:
        """The roots of the models attached to this one, in the order in which they were attached.

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> arm.attached_models == [gripper]
        True
        """
        return [_root_of(each.child) for each in self._model.attachments.values()]

    @short_traceback
    def attach(self, other: RootElement) -> Element:
        """Attach a model to the worldbody of this one, and return the attachment frame. See `Element.attach`.

        >>> from mjcompose import mjcf
        >>> cell, table = mjcf.RootElement('cell'), mjcf.RootElement('table')
        >>> frame = cell.attach(table)
        >>> frame.pos = [0, 0, 0.4]
        """
        model = self._model
        frame = attach(model, model.section(WORLD_SECTION), model_of(other, "what is attached"))
        return cast(Element, view(model, frame))

    @short_traceback
    def include_copy(self, other: RootElement, override: bool = False) -> None:
        """Copy everything in another model into this one, without a prefix. The other model does not change.

        Models attached to the other are copied and attached here. Files are still read from their present places.
        Keyframes are copied unchanged, so they have the lengths of the other model alone.

        Raises `MjcfError` with all conflicts, and changes nothing, if a name is already used or the two models have
        different settings. So does a compiler setting or top default class of one that would change the meaning of
        the other's elements. With `override`, the settings written in the other model are used; if they change the
        meaning of elements, an `MjcfWarning` is issued.

        >>> from mjcompose import mjcf
        >>> arm, tool = mjcf.RootElement('arm'), mjcf.RootElement('tool')
        >>> hammer = tool.worldbody.add('body', name='hammer')
        >>> arm.include_copy(tool)
        >>> arm.find('body', 'hammer') is hammer, arm.find('body', 'hammer')
        (False, <body name="hammer"/>)
        """
        include_copy(self._model, model_of(other, "what is included"), override)

    @short_traceback
    def compile_model(self, *, conflict: Policy = "error") -> Physics:
        """Compile the model and everything attached to it with MuJoCo, and return its `Physics`.

        The physics starts in the reference configuration. Later edits of the model do not affect it. `conflict` is
        described in `to_xml_string`. Raises `MjcfError` with the faults of the model and the origin of each fault, even
        if MuJoCo refuses the model.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement('ball')
        >>> ball = model.worldbody.add('geom', name='ball', size=[0.1])
        >>> model.compile_model().bind(ball).size
        array([0.1, 0. , 0. ])
        """
        return Physics.from_mjcf_model(self, conflict=conflict)

    @short_traceback
    def to_spec(self, *, conflict: Policy = "error") -> Any:
        """Return the model and everything attached to it as a new `mujoco.MjSpec`, with its files in memory.

        `conflict` is described in `to_xml_string`. Raises `MjcfError` if the model has faults or MuJoCo refuses it.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement('ball')
        >>> ball = model.worldbody.add('geom', name='ball', size=[0.1])
        >>> model.to_spec().geom('ball').name
        'ball'
        """
        return to_spec(self._model, conflict)

    def _repr_html_(self) -> str:
        """Return the model for notebooks: a collapsible tree, with a picture if OpenGL is available."""
        return page_with_picture(self._model)

    def __deepcopy__(self, memo: dict[int, Any]) -> RootElement:
        """Return a copy with copies of everything attached. The copy itself is not attached to anything."""
        return _root_of(duplicate(self._model, memo))


def _root_of(model: ModelState) -> RootElement:
    root = view(model, model.unit.root)
    assert isinstance(root, RootElement)
    return root


_E = TypeVar("_E", bound=Element)


class ElementList(Sequence[_E]):
    """The value of `body.geom`: the elements, by number or by name, at the time it was read.

    `del` and `clear()` remove elements from the model. To add elements, call `add` and `insert` of their parent.

    >>> from mjcompose import mjcf
    >>> world = mjcf.RootElement().worldbody
    >>> ball = world.add('geom', name='ball', size=[0.1])
    >>> world.geom['ball'] is world.geom[0] is ball
    True
    >>> del world.geom['ball']
    >>> world.geom
    []
    """

    __slots__ = ("_model", "_nodes", "_viewed", "tag")

    def __init__(self, tag: str, model: ModelState, nodes: Iterable[Node]) -> None:
        """For internal use. A list of elements is read from an attribute such as `body.geom`."""
        self.tag = tag
        self._model = model
        self._nodes = tuple(nodes)
        self._viewed: tuple[_E, ...] | None = None

    @property
    def _elements(self) -> tuple[_E, ...]:
        # Programs read one element of a long list in a loop, so the others are not created.
        if self._viewed is None:
            self._viewed = tuple(view(self._model, node) for node in self._nodes)
        return self._viewed

    @overload
    def __getitem__(self, index: SupportsIndex | str) -> _E: ...
    @overload
    def __getitem__(self, index: slice) -> list[_E]: ...
    def __getitem__(self, index: SupportsIndex | str | slice) -> _E | list[_E]:
        """Return an element by its index or by its name in its own model, or a list of elements for a slice.

        Raises `MjcfKeyError`, which is also a `KeyError`, if no element has the name.
        """
        if isinstance(index, slice):
            return list(self._elements[index])
        if not isinstance(index, str):
            element: _E = view(self._model, self._nodes[index])
            return element
        node = next((node for node in self._nodes if node.get("name") == index), None)
        if node is not None:
            named: _E = view(self._model, node)
            return named
        # An asset without a name is called after its file.
        for element in self._elements:
            if element.name == index:
                return element
        names = self._ipython_key_completions_()
        unnamed = Note(f"none of the {len(self)} elements here has a name: select them by index")
        message = f"the {self.tag} `{index}` does not exist here"
        fault = unknown_name(self.tag, index, names, span=call_site(), message=message)
        raise error_of(fault if names or not self else replace(fault, notes=(unnamed,)), MjcfKeyError)

    def __contains__(self, item: object) -> bool:
        """Return whether the list contains an element, or an element with this name."""
        return any(element.name == item if isinstance(item, str) else element is item for element in self._elements)

    def _ipython_key_completions_(self) -> list[str]:
        return [element.name for element in self._elements if element.name]

    def __delitem__(self, index: SupportsIndex | str | slice) -> None:
        """Remove an element, or several, from the model. See `Element.remove`."""
        found = self[index]
        elements = found if isinstance(found, list) else [found]
        for element in elements:
            element.remove()

    def __setitem__(self, index: SupportsIndex | str | slice, value: object) -> None:
        """Raise `MjcfError`: elements of the list cannot be replaced. Set their attributes, or insert another one."""
        help = f"set its attributes, or remove it and `insert('{self.tag}', position, …)` another one"
        raise failure("wrong-type", f"a {self.tag} of a list cannot be set", help=help)

    def clear(self) -> None:
        """Remove all elements of the list from the model."""
        del self[:]

    def __len__(self) -> int:
        return len(self._nodes)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ElementList | list) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(list(self._elements))
