"""The methods of a view that need no other elements, and the attaching of models."""

from __future__ import annotations

import copy
from typing import Any, Self, cast

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Span, call_site
from mjcompose.base.report import short_traceback
from mjcompose.base.sink import Sink
from mjcompose.link.linking import Policy
from mjcompose.mjcf import edit
from mjcompose.mjcf.asset import add_files, renamed_skins, skins_after_renaming
from mjcompose.mjcf.attributed import Attributed
from mjcompose.mjcf.edit import release
from mjcompose.mjcf.errors import failure, raise_errors
from mjcompose.mjcf.flat import assets, text as flat_text
from mjcompose.mjcf.include import copied, pickled_element
from mjcompose.mjcf.model import AttachedModel, ModelState, ReferencedNode, page
from mjcompose.mjcf.value import describe, update_references
from mjcompose.tree.edit import Renaming, assign, replace
from mjcompose.tree.names import SEPARATOR
from mjcompose.tree.select import WORLD_SECTION, kind_of, naming_attribute, spoken
from mjcompose.tree.unit import counterpart

ESCAPED = "\\"


def escape_separators(model: ModelState) -> None:
    r"""Replace every `/` by `\` in all names and references. Raises `MjcfError` if two names would become equal."""
    sink = Sink()
    every = ((space, name, node) for space, names in model.names.declared.items() for name, node in names.items())
    declared = [each for each in every if SEPARATOR in each[1]]
    for namespace, name, node in declared:
        taken = model.names.find(namespace, _escaped(name))
        if taken is not None:
            message = f"{describe(model, node)} would be called `{_escaped(name)}`, as another {namespace} is"
            help = "rename one of the two, or read the model without `escape_separators`"
            notes = (Note("the other is here", model.span(taken)),)
            sink.error("name-clash", message, model.span(node), notes=notes, help=help)
    raise_errors(sink)
    add_files(model, renamed_skins(model, _escaped))
    for _, name, node in declared:
        attribute = naming_attribute(kind_of(node))
        assert attribute is not None
        assign(model, node, {attribute.name: _escaped(name)})
    for namespace, uses in model.names.uses.items():
        model.names.follow(namespace, {name: _escaped(name) for name in uses if SEPARATOR in name})
    if SEPARATOR in model.unit.model:
        model.unit.root.set("model", _escaped(model.unit.model))


def _escaped(name: str) -> str:
    return name.replace(SEPARATOR, ESCAPED)


# Paths of the elements that a model can hang on.
HOSTS = ("site", "body", "frame", WORLD_SECTION)


def attach(model: ModelState, host: Node, child: ModelState) -> Node:
    """Attach `child` to a node and return the attachment frame. See `Element.attach`."""
    place = describe(model, host)
    if kind_of(host).path not in HOSTS or model.frame_above(host) is not None:
        help = "attach to a site, a body, a frame or the worldbody"
        raise failure("attach-place", f"nothing can be attached to {place}", help=help)
    if any(above.tag == "replicate" for above in host.iterancestors()):
        raise failure("not-supported", f"{place} is inside a `<replicate>`, which nothing can be attached to")
    if child is model or child in model.ancestors():
        where = "itself" if child is model else f"{place}, which is part of it"
        raise failure("attach-cycle", f"`{child.name}` cannot be attached to {where}")
    if child.hung is not None:
        there = child.hung
        place = f"{describe(there.parent, there.host)} of `{there.parent.name}`"
        notes = (Note("it was attached here", there.parent.span(there.frame)),)
        help = "`detach()` it first, or attach a copy: `copy.deepcopy(model)`"
        raise failure("attach-place", f"`{child.name}` is attached already, to {place}", notes=notes, help=help)
    _check_prefix(model, child, child.name)
    frame = etree.Element("body")
    child.hung = model.attachments[child.prefix] = AttachedModel(model, child, host, frame=frame)
    update_references(model.top)
    model.unit.origins.own(frame, call_site())
    return frame


