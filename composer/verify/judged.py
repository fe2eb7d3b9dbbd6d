"""What MuJoCo says about a bundle, told at the places of the recipe and its sources."""

from __future__ import annotations

from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError
from composer.context import Context
from composer.diagnostics.span import Span
from composer.engine import Compiled, Limits
from composer.tree.line import element_at
from composer.tree.unit import Unit
from composer.verify.compiles import Fault, verify


def judge(bundle: Bundle, model: Unit, context: Context, limits: Limits | None) -> Compiled | None:
    """Compile the bundle; faults and warnings go to the sink. None where MuJoCo gave no verdict."""
    try:
        verified = verify(bundle, limits=limits)
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
        return None
    for warning in verified.warnings:
        context.sink.warning(
            "mujoco-warning", f"MuJoCo warns: {warning.message}", _place(warning, bundle, model)
        )
    if verified.error is not None and verified.code is not None:
        fault = verified.error
        said = fault.message if verified.crash else f"MuJoCo rejects the model: {fault.message}"
        context.sink.error(verified.code, said, _place(fault, bundle, model))
        return None
    return verified.compiled


def _place(fault: Fault, bundle: Bundle, model: Unit) -> Span | None:
    """Where the element of that line of `model.xml` came from."""
    if fault.line is None:
        return None
    element = element_at(model.root, bundle.files[bundle.model], fault.line)
    return None if element is None else model.origins.span(element, model.file)
