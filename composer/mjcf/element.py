"""The element of a model as Python sees it: a view, made on demand, of one node."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.span import Span
from composer.grammar import ElementType
from composer.mjcf import edit, finding
from composer.mjcf.arguments import as_index, as_name
from composer.mjcf.attaching import HOSTS, attach
from composer.mjcf.attributed import Attributed, targets
from composer.mjcf.call_site import call_site
from composer.mjcf.duplicate import copied
from composer.mjcf.errors import failure
from composer.mjcf.html import page
from composer.mjcf.misspelled import unknown_tag
from composer.mjcf.model import Model, Target
from composer.mjcf.pickled import reduced
from composer.mjcf.removal import remove
from composer.mjcf.text import text
from composer.mjcf.views import view, views_of
from composer.tree.kinds import (
    naming_attribute,
    spoken,
)
from composer.tree.name_index import SEPARATOR

if TYPE_CHECKING:
    from composer.mjcf.root import RootElement


@views_of("element")
class Element(Attributed):
    """One element of a model.

    Its MJCF attributes are Python attributes: numbers and arrays come as numpy, references as Elements,
    files as `Asset`, keywords and names as text; what is not set is None, and setting None removes. What is
    changed in an array is set: `body.pos[2] += 1`. `class` is spelled `dclass`; a last underscore is dropped
    (`global_`). Children are reached by tag: one that can
    occur once as an Element (`model.visual.headlight`), others as a list (`body.geom`) that also takes names.
    `dir(element)` has all of them, `help(element)` what they mean; `print(element)` shows it as MJCF.

    There is one Element for each element of a model: `a.find('joint', 'j') is a.find('joint', 'j')`.
    """

    __slots__ = ()

    # -- what it is ------------------------------------------------------------------------------------------

    @property
    def parent(self) -> Element | None:
        """The element it stands in; None for a root, whose model may hang on another: see `parent_model`.

        >>> from composer import mjcf
        >>> arm = mjcf.RootElement().worldbody.add('body', name='arm')
        >>> arm.add('geom', size=[1]).parent is arm
        True
        """
        parent = self._alive()._node.getparent()
        return None if parent is None else view(self._model, parent)

    @property
    def root(self) -> RootElement:
        """The root of its own model, attached or not.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement('arm')
        >>> model.worldbody.add('geom', size=[1]).root is model
        True
        """
        return cast("RootElement", view(self._alive()._model, self._model.unit.root))

    @property
    def name(self) -> str | None:
        """The name in its own model, without prefixes; None where it has none.

        A new name must be free in the whole composition, and whatever refers to the element follows. The
        name of a default class is its class, that of an asset without one the stem of its file, as MuJoCo
        has it.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement()
        >>> arm = model.worldbody.add('body', name='arm')
        >>> sensor = model.sensor.add('framepos', objtype='body', objname=arm)
        >>> arm.name = 'left'
        >>> sensor
        <framepos objtype="body" objname="left"/>
        """
        return self._own_name()

    @name.setter
    def name(self, name: str | None) -> None:
        attribute = naming_attribute(self._kind)
        self._write({attribute.name if attribute else "name": name})

    @property
    def full_identifier(self) -> str | None:
        """The name in the output of the whole composition, prefixes included; None where it has none.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> finger = gripper.worldbody.add('body', name='finger')
        >>> frame = arm.attach(gripper)
        >>> finger.name, finger.full_identifier
        ('finger', 'gripper/finger')
        """
        model = self._alive()._model
        return model.seen_from(model.top, self._node)

    @property
    def origin(self) -> Span:
        """The place it came from: in a file, or the line of the program that added it.

        >>> from composer import mjcf
        >>> lines = ['<mujoco>', '<worldbody><geom name="ball" size="1"/></worldbody>', '</mujoco>']
        >>> mjcf.from_xml_string(chr(10).join(lines)).find('geom', 'ball').origin.line
        2
        """
        return self._alive()._model.span(self._node)

    # -- adding and removing ---------------------------------------------------------------------------------

    def add(self, tag: str, /, **attributes: object) -> Element:
        """Append a child and give it back.

        Values may be numbers, arrays, text, booleans and Elements; None leaves an attribute out. An Element
        without a name gets one, `unnamed_joint_0`, as MJCF refers by name. Raises
        `MjcfError`, with what is there instead, for a tag or attribute that MJCF does not have here, a
        value of a wrong type or length, and a name that is taken; then nothing has changed.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement()
        >>> model.worldbody.add('geom', name='ball', type='sphere', size=[0.1])
        <geom name="ball" type="sphere" size="0.1"/>
        """
        return self._add(tag, None, attributes)

    def insert(self, tag: str, /, position: int, **attributes: object) -> Element:
        """The same, before the child that stands at `position` now; as with lists, a large one appends.

        >>> from composer import mjcf
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
            raise failure(
                "name-clash",
                f"{self._described()} has a `<{kind.tag}>` already, and can have one only",
                call_site(),
                notes=(Note("it is here", self._model.span(existing)),),
            )
        checked = edit.check(self._model, kind, targets(attributes))
        if existing is None and self._kind.tag == "mujoco":
            existing = self._model.section(kind.tag)
        if existing is not None:
            edit.write(self._model, existing, checked)
            self._model.unit.origins.own(existing, call_site())
            return cast(Element, view(self._model, existing))
        made = edit.create(self._model, self._node, kind.tag, checked, position)
        return cast(Element, view(self._model, made))

    def remove(self, cascade: bool = False) -> None:
        """Take it and all below it out of the model; models attached there are detached.

        What refers to it stays and is told when the model is written, every referrer by name. With
        `cascade` it goes too: references to classes and materials are dropped from the elements that have
        them, any other referrer is removed, in a section as a whole (a tendon goes with a site of its
        path). A section is emptied.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement()
        >>> hinge = model.worldbody.add('body', name='arm').add('joint', name='hinge')
        >>> motor = model.actuator.add('motor', joint=hinge)
        >>> hinge.remove(cascade=True)
        >>> model.find_all('actuator')
        []
        """
        self._alive()
        remove(self._model, self._node, cascade)

    def attach(self, other: RootElement) -> Element:
        """Hang a model on this site, body, frame or worldbody; gives the attachment frame.

        The child keeps its names and can be edited on; here they are seen under its prefix
        (`gripper/left_pad`). The frame has an offset (`frame.pos`, `frame.quat`, …) and takes joints;
        without one the child is fixed and no body is added. Raises `MjcfError` where the child is attached
        already, contains this model, or has the prefix of another child.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> flange = arm.worldbody.add('site', name='flange', pos=[0, 0, 1])
        >>> frame = flange.attach(gripper)
        >>> frame.add('joint', name='turn', axis=[0, 0, 1]).full_identifier
        'gripper/turn'
        """
        model = self._alive()._model
        return cast(Element, view(model, attach(model, self._node, model_of(other, "what is attached"))))

    # -- finding ---------------------------------------------------------------------------------------------

    def find(self, tag: str, name: str | None = None) -> Element | None:
        """The first match below this element in document order, or None.

        `tag` may be a family: `joint` also finds `freejoint`; `actuator`, `sensor`, `equality`, `tendon`
        and `key` find all of theirs. `name` is the name in this element's model; of attached models with
        the prefix (`gripper/left_pad`). Raises `MjcfError` for a tag that MJCF does not have.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement()
        >>> hinge = model.worldbody.add('body', name='arm').add('joint', name='hinge')
        >>> model.find('joint', 'hinge') is model.find('body', 'arm').find('joint') is hinge
        True
        >>> model.find('joint', 'slide') is None
        True
        """
        model, node = self._model, self._node
        if type(name) is str and type(tag) is str and node is model.unit.root:
            known: Element | None = finding.at_hand(model, tag, name)
            if known is not None:
                return known
        found = finding.first(Target(self._alive()._model, node), tag, name)
        return None if found is None else view(*found)

    def find_all(
        self, tag: str, immediate_children_only: bool = False, exclude_attachments: bool = False
    ) -> list[Element]:
        """All matches below this element in document order, attached models where they hang.

        With `exclude_attachments` those of its own model only, attachment frames included. The list is made
        once: the model may be edited while going through it.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement()
        >>> arm = model.worldbody.add('body', name='arm')
        >>> hand = arm.add('body', name='hand')
        >>> model.find_all('body') == [arm, hand]
        True
        >>> model.worldbody.find_all('body', immediate_children_only=True) == [arm]
        True
        """
        here = Target(self._alive()._model, self._node)
        every = finding.every(here, tag, immediate_children_only)
        return [view(*found) for found in every if not exclude_attachments or found.model is here.model]

    def enter_scope(self, prefix: str) -> RootElement | None:
        """The model that is attached under a prefix, `gripper` or `arm/gripper/`; None where there is none.

        In it everything is found by its own name: `root.enter_scope('gripper').find('joint', 'left')`.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> arm.enter_scope('gripper') is gripper
        True
        """
        model, prefix = self._alive()._model, as_name("prefix", prefix)
        found = finding.attached(model, prefix if prefix.endswith(SEPARATOR) else prefix + SEPARATOR)
        return None if found is None else cast("RootElement", view(found, found.unit.root))

    def all_children(self) -> list[Element]:
        """The children in their order, those of its own model only.

        >>> from composer import mjcf
        >>> arm = mjcf.RootElement().worldbody.add('body', name='arm')
        >>> children = [arm.add('joint'), arm.add('geom', size=[1])]
        >>> arm.all_children() == children
        True
        """
        return [view(self._model, node) for node in self._alive()._node.iterchildren("*")]

    def __deepcopy__(self, memo: dict[int, Any]) -> Element:
        """Among other things that are copied: the element of the copy of its model."""
        if not memo:
            raise failure(
                "not-supported",
                "an element cannot be copied without its model",
                call_site(),
                help="copy the model: `copy.deepcopy(element.root)`",
            )
        return cast(Element, copied(self, memo))

    def __copy__(self) -> Element:
        return self.__deepcopy__({})

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled with the whole composition: what is pickled together stays together."""
        return reduced(self)

    def __dir__(self) -> list[str]:
        kind = self._kind
        attributes, children = map(spoken, kind.attributes), map(spoken, kind.children)
        found = {*super().__dir__(), *attributes, *children}
        return sorted(found if kind.path in HOSTS else found - {"attach"})

    def __repr__(self) -> str:
        attributes = "".join(f' {name!s}="{value!s}"' for name, value in self._node.items())
        return f"<{self.tag}{attributes}>…</{self.tag}>" if len(self._node) else f"<{self.tag}{attributes}/>"

    def __str__(self) -> str:
        """The element and all below it in its own model, as MJCF text; comments say where models are attached."""
        return text(self._model, self._node)

    def _repr_html_(self) -> str:
        """The element as a tree that opens and closes, for notebooks."""
        return page(self)

    def _child_kind(self, tag: str) -> ElementType:
        kind = self._kind.children.get(tag) if isinstance(tag, str) else None
        if kind is None:
            raise unknown_tag(tag, f"`<{self.tag}>` cannot have a `{tag}`", self._kind.children)
        return kind


def model_of(root: object, what: str) -> Model:
    """The model of an argument that has to be a root."""
    if not isinstance(root, Element) or root._node is not root._model.unit.root:
        raise failure("wrong-type", f"{what} is a `RootElement`, got `{type(root).__name__}`", call_site())
    return root._model


def checked(element: object) -> Element:
    """An argument that has to be an element of a model."""
    if not isinstance(element, Element):
        raise failure("wrong-type", f"expects an element, got `{type(element).__name__}`", call_site())
    return element._alive()
