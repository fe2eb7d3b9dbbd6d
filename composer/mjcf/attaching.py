"""Attach models to models, detach them, and maintain the prefix between the two. Works on nodes, not on Elements."""

from __future__ import annotations

from collections.abc import Iterator

from lxml import etree
from lxml.etree import _Element as Node

from composer.diagnostics.call_site import call_site
from composer.diagnostics.diagnostic import Note
from composer.mjcf import edit
from composer.mjcf.bones import for_prefix, take
from composer.mjcf.errors import failure
from composer.mjcf.model import Attachment, Model, Target
from composer.mjcf.reference import describe, settle
from composer.mjcf.removal import release
from composer.tree.attributes import replace
from composer.tree.kinds import WORLD_SECTION, kind_of
from composer.tree.name_index import SEPARATOR
from composer.tree.renaming import Renaming

# Paths of the elements that a model can hang on.
HOSTS = ("site", "body", "frame", WORLD_SECTION)


def attach(model: Model, host: Node, child: Model) -> Node:
    """Attach `child` to a node and return the attachment frame. See `Element.attach`."""
    place = describe(model, host)
    if kind_of(host).path not in HOSTS or model.frame_above(host) is not None:
        raise failure(
            "attach-place",
            f"nothing can be attached to {place}",
            call_site(),
            help="attach to a site, a body, a frame or the worldbody",
        )
    if any(above.tag == "replicate" for above in host.iterancestors()):
        raise failure(
            "not-supported", f"{place} is inside a `<replicate>`, where nothing can be attached", call_site()
        )
    if child is model or child in model.ancestors():
        message = f"`{child.name}` cannot be attached to itself" if child is model else (
            f"`{child.name}` cannot be attached to {place}, which is part of it"
        )  # fmt: skip
        raise failure("attach-cycle", message, call_site())
    if child.hung is not None:
        there = child.hung
        raise failure(
            "attach-place",
            f"`{child.name}` is attached already, to {describe(there.parent, there.host)} of "
            f"`{there.parent.name}`",
            call_site(),
            notes=(Note("it was attached here", there.parent.span(there.frame)),),
            help="`detach()` it first, or attach a copy: `copy.deepcopy(model)`",
        )
    _check_prefix(model, child, child.name)
    frame = etree.Element("body")
    attachment = Attachment(model, child, host, frame)
    model.attachments[child.prefix] = attachment
    child.hung = attachment
    settle(model.top)
    model.unit.origins.own(frame, call_site())
    return frame


def detach(child: Model) -> None:
    """Detach a model from its parent. See `RootElement.detach`."""
    if child.hung is None:
        raise failure("attach-place", f"`{child.name}` is not attached to anything", call_site())
    release(child.hung.parent, child.prefix)


def set_model_name(model: Model, name: str | None) -> None:
    """Rename a model. If it is attached, update the references from the models above to the new prefix."""
    written = edit.check(model, kind_of(model.unit.root), {"model": name})
    attachment = model.hung
    old = model.prefix
    if attachment is not None:
        _check_prefix(attachment.parent, model, name or model.unit.label, itself=model)
    text = written.texts["model"]
    if attachment is not None:
        new = (text or model.unit.label) + SEPARATOR
        renaming = Renaming.of_prefix(attachment.parent, old, new)
        edit.check_lists(renaming)
        skins = for_prefix(attachment.parent, old, new) if new != old else []
    replace(model.unit.root, {"model": text})
    if attachment is None or model.prefix == old:
        return
    take(skins)
    parent = attachment.parent
    parent.attachments = {each.child.prefix: each for each in parent.attachments.values()}
    renaming.carry_out()


def _check_prefix(model: Model, child: Model, name: str, itself: Model | None = None) -> None:
    """Raise `MjcfError` if another child of `model` has the prefix `name/`, or if a name of the child would clash."""
    prefix = f"{name}/"
    taken = model.attachments.get(prefix)
    if taken is not None and taken.child is not itself:
        raise failure(
            "name-clash",
            f"a model called `{name}` is attached to `{model.name}` already",
            call_site(),
            notes=(Note("it was attached here", model.span(taken.frame)),),
            help="give one of the two another name first: `other.model = '…'`",
        )
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
                    found = None if between is None else Target(child.hung.parent, between)
                if found is not None:
                    raise failure(
                        "name-clash",
                        f"there is a {namespace} `{known}` in `{here.name}`, which would have two",
                        call_site(),
                        notes=(
                            Note("one is here", here.span(node)),
                            Note("the other is here", found.model.span(found.node)),
                        ),
                        help="give one of the two another name, or the model: `other.model = '…'`",
                    )
        full = here.prefix + full


def attachments_below(model: Model) -> Iterator[Attachment]:
    """Yield every attachment of a composition, each before the attachments of its child."""
    for attachment in model.attachments.values():
        yield attachment
        yield from attachments_below(attachment.child)
