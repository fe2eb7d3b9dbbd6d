"""The page of a fit: one HTML file without programs, which asks nothing of a network."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from statistics import median
from typing import Any

from mjcompose.base import __version__
from mjcompose.base.report import printable
from mjcompose.base.words import counted
from mjcompose.tools.identify.file import rounded
from mjcompose.tools.identify.judgment import FitFinding, findings_of
from mjcompose.tools.identify.words import error_words, half_interval, number_words, verdict_words

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; form-action 'none'; base-uri 'none'"
_WIDTH = 2000
_HEIGHT = 400
_MOST_IN_MATRIX = 60
_STRONG = 0.8
_MODELS = ("recipe", "fitted")
_TOO_FAR = 3.0
"""How many times its recorded span a signal is drawn: a model that falls over would hide the recording."""

Number = Mapping[str, Any]


def page_of(name: str, recipe: str, data: Mapping[str, Any], curves: Sequence[Mapping[str, Any]]) -> str:
    """Return the page of a fit: its verdict, the curves, the numbers, their correlations, and the errors."""
    parts = [
        *_head(name, recipe, data),
        *_verdict(data),
        *_motion(data, curves),
        *_numbers(data["numbers"], data["correlation"]),
        *_correlation(data["numbers"], data["correlation"]),
        *_errors(data["errors"]),
        *_recordings(data),
    ]
    return "\n".join(parts) + "\n</html>\n"


def _head(name: str, recipe: str, data: Mapping[str, Any]) -> Iterator[str]:
    style = Path(__file__).with_name("page.css").read_text(encoding="utf-8")
    yield "<!doctype html>\n<html lang=en>\n<meta charset=utf-8>"
    yield '<meta name=viewport content="width=device-width,initial-scale=1">'
    yield f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
    yield f"<link rel=icon href=data:,>\n<title>{_text(name)}: measured numbers</title>\n<style>\n{style}</style>"
    yield f"<h1>{_text(name)}</h1>"
    files = ", ".join(f"<code>{_text(each['file'])}</code>" for each in data["recordings"])
    about = f"Numbers of <code>{_text(recipe)}</code>, fitted to {files} by mjcompose {_text(__version__)}"
    yield f"<p class=soft>{about}</p>"


# ------------------------------------------------------------------------------------------------------------- verdict


def _verdict(data: Mapping[str, Any]) -> Iterator[str]:
    findings = list(findings_of(data["errors"]))
    severities = {finding.severity for finding in findings}
    severity = "error" if "error" in severities else "warning" if severities else "good"
    words = {
        "error": "Do not use these numbers yet.",
        "warning": "Use these numbers with care.",
        "good": "The fitted model follows the robot.",
    }
    yield f'<div class="verdict {severity}">'
    yield f"<p><strong>{words[severity]}</strong></p>"
    yield from map(_finding, findings)
    yield from (f"<p>{sentence}</p>" for sentence in _facts(data))
    yield "</div>"
    links = (("motion", "Motion"), ("numbers", "Numbers"), ("correlation", "Correlation"), ("errors", "Errors"))
    yield "<nav>" + "".join(f"<a href=#{place}>{word}</a>" for place, word in links) + "</nav>"


def _finding(finding: FitFinding) -> str:
    mark = "bad" if finding.severity == "error" else "warn"
    word = f"<b class={mark}>{finding.severity}[{finding.code}]</b>"
    return f"<p>{word}: {_text(finding.message)}. <span class=soft>{_text(finding.help)}.</span></p>"


def _facts(data: Mapping[str, Any]) -> Iterator[str]:
    numbers = data["numbers"]
    measured = [number for number in numbers if not number["verdict"]]
    yield f"{len(measured)} of {counted(len(numbers), 'number')} {'is' if len(measured) == 1 else 'are'} measured."
    for word in dict.fromkeys(number["verdict"] for number in numbers if number["verdict"]):
        places = [_link(index) for index, number in enumerate(numbers) if number["verdict"] == word]
        yield f"{_text(verdict_words(word)).capitalize()}: {', '.join(places)}."
    held = [error["held_out"] for error in data["errors"] if error["held_out"]]
    for about, errors in (("the recordings", data["errors"]), ("what was held out", held)):
        ratios = [error["recipe"] / error["fitted"] for error in errors if error["fitted"]]
        if ratios:
            yield f"The errors for {about} are {_times(median(ratios))} (median of {counted(len(ratios), 'signal')})."
    if not held:
        yield "There is no held-out recording, so nothing says how the model follows another motion."


def _times(ratio: float) -> str:
    if 0.95 < ratio < 1.05:
        return "as large as with the recipe"
    return f"{ratio:.2g} times smaller than with the recipe" if ratio > 1 else f"{1 / ratio:.2g} times larger"


# -------------------------------------------------------------------------------------------------------------- motion


def _motion(data: Mapping[str, Any], curves: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    yield "<h2 id=motion>Motion</h2>"
    yield (
        "<p class=key><span>recording</span><span class=recipe>model of the recipe</span>"
        "<span class=fitted>fitted model</span></p>"
    )
    again = "" if data["window"] is None else f", every {data['window']:.3g} s again"
    yield f"<p class=soft>Each model begins at the start that fits it best{again}. Below each curve you see the model"
    yield "minus the recording. Long recordings are thinned, and keep their largest errors.</p>"
    errors = {error["signal"]: error for error in data["errors"]}
    for signal in dict.fromkeys(curve["signal"] for curve in curves):
        yield f"<h3>{_text(signal)}</h3>"
        if signal in errors:
            yield f"<p class=soft>{error_words(errors[signal])}</p>"
        yield "<div class=runs>"
        for curve in curves:
            if curve["signal"] == signal:
                yield from _figure(curve)
        yield "</div>"


def _figure(curve: Mapping[str, Any]) -> Iterator[str]:
    parts = curve["parts"]
    unit = curve["unit"]
    used = "held out" if curve["used"] == "held out" else "fitted"
    yield f"<figure><figcaption><b>{used}</b>: {_text(curve['file'])}</figcaption>"
    yield from _plot(parts, ("recorded", *_MODELS), _span_of_signal(parts), unit, curve["seconds"], "")
    differences = [_differences(part) for part in parts]
    yield from _plot(differences, _MODELS, _span_of_errors(parts, differences), unit, curve["seconds"], " errors")
    yield "</figure>"


def _differences(part: Mapping[str, Any]) -> dict[str, Any]:
    """Return the errors of a part: the models minus the recording."""
    recorded = part["recorded"]
    errors = {
        word: [None if value is None else value - truth for value, truth in zip(part[word], recorded, strict=True)]
        for word in _MODELS
    }
    return {"times": part["times"], **errors}


def _span_of_signal(parts: Sequence[Mapping[str, Any]]) -> tuple[float, float]:
    """Return the ends of the axis: all curves, but not a model that is far away from the recording."""
    recorded = [value for part in parts for value in part["recorded"]]
    low = min(recorded)
    high = max(recorded)
    far = _TOO_FAR * (high - low)
    near = [
        value
        for part in parts
        for word in _MODELS
        for value in part[word]
        if value is not None and low - far <= value <= high + far
    ]
    return _padded(min([low, *near]), max([high, *near]))


def _span_of_errors(
    parts: Sequence[Mapping[str, Any]], differences: Sequence[Mapping[str, Any]]
) -> tuple[float, float]:
    recorded = [value for part in parts for value in part["recorded"]]
    errors = {
        word: [abs(value) for part in differences for value in part[word] if value is not None] for word in _MODELS
    }
    most = max([*errors["recipe"], *errors["fitted"]], default=0.0)
    far = _TOO_FAR * (max(recorded) - min(recorded))
    return _padded(-min(most, far or most), min(most, far or most))


def _padded(low: float, high: float) -> tuple[float, float]:
    pad = 0.05 * (high - low) or 1e-9
    return low - pad, high + pad


def _plot(
    parts: Sequence[Mapping[str, Any]],
    words: Sequence[str],
    span: tuple[float, float],
    unit: str,
    seconds: float,
    kind: str,
) -> Iterator[str]:
    low, high = span
    begin = parts[0]["times"][0] if parts else 0.0
    across = _WIDTH / ((seconds - begin) or 1.0)
    up = _HEIGHT / (high - low)

    def place(time: float, value: float) -> tuple[int, int]:
        return round((time - begin) * across), round((high - value) * up)

    yield f"<div class=plot><div class=ends><span>{_short(high)} {unit}</span><span>{_short(low)}</span></div>"
    what = "errors" if kind else "curves"
    box = f'viewBox="0 0 {_WIDTH} {_HEIGHT}" preserveAspectRatio=none role=img'
    yield f'<svg class="curves{kind}" {box} aria-label="{what} of the models and the recording">'
    if low < 0 < high:
        zero = place(begin, 0.0)[1]
        yield f'<path class=zero d="M0 {zero}h{_WIDTH}"/>'
    for word in words:
        yield f'<path class={word} d="{"".join(_path(parts, word, place))}"/>'
    yield "</svg>"
    if kind:
        yield f"<div class=times><span>{begin:.3g} s</span><span>{seconds:.3g} s</span></div>"
    yield "</div>"


def _path(
    parts: Sequence[Mapping[str, Any]], word: str, place: Callable[[float, float], tuple[int, int]]
) -> Iterator[str]:
    """Yield a path in whole steps from point to point; a missing number interrupts it."""
    for part in parts:
        last = None
        for time, value in zip(part["times"], part[word], strict=True):
            if value is None:
                last = None
                continue
            x, y = place(time, max(-1e30, min(value, 1e30)))
            y = max(-_HEIGHT, min(y, 2 * _HEIGHT))
            yield f"M{x} {y}" if last is None else f"l{x - last[0]} {y - last[1]}"
            last = (x, y)


# ------------------------------------------------------------------------------------------------------------- numbers


def _numbers(numbers: Sequence[Number], correlation: Sequence[Sequence[float]]) -> Iterator[str]:
    yield "<h2 id=numbers>Numbers</h2>"
    yield "<table class=cards><caption>With their 95 % intervals, in MuJoCo's units. The bar is the range of the field;"
    yield "it has the interval in blue and the recipe's number as a mark.</caption>"
    heads = ("", "number", "value", "recipe", "range", "verdict")
    yield f"<thead><tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr></thead><tbody>"
    for index, number in enumerate(numbers):
        yield _row(index, number, _partners(index, numbers, correlation))
    yield "</tbody></table>"


def _row(index: int, number: Number, partners: str) -> str:
    width = half_interval(number)
    value = f"{rounded(number['value'], number['std']):g} <span class=soft>± {_short(width)}</span>"
    word = number["verdict"]
    verdict = f"<span class=warn>{_text(verdict_words(word))}</span>: {_text(number['reason'])}" if word else "measured"
    cells = (
        ("value", value),
        ("recipe", f"{rounded(number['recipe']):g}"),
        ("range", _range(number)),
        ("verdict", verdict + partners),
    )
    name = f"<th id=n{index + 1} class=number>{index + 1}</th><th>{_text(number_words(number))}</th>"
    return (
        f"<tr>{name}{''.join(f'<td class=number data-what={what}><div>{cell}</div></td>' for what, cell in cells)}</tr>"
    )


def _partners(index: int, numbers: Sequence[Number], correlation: Sequence[Sequence[float]]) -> str:
    """Return the numbers with which a number is confused."""
    row = correlation[index]
    strong = [other for other in range(len(numbers)) if other != index and abs(row[other]) > _STRONG]
    if not strong:
        return ""
    strong.sort(key=lambda other: -abs(row[other]))
    words = ", ".join(f"{_link(other)} ({round(100 * row[other]):+d} %)" for other in strong)
    return f"<br><span class=soft>confused with {words}</span>"


def _range(number: Number) -> str:
    """Return a bar: the range of a number, its interval, and the recipe's number."""
    low, high = number["range"]
    scale = 200 / ((high - low) or 1.0)
    width = half_interval(number)
    begin = max(0.0, (number["value"] - width - low) * scale)
    end = min(200.0, (number["value"] + width - low) * scale)
    begin = min(begin, 197.0)
    was = min(max((number["recipe"] - low) * scale, 1.5), 198.5)
    size = max(end - begin, 3.0)
    box = 'viewBox="0 0 200 16" preserveAspectRatio=none role=img'
    return (
        f'<svg class=range {box} aria-label="range from {low:g} to {high:g}"><rect y="6" width="200" height="4"/>'
        f'<rect class=interval x="{begin:.1f}" y="3" width="{size:.1f}" height="10"/>'
        f'<rect class=was x="{was - 1.5:.1f}" width="3" height="16"/></svg>'
        f"<span class=soft>{_short(low)} … {_short(high)}</span>"
    )


