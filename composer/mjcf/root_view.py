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
        """The model's name, and with a `/` the prefix that its names get where it is attached.

        Where none is written it is the stem of the model's file, else `unnamed_model`. A new name must
        differ from those of the models attached to the same parent; references from there follow.

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
        """The prefix of all its names in the output of the whole composition; empty at the top.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.full_identifier, arm.full_identifier
        ('gripper/', '')
        """
        return self._model.full_prefix

    def detach(self) -> None:
        """Take this model off the one it is attached to.

        The attachment frame and its joints are gone; whatever in the parent refers to something here is
        reported when the parent is written. Raises `MjcfError` where it is not attached.

        >>> from composer import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.detach()
        >>> gripper.parent_model is None
        True
        """
        detach(self._model)

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
        """The files of the model and all that is attached to it, by their names in `to_xml_string()`.

        No two end in the same file name, as MuJoCo goes by that alone. Raises `MjcfError` for files that
        cannot be read.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement('table')
        >>> wood = model.asset.add('texture', name='wood', type='2d', file=mjcf.Asset(b'...', '.png', 'wood'))
        >>> model.assets
        {'assets/table/wood.png': b'...'}
        """
        return assets(self._model)