def set_model_name(model: ModelState, name: str | None) -> None:
    """Rename a model. If it is attached, update the references from the models above to the new prefix."""
    text = edit.check(model, kind_of(model.unit.root), {"model": name}).texts["model"]
    attachment = model.hung
    old = model.prefix
    if attachment is not None:
        _check_prefix(attachment.parent, model, name or model.unit.label, itself=model)
        new = (text or model.unit.label) + SEPARATOR
        renaming = Renaming.of_prefix(attachment.parent, old, new)
        edit.check_lists(renaming)
        skins = skins_after_renaming(attachment.parent, old, new, is_prefix=True) if new != old else []
    replace(model.unit.root, {"model": text})
    if attachment is None or model.prefix == old:
        return
    for changed, files in skins:
        add_files(changed, files)
    parent = attachment.parent
    parent.attachments = {each.child.prefix: each for each in parent.attachments.values()}
    renaming.carry_out()


def _check_prefix(model: ModelState, child: ModelState, name: str, itself: ModelState | None = None) -> None:
    """Raise `MjcfError` if another child of `model` has the prefix `name/`, or if a name of the child would clash."""
    prefix = f"{name}/"
    taken = model.attachments.get(prefix)
    if taken is not None and taken.child is not itself:
        message = f"a model called `{name}` is attached to `{model.name}` already"
        help = "give one of the two another name first: `other.model = '…'`"
        raise failure("name-clash", message, notes=(Note("it was attached here", model.span(taken.frame)),), help=help)
    full = prefix
    for here in (model, *model.ancestors()):
        for namespace, names in here.names.declared.items():
            for known, node in names.items():
                if not known.startswith(full):
                    continue
                rest = known[len(full) :]
                found = child.lookup_attached(namespace, rest)
                if found is None and child.hung is not None:
                    between = child.hung.find(namespace, rest)
                    found = None if between is None else ReferencedNode(child.hung.parent, between)
                if found is not None:
                    one = here.span(node)
                    other = found.model.span(found.node)
                    message = f"there is a {namespace} `{known}` in `{here.name}`, which would have two"
                    help = "rename one of the two, or rename the model: `other.model = '…'`"
                    notes = (Note("one is here", one), Note("the other is here", other))
                    raise failure("name-clash", message, notes=notes, help=help)
        full = here.prefix + full


def text(model: ModelState, node: Node) -> str:
    """Return a node and everything below it as MJCF without a final newline. Comments mark attached models."""
    copied = copy.deepcopy(node)
    for attachment in model.attachments.values():
        if attachment.host is node or node in attachment.host.iterancestors():
            note = etree.Comment(f" {attachment.child.prefix} is attached here ")
            counterpart(attachment.host, node, copied).append(note)
    copied.tail = None
    for each in copied.iter():
        if isinstance(each.tag, str) and not (each.text or "").strip():
            each.text = None
        if not (each.tail or "").strip():
            each.tail = None
    return etree.tostring(copied, encoding="unicode", pretty_print=True).rstrip()


class NodeView(Attributed):
    """The members of `Element` that need no other Element; see there."""

    __slots__ = ()

    @property
    def name(self) -> str | None:
        """The name of the element in its own model, without prefixes, or None if it has none.

        Setting a new name updates all references to the element. The name must not be used anywhere in the composition.
        The name of a default class is its `class`. As in MuJoCo, the name of an asset without one is the stem of its
        file.

        >>> from mjcompose import mjcf
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

        >>> from mjcompose import mjcf
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

        >>> from mjcompose import mjcf
        >>> lines = ['<mujoco>', '<worldbody><geom name="ball" size="1"/></worldbody>', '</mujoco>']
        >>> mjcf.from_xml_string(chr(10).join(lines)).find('geom', 'ball').origin.line
        2
        """
        return self._alive()._model.span(self._node)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Return the counterpart in the copy of its model. Raises `MjcfError` for an element that is copied alone."""
        if not memo:
            message = "an element cannot be copied without its model"
            raise failure("not-supported", message, help="copy the model: `copy.deepcopy(element.root)`")
        return cast(Self, copied(self, memo))

    def __copy__(self) -> Self:
        return self.__deepcopy__({})

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the element with its whole composition. Elements pickled together keep sharing one composition."""
        return pickled_element(self)

    def __dir__(self) -> list[str]:
        kind = self._kind
        attributes = map(spoken, kind.attributes)
        children = map(spoken, kind.children)
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