# --------------------------------------------------------------------------------------------------------- correlation


def _correlation(numbers: Sequence[Number], correlation: Sequence[Sequence[float]]) -> Iterator[str]:
    yield "<h2 id=correlation>Correlation</h2>"
    if len(numbers) < 2:
        yield "<p>There is only one number.</p>"
        return
    yield "<p class=soft>In percent. Two numbers with a large correlation are known together better than alone.</p>"
    if len(numbers) > _MOST_IN_MATRIX:
        yield f"<p>The file of measurements has the matrix of {len(numbers)} numbers.</p>"
        return
    heads = "".join(f"<th>{index + 1}</th>" for index in range(len(numbers) - 1))
    yield f"<div class=wide><table class=matrix><thead><tr><th></th>{heads}</tr></thead><tbody>"
    for index, row in enumerate(correlation):
        name = f"<th class=name>{index + 1} {_text(number_words(numbers[index]))}</th>"
        yield f"<tr>{name}{''.join(_cell(value) for value in row[:index])}</tr>"
    yield "</tbody></table></div>"


def _cell(value: float) -> str:
    percent = round(100 * value)
    color = "var(--accent)" if value > 0 else "var(--recipe)"
    share = min(40, round(40 * abs(value)))
    style = f' style="background:color-mix(in srgb,{color} {share}%,var(--card))"' if share else ""
    return f"<td{style}>{percent}</td>"


