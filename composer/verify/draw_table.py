"""The table of all draws of a model, as a bundle with worlds has it: the fields, their addresses and their values."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Iterator, Sequence
from typing import Any

from composer import engine
from composer.bundle.bundle import DRAWS, MODEL, Bundle
from composer.bundle.rows import write_rows
from composer.context import Context
from composer.document.node import locate
from composer.expr.angle import UNITS, Angle
from composer.grammar.degrees import is_in_degrees
from composer.mujoco_errors.message import CRASHES, crash_help
from composer.plan.drawn import ElementDraws
from composer.plan.plan import Plan
from composer.recipe.distribution import CHOICE
from composer.recipe.draw_field import DrawField
from composer.verify.compiles import WHOLE
from composer.verify.run_time import resolve

SAMPLES = "samples.csv"
SAMPLE = "sample"
"""The name under which a session keeps the sample that a table is compared with."""
CODE = "draw-at-run-time"
_FORMAT = 1


class DrawTable:
    """The table of draws for the model that `session` keeps. Draws that are impossible at run time are reported."""

    def __init__(
        self, plan: Plan, tabled: Sequence[ElementDraws], session: engine.Session, context: Context
    ) -> None:
        self.plan, self.tabled, self.session, self.context = plan, tabled, session, context
        self.columns: dict[str, dict[str, Any]] = {}
        self.values: dict[str, Sequence[Any]] = {}

    def fill(self) -> bool:
        """Look up the address of every number, and return whether each has one."""
        before = self.context.sink.error_count
        numeric = [each for each in self.tabled if self._is_numeric(each)]
        answer = engine.call(self.session, resolve, [WHOLE], argument=[_question(each) for each in numeric])
        if not answer.ok:
            self.crashed(answer)
            return False
        for each, found in zip(numeric, answer.value, strict=True):
            if "error" in found:
                message = f"field `{each.field.name}` cannot be drawn at run time: {found['error']}"
                self._fault(
                    each.field,
                    message,
                    "or draw the `mass` of its body" if each.first.attribute == "density" else "",
                )
            else:
                self._add(each, found)
        return self.context.sink.error_count == before

    def added(self, bundle: Bundle) -> Bundle:
        """Return the bundle with the table in it."""
        wanted = self.plan.randomize
        assert wanted is not None
        data = {
            "randomize": _FORMAT,
            "model": MODEL,
            "samples_file": SAMPLES,
            "seed": wanted.seed,
            "samples": wanted.samples,
            "mujoco": self.session.mujoco_version,
            "fields": {each.name: _field(each) for each in wanted.fields},
            "columns": [{"column": name, **column} for name, column in self.columns.items()],
        }
        table = io.BytesIO()
        with io.TextIOWrapper(table, "utf-8", newline="", write_through=True) as text:
            write_rows(text, ["sample", *self.columns], self._rows(wanted.samples))
            samples = table.getvalue()
        described = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
        return bundle.with_files({DRAWS: described.encode(), SAMPLES: samples})

    def _rows(self, samples: int) -> Iterator[Sequence[Any]]:
        yield [0, *[None] * len(self.columns)]
        yield from zip(range(1, samples + 1), *self.values.values(), strict=True)

    def _is_numeric(self, each: ElementDraws) -> bool:
        first = each.first.value if isinstance(each.first.value, tuple) else (each.first.value,)
        if not any(isinstance(value, str) for value in first):
            return True
        message = f"field `{each.field.name}` draws names, which a model that is compiled cannot change"
        self._fault(each.field, message)
        return False

    def _add(self, each: ElementDraws, found: dict[str, Any]) -> None:
        for component, (name, _) in enumerate(each.first.columns()):
            if name not in self.columns:
                low, high = _bounds(each, component)
                self.columns[name] = {
                    "field": each.field.name,
                    "operation": each.field.operation,
                    "low": low,
                    "high": high,
                    "targets": [],
                }
                self.values[name] = each.numbers[component]
            of = {"type": each.family, "name": each.name or "", "id": found["id"]}
            self.columns[name]["targets"] += [{**of, **target} for target in found["targets"][component]]

    def _fault(self, field: DrawField, message: str, instead: str = "") -> None:
        help = "write `emit: models`, which builds every sample" + (f", {instead}" if instead else "")
        self.context.sink.error(CODE, message, locate(self.plan.document, (*field.at, "attr")), help=help)

    def crashed(self, answer: engine.Called) -> None:
        code = CRASHES.get(answer.crash or "", "mujoco-crash")
        span = locate(self.plan.document, ("randomize", "samples"))
        message = f"the table of draws: {answer.error or answer.crash}"
        self.context.sink.error(code, message, span, help=crash_help(code))


def _question(each: ElementDraws) -> dict[str, Any]:
    return {
        "tag": each.tag,
        "family": each.family,
        "name": each.name,
        "place": each.place,
        "attribute": each.first.attribute,
        "start": each.first.start,
        "count": len(each.first.columns()),
    }


def _bounds(each: ElementDraws, component: int) -> tuple[float | None, float | None]:
    """Return the least and the greatest number that may be drawn, in the table's unit; None for no bound."""
    distribution = each.field.distribution
    if distribution.kind == CHOICE:
        numbers = distribution.extremes(component) or tuple(map(float, each.numbers[component]))  # type: ignore[arg-type]
    else:
        numbers = distribution.extremes(component)
    unit = distribution.unit
    if unit is None and each.unit == "degree" and each.angles[component : component + 1] == (True,):
        unit = "deg"
    own = "deg" if is_in_degrees(each.tag, each.first.attribute) else "rad"
    turned = [Angle(end, UNITS[unit]).in_unit(own) if unit else end for end in (min(numbers), max(numbers))]
    low, high = (number if math.isfinite(number) else None for number in turned)
    return low, high


def _field(field: DrawField) -> dict[str, Any]:
    """Return what the recipe says about a field, with the numbers as written."""
    distribution = field.distribution
    return {
        "select": str(field.select),
        "attribute": field.attr,
        "operation": field.operation,
        "per": field.per,
        "distribution": distribution.kind,
        "parameters": {
            name: list(each) if len(each) > 1 else each[0] for name, each in distribution.parameters.items()
        },
        "unit": distribution.unit,
    }
