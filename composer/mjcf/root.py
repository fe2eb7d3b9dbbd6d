"""The root of a model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from lxml import etree

from composer.link.request import Policy
from composer.mjcf.asset import Files
from composer.mjcf.attaching import attach, detach, set_model_name
from composer.mjcf.call_site import call_site
from composer.mjcf.duplicate import duplicate
from composer.mjcf.element import Element, model_of
from composer.mjcf.flat import assets, text
from composer.mjcf.html import page_with_picture
from composer.mjcf.including import include_copy
from composer.mjcf.model import UNNAMED, Model
from composer.mjcf.views import view, views_of
from composer.tree.kinds import WORLD_SECTION
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from composer.mjcf.physics.physics import Physics


@views_of("root")
class RootElement(Element):
    """A whole model; its sections are attributes, made when first asked for.

    >>> model = RootElement('pendulum')
    >>> pole = model.worldbody.add('body', name='pole', pos=[0, 0, 1])
    >>> hinge = pole.add('joint', name='hinge', axis=[0, 1, 0])
    >>> model.actuator.add('motor', name='drive', joint=hinge).joint is hinge
    True
    """

    __slots__ = ()

    compiler: Element
    option: Element
    size: Element
    statistic: Element
    visual: Element
    default: Element
    extension: Element
    asset: Element
    worldbody: Element
    deformable: Element
    contact: Element
    tendon: Element
    equality: Element
    actuator: Element
    sensor: Element
    custom: Element
    keyframe: Element

    def __init__(self, model: str | None = None) -> None:
        """An empty model called `model`; files that are added to it resolve against the working directory."""
        super().__init__(Model(_empty_unit()), etree.Element("mujoco"))
        object.__setattr__(self, "_node", self._model.unit.root)
        self._model.views[self._node] = self
        self._model.unit.origins.own(self._node, call_site())
        if model is not None:
            set_model_name(self._model, model)

    @property
    def model(self) -> str:
        """The model's name, and with a `/` the prefix that its names get where it is attached.

        Where none is written it is the stem of the model's file, else `unnamed_model`. A new name must
        differ from those of the models attached to the same parent; references from there follow.

        >>> arm, gripper = RootElement('arm'), RootElement('gripper')
        >>> finger = gripper.worldbody.add('body', name='finger')
        >>> frame = arm.attach(gripper)
        >>> gripper.model = 'left'
        >>> finger.full_identifier
        'left/finger'
        """
        return self._model.name

    @model.setter
    def model(self, name: str | None) -> None:
        set_model_name(self._model, name)

    @property
    def full_identifier(self) -> str:
        """The prefix of all its names in the output of the whole composition; empty at the top.

        >>> arm, gripper = RootElement('arm'), RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.full_identifier, arm.full_identifier
        ('gripper/', '')
        """
        return self._model.full_prefix

    @property
    def parent_model(self) -> RootElement | None:
        """The root of the model that this one is attached to, or None.

        >>> arm, gripper = RootElement('arm'), RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.parent_model is arm, arm.parent_model is None
        (True, True)
        """
        hung = self._model.hung
        return None if hung is None else _root_of(hung.parent)

    @property
    def root_model(self) -> RootElement:
        """The root of the whole composition; itself where it is not attached.

        >>> arm, gripper = RootElement('arm'), RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.root_model is arm.root_model is arm
        True
        """
        return _root_of(self._model.top)

    @property
    def attached_models(self) -> list[RootElement]:
        """The roots of the models attached to this one, in the order in which they were.

        >>> arm, gripper = RootElement('arm'), RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> arm.attached_models == [gripper]
        True
        """
        return [_root_of(each.child) for each in self._model.attachments.values()]

    def attach(self, other: RootElement) -> Element:
        """Hang a model in the world of this one; gives the attachment frame. See `Element.attach`.

        >>> cell, table = RootElement('cell'), RootElement('table')
        >>> frame = cell.attach(table)
        >>> frame.pos = [0, 0, 0.4]
        """
        model = self._model
        frame = attach(model, model.section(WORLD_SECTION), model_of(other, "what is attached"))
        return cast(Element, view(model, frame))

    def detach(self) -> None:
        """Take this model off the one it is attached to.

        The attachment frame and its joints are gone; whatever in the parent refers to something here is
        told when the parent is written. Raises `MjcfError` where it is not attached.

        >>> arm, gripper = RootElement('arm'), RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.detach()
        >>> gripper.parent_model is None
        True
        """
        detach(self._model)

    def include_copy(self, other: RootElement, override: bool = False) -> None:
        """Take a copy of all that another model has into this one, without a prefix; the other stays as it is.

        What is attached to the other is copied and attached here; files keep coming from where they are.
        Raises `MjcfError` with everything that stands against it, and changes nothing, where names are
        taken, where the two have different settings, or where a compiler setting or top default class of
        one would give the elements of the other another meaning. With `override` the settings that the
        other writes count; where elements get another meaning by it, an `MjcfWarning` tells. Keyframes
        come as they are: their lengths are those of the other alone.

        >>> arm, tool = RootElement('arm'), RootElement('tool')
        >>> hammer = tool.worldbody.add('body', name='hammer')
        >>> arm.include_copy(tool)
        >>> arm.find('body', 'hammer') is hammer, arm.find('body', 'hammer')
        (False, <body name="hammer"/>)
        """
        include_copy(self._model, model_of(other, "what is included"), override)

    def to_xml_string(self, *, conflict: Policy = "error") -> str:
        """The model with everything attached to it, as MJCF text; the model itself stays as it is.

        Files are named as in `assets`, so that `mujoco.MjModel.from_xml_string(root.to_xml_string(),
        root.assets)` compiles it; no file is read. Each attached model means what it means alone: its
        units, default classes and inertia rules are its own. Raises `MjcfError` with all faults: references
        to nothing with everyone who refers, names that clash, what MuJoCo cannot have. Only the keys of a
        model that nothing is attached to are not counted before it is compiled or exported.

        Of `option`, `visual` and `statistic` a model has one. Where an attached model writes a value that
        this one does not have, `conflict` says what happens: `error`; `warning`, this model's value stands;
        `merge`, they are combined as MuJoCo's own attach does (what is not written here is taken over; of
        two the smaller time step and tolerance, the larger number of iterations). The last two issue an
        `MjcfWarning` for each.

        >>> model = RootElement('ball')
        >>> ball = model.worldbody.add('geom', size=[0.1])
        >>> print(model.to_xml_string())
        <mujoco model="ball">
          <worldbody>
            <geom size="0.1"/>
          </worldbody>
        </mujoco>
        <BLANKLINE>
        """
        return text(self._model, conflict)

    def compile_model(self, *, conflict: Policy = "error") -> Physics:
        """The model with everything attached to it, compiled by MuJoCo: its physics in the reference configuration.

        Later edits do not reach it. `conflict` is that of `to_xml_string`. Raises `MjcfError` with what is
        wrong with the model, at the place it comes from, also where it is MuJoCo that refuses it.

        >>> model = RootElement('ball')
        >>> ball = model.worldbody.add('geom', name='ball', size=[0.1])
        >>> model.compile_model().bind(ball).size
        array([0.1, 0. , 0. ])
        """
        from composer.mjcf.physics.physics import Physics

        return Physics.from_mjcf_model(self, conflict=conflict)

    def to_spec(self, *, conflict: Policy = "error") -> Any:
        """The model with everything attached to it as a `mujoco.MjSpec` of its own, its files in memory.

        `conflict` is that of `to_xml_string`. Raises `MjcfError`.

        >>> model = RootElement('ball')
        >>> ball = model.worldbody.add('geom', name='ball', size=[0.1])
        >>> model.to_spec().geom('ball').name
        'ball'
        """
        from composer.mjcf.physics.to_spec import to_spec

        return to_spec(self._model, conflict)

    @property
    def assets(self) -> dict[str, bytes]:
        """The files of the model and all that is attached to it, by their names in `to_xml_string()`.

        No two end in the same file name, as MuJoCo goes by that alone. Raises `MjcfError` for files that
        cannot be read.

        >>> from composer import mjcf
        >>> model = RootElement('table')
        >>> wood = model.asset.add('texture', name='wood', type='2d', file=mjcf.Asset(b'...', '.png', 'wood'))
        >>> model.assets
        {'assets/table/wood.png': b'...'}
        """
        return assets(self._model)

    def _repr_html_(self) -> str:
        """The model as a tree that opens and closes, with its picture where there is OpenGL, for notebooks."""
        return page_with_picture(self)

    def __deepcopy__(self, memo: dict[int, Any]) -> RootElement:
        """A copy with copies of everything attached, itself attached to nothing."""
        return _root_of(duplicate(self._model, memo))


def _root_of(model: Model) -> RootElement:
    root = view(model, model.unit.root)
    assert isinstance(root, RootElement)
    return root


def _empty_unit() -> Unit:
    return Unit(etree.Element("mujoco"), UNNAMED, Path(), UNNAMED, Files())