# -------------------------------------------------------------------------------------------------- errors, recordings


def _errors(errors: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    yield "<h2 id=errors>Errors before and after</h2>"
    yield "<table class=cards><caption>Root mean square of the model minus the recording, in rad, m, rad/s or m/s."
    yield "Errors that are noise are correlated over one sample.</caption>"
    heads = ("signal", "recipe", "fitted", "held out, recipe", "held out, fitted", "correlated")
    yield f"<thead><tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr></thead><tbody>"
    for error in errors:
        held = error["held_out"]
        cells = [f"{error[word]:.3g}" for word in _MODELS]
        cells += [f"{held[word]:.3g}" if held else "–" for word in _MODELS]
        cells.append(f"{error['correlated']:.3g}")
        pairs = zip(heads[1:], cells, strict=True)
        row = "".join(f'<td class=number data-what="{head}"><div>{cell}</div></td>' for head, cell in pairs)
        yield f"<tr><th>{_text(error['signal'])}</th>{row}</tr>"
    yield "</tbody></table>"


def _recordings(data: Mapping[str, Any]) -> Iterator[str]:
    yield "<h2 id=recordings>Recordings</h2>"
    yield "<table class=cards><thead><tr><th>file</th><th>used</th><th>length</th><th>sha256</th></tr></thead><tbody>"
    for used, key in (("fitted", "recordings"), ("held out", "held_out")):
        for each in data[key]:
            cells = (
                ("used", used),
                ("length", f"{each['seconds']:.3g} s, {each['samples']} samples"),
                ("sha256", f"<code>{_text(each['sha256'])}</code>"),
            )
            row = "".join(f"<td data-what={what}><div>{cell}</div></td>" for what, cell in cells)
            yield f"<tr><th>{_text(each['file'])}</th>{row}</tr>"
    yield "</tbody></table>"
    yield f"<p class=soft>{data['simulated_steps']} simulated steps.</p>"


# --------------------------------------------------------------------------------------------------------------- words


def _text(text: str) -> str:
    """Return text of a recording or a recipe as HTML that shows it, whatever it has."""
    return escape(printable(text))


def _link(index: int) -> str:
    return f"<a href=#n{index + 1}>{index + 1}</a>"


def _short(value: float) -> str:
    """Return a number with three digits.

    >>> _short(0.00012345), _short(-1234.5), _short(0.0)
    ('0.000123', '-1.23e+03', '0')
    """
    if not math.isfinite(value):
        return str(value)
    return f"{value:.3g}"
