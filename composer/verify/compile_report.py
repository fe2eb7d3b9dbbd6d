"""Report MuJoCo's verdict on a bundle at the places of the recipe and its sources."""

from __future__ import annotations

from pathlib import Path
from posixpath import basename
from typing import TYPE_CHECKING

from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError
from composer.context import Context
from composer.diagnostics.diagnostic import Cause
from composer.diagnostics.span import Span
from composer.grammar import GRAMMAR
from composer.grammar.version import version_key
from composer.mujoco_errors.message import Fault, crash_help
from composer.mujoco_errors.report import report
from composer.mujoco_errors.sentence import read_sentence
from composer.mujoco_errors.translation import translate, unknown_attribute, unknown_element
from composer.tree.files import NAMED_AFTER_FILE
from composer.tree.ignored import ignored, is_unread_alone, unread
from composer.tree.line import element_at
from composer.tree.unit import Unit
from composer.verify.compiles import verify
from composer.verify.unmoved_flexes import unmoved_flexes

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.engine import Compiled, Session


def judge(
    bundle: Bundle,
    model: Unit,
    context: Context,
    *,
    session: Session,
    keep: str | None = None,
    at: Span | None = None,
) -> Compiled | None:
    """Compile the bundle and report errors and warnings to the sink. Return None if MuJoCo gave no verdict.

    With `keep` the session keeps the compiled model under that name. `at` is the place of messages that are
    about no element, as a rule the recipe.
    """
    try:
        verified = verify(bundle, session=session, keep=keep)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    for warning in verified.warnings:
        element = _element(warning, bundle, model)
        attribute = None if element is None else translate(warning.message, element).attribute
        span = None if element is None else model.origins.span(element, model.file, attribute)
        said = _with_sources(warning.message, model, context)
        context.sink.warning(
            "mujoco-warning", f"MuJoCo warns: {said}", span, cause=Cause(said, _called(element))
        )
    if verified.error is not None and verified.code is not None:
        fault = verified.error
        message = _with_sources(fault.message, model, context)
        if verified.crash:
            context.sink.error(verified.code, message, at, help=crash_help(verified.code))
        else:
            element = _element(fault, bundle, model)
            report(translate(message, element), element, model, context=context, at=at)
        return None
    version = verified.compiled.mujoco_version
    if version is None or version_key(version) <= version_key(
        GRAMMAR.versions[-1]
    ):  # a newer one may have more attributes
        for element, name in unread(model.root, version):
            _report_unread(element, name, model, context=context)
    for flex in unmoved_flexes(model.root, version):
        context.sink.warning(
            "not-supported",
            f"MuJoCo {version} leaves the flex `{flex.get('name')}` where it would be without the frame around it",
            model.origins.span(flex, model.file),
            help="build with MuJoCo 4.0, which moves it, or put it into a body",
            cause=Cause("left behind", _called(flex)),
        )
    return verified.compiled


def _called(element: Node | None) -> str:
    if element is None:
        return "the model"
    name = element.get("name")
    return f"`<{element.tag}>` `{name}`" if name else f"`<{element.tag}>`"


def _report_unread(element: Node, name: str | None, model: Unit, context: Context) -> None:
    """Warn if MuJoCo ignores it in the source too; else report an error, because MuJoCo refuses the source alone."""
    if is_unread_alone(element, name, model):
        context.sink.add(ignored(element, name, model))
        return
    file = model.origins.span(element, model.file).file
    found = unknown_element(element, file) if name is None else unknown_attribute(element, name, file)
    report(
        found, element, model, context=context, cause=Cause(f"{element.tag} {name or ''}", _called(element))
    )


def _element(fault: Fault, bundle: Bundle, model: Unit) -> Node | None:
    """Return the element that a message is about.

    It is the one on the given line of `model.xml`, a plugin instance, the only element of that name, or a
    setting.
    """
    if fault.line is not None:
        found = element_at(model.root, bundle.files[bundle.model], fault.line)
        return _attaching(fault, model.root) if _is_another(found, fault) else found
    said = read_sentence(fault.message)
    if said.plugin is not None:
        instances = model.root.findall("extension/plugin/instance")  # the first ones; others have no name
        return instances[said.plugin] if said.plugin < len(instances) else None
    named = [each for each in model.root.iter("*") if each.get("name") == fault.name] if fault.name else []
    named = named or [each for each in model.root.iterfind(".//replicate//*") if _is_copy(fault.name, each)]
    named = named or [
        each
        for each in model.root.iter("*")
        if each.get("file") and basename(str(each.get("file"))) in said.names
    ]
    if not named and said.array is not None:
        named = list(model.root.iter(said.array.partition("_")[0]))
    if not named and said.section is not None:
        named = model.root.findall(said.section)
    return named[0] if len(named) == 1 else None


def _is_copy(name: str | None, element: Node) -> bool:
    """Return whether MuJoCo gives this name to a copy of the element."""
    own = element.get("name")
    return bool(name and own and name.startswith(own) and name.removeprefix(own)[-1:].isdigit())


def _is_another(found: Node | None, fault: Fault) -> bool:
    """Return whether the message is about an element of another name, so that its line belongs to another file."""
    if found is None or not fault.name:
        return False
    if found.get("name"):
        return not fault.name.startswith(str(found.get("name")))
    around = [str(each.get("name")) for each in found.iterancestors() if each.get("name")]
    if any(map(fault.name.startswith, around)) or found.tag in NAMED_AFTER_FILE:
        return False
    return _attaching(fault, found.getroottree().getroot()) is not None


def _attaching(fault: Fault, root: Node) -> Node | None:
    """Return the `<attach>` that brings in the element of the message, judged by its prefix."""
    prefixes = {each: str(each.get("prefix") or "") for each in root.iter("attach")}
    fitting = [each for each, prefix in prefixes.items() if str(fault.name).startswith(prefix)]
    return max(fitting, key=lambda each: len(prefixes[each]), default=None)


def _with_sources(message: str, model: Unit, context: Context) -> str:
    """Return the message on one line, with the file names that the user knows."""
    for path, where in model.contents.items():
        if path in message:
            message = message.replace(path, context.shown(where) if isinstance(where, Path) else path)
    return " ".join(" ".join(dict.fromkeys(message.splitlines())).split()).removesuffix(".")
