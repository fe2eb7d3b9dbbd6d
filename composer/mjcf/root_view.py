"""The view of a model's root: the model's name, its text, its files. It needs no view of other nodes."""

from __future__ import annotations

from composer.link.request import Policy
from composer.mjcf.attaching import detach, set_model_name
from composer.mjcf.flat import assets, text
from composer.mjcf.node_view import NodeView


class RootView(NodeView):
    """The members of `RootElement` that need no other Element; see there."""

    __slots__ = ()

    @property
    def model(self) -> str:
        """The model's name. With a `/` appended, it is the prefix of the model's names when it is attached.

        If no name is written, it is the stem of the model's file, else `unnamed_model`. A new name must differ from
        those of the other models attached to the same parent. References in the parent are updated.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
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
        """The prefix of the model's names in the output of the whole composition; empty for the top model.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.full_identifier, arm.full_identifier
        ('gripper/', '')
        """
        return self._model.full_prefix

    def detach(self) -> None:
        """Detach this model from the one it is attached to.

        The attachment frame and its joints are removed. References from the parent into this model are reported as
        errors when the parent is written. Raises `MjcfError` if the model is not attached.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.detach()
        >>> gripper.parent_model is None
        True
        """
        detach(self._model)

    def to_xml_string(self, *, conflict: Policy = "error") -> str:
        """Return the model and everything attached to it as MJCF text. The model itself does not change.

        Files have the names of `assets`, so that `mujoco.MjModel.from_xml_string(root.to_xml_string(), root.assets)`
        compiles the text. No file is read. Each attached model keeps its meaning: its units, default classes and
        inertia rules apply to it alone.

        Raises `MjcfError` with all faults: references to names that do not exist, with all elements that refer to
        them, names that clash, and what MuJoCo does not support. If nothing is attached to a model, the lengths of
        its keyframes are not checked before it is compiled or exported.

        The output has one `option`, one `visual` and one `statistic`. `conflict` determines what happens if an
        attached model writes a value there that this model does not have:

        - `error`: raise `MjcfError`.
        - `warning`: keep this model's value.
        - `merge`: combine the two as MuJoCo's own attach does. A value that this model does not write is taken from
          the attached model; of two time steps or tolerances the smaller one is used, of two numbers of iterations
          the larger one.

        The last two issue an `MjcfWarning` for each such value.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement('ball')
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

    @property
    def assets(self) -> dict[str, bytes]:
        """The bytes of all files of the model and everything attached to it, by their names in `to_xml_string()`.

        No two names end in the same file name, because MuJoCo looks up files in memory by their file name alone.
        Raises `MjcfError` for files that cannot be read.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement('table')
        >>> wood = model.asset.add('texture', name='wood', type='2d', file=mjcf.Asset(b'...', '.png', 'wood'))
        >>> model.assets
        {'assets/table/wood.png': b'...'}
        """
        return assets(self._model)
