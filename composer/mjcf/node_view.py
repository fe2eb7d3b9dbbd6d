"""The view of one node: its name, its origin, its text, its copies. It needs no view of other nodes."""

from __future__ import annotations

from typing import Any, Self, cast

from composer.diagnostics.call_site import call_site
from composer.diagnostics.span import Span
from composer.mjcf.attaching import HOSTS
from composer.mjcf.attributed import Attributed
from composer.mjcf.duplicate import copied
from composer.mjcf.errors import failure
from composer.mjcf.html import page
from composer.mjcf.model import Model
from composer.mjcf.pickled import reduced
from composer.mjcf.text import text
from composer.tree.kinds import naming_attribute, spoken


class NodeView(Attributed):
    """The members of `Element` that need no other Element; see there."""

    __slots__ = ()

    @property
    def name(self) -> str | None:
        """The name of the element in its own model, without prefixes, or None if it has none.

        Setting a new name updates all references to the element. The name must not be used anywhere in the composition.
        The name of a default class is its `class`. As in MuJoCo, the name of an asset without one is the stem of its
        file.

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
        """The name in the output of the whole composition, including prefixes, or None if it has none.

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
        """Where the element came from: a place in a file, or the line of the program that added it.

        >>> from composer import mjcf
        >>> lines = ['<mujoco>', '<worldbody><geom name="ball" size="1"/></worldbody>', '</mujoco>']
        >>> mjcf.from_xml_string(chr(10).join(lines)).find('geom', 'ball').origin.line
        2
        """
        return self._alive()._model.span(self._node)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Return the element's counterpart in the copy of its model.

        Raises `MjcfError` for an element that is copied alone.
        """
        if not memo:
            raise failure(
                "not-supported",
                "an element cannot be copied without its model",
                call_site(),
                help="copy the model: `copy.deepcopy(element.root)`",
            )
        return cast(Self, copied(self, memo))

    def __copy__(self) -> Self:
        return self.__deepcopy__({})

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the element with its whole composition. Elements pickled together keep sharing one composition."""
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
        """Return the element and everything below it in its own model as MJCF text. Comments mark attached models."""
        return text(self._model, self._node)

    def _repr_html_(self) -> str:
        """Return the element as a collapsible tree for notebooks."""
        return page(self._model, self._node)


def model_of(root: object, what: str) -> Model:
    """Return the model of a `RootElement`. Raises `MjcfError` for anything else; `what` names the argument."""
    if not isinstance(root, NodeView) or root._node is not root._model.unit.root:
        raise failure("wrong-type", f"{what} is a `RootElement`, got `{type(root).__name__}`", call_site())
    return root._model


def checked(element: object) -> NodeView:
    """Return the argument if it is an element of a model. Raises `MjcfError` if it is not, or was removed."""
    if not isinstance(element, NodeView):
        raise failure("wrong-type", f"expects an element, got `{type(element).__name__}`", call_site())
    return element._alive()