def model_of(root: object, what: str) -> ModelState:
    """Return the model of a `RootElement`. Raises `MjcfError` for anything else; `what` names the argument."""
    if not isinstance(root, NodeView) or root._node is not root._model.unit.root:
        raise failure("wrong-type", f"{what} is a `RootElement`, got `{type(root).__name__}`")
    return root._model


def checked(element: object) -> NodeView:
    """Return the argument if it is an element of a model. Raises `MjcfError` if it is not, or was removed."""
    if not isinstance(element, NodeView):
        raise failure("wrong-type", f"expects an element, got `{type(element).__name__}`")
    return element._alive()


class RootView(NodeView):
    """The members of `RootElement` that need no other Element; see there."""

    __slots__ = ()

    @property
    def model(self) -> str:
        """The model's name. With a `/` appended, it is the prefix of the model's names when it is attached.

        If no name is written, it is the stem of the model's file, else `unnamed_model`. A new name must differ from the
        names of the other models attached to the same parent. References in the parent are updated.

        >>> from mjcompose import mjcf
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

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.full_identifier, arm.full_identifier
        ('gripper/', '')
        """
        return self._model.full_prefix

    @short_traceback
    def detach(self) -> None:
        """Detach this model from the one it is attached to.

        The attachment frame and its joints are removed. References from the parent into this model are reported as
        errors when the parent is written. Raises `MjcfError` if the model is not attached.

        >>> from mjcompose import mjcf
        >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
        >>> frame = arm.attach(gripper)
        >>> gripper.detach()
        >>> gripper.parent_model is None
        True
        """
        if self._model.hung is None:
            raise failure("attach-place", f"`{self._model.name}` is not attached to anything")
        release(self._model.hung.parent, self._model.prefix)

    @short_traceback
    def to_xml_string(self, *, conflict: Policy = "error") -> str:
        """Return the model and everything attached to it as MJCF text. The model itself does not change.

        Files have the names of `assets`, so `mujoco.MjModel.from_xml_string(root.to_xml_string(), root.assets)`
        compiles the text. No file is read. Each attached model keeps its meaning: its units, default classes and
        inertia rules apply to it alone.

        Raises `MjcfError` with all faults: references to names that do not exist, with all elements that refer to them,
        names that clash, and features that MuJoCo does not support. If nothing is attached to a model, the lengths of
        its keyframes are not checked before it is compiled or exported.

        The output has one `option`, one `visual` and one `statistic`. `conflict` determines what happens if an
        attached model writes a value there that this model does not have:

        - `error`: raise `MjcfError`.
        - `warning`: keep this model's value.
        - `merge`: combine the two as MuJoCo's own attach does. A value that this model does not write is taken from
          the attached model; of two time steps or tolerances the smaller one is used, of two numbers of iterations
          the larger one.

        The last two issue an `MjcfWarning` for each such value.

        >>> from mjcompose import mjcf
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
        return flat_text(self._model, conflict)

    @property
    def assets(self) -> dict[str, bytes]:
        """The bytes of all files of the model and everything attached to it, by their names in `to_xml_string()`.

        No two names end in the same file name, because MuJoCo looks up files in memory by their file name alone.
        Raises `MjcfError` for files that cannot be read.

        >>> from mjcompose import mjcf
        >>> model = mjcf.RootElement('table')
        >>> wood = model.asset.add('texture', name='wood', type='2d', file=mjcf.Asset(b'...', '.png', 'wood'))
        >>> model.assets
        {'assets/table/wood.png': b'...'}
        """
        return assets(self._model)
