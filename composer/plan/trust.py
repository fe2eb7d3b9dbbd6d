"""The section `trust`: what the outer recipe lets models and fetched recipes reach on this machine.

It is read first, because it decides what may be read; so it allows no expressions and no conditions.
"""

from __future__ import annotations

import os
from pathlib import Path

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.unknown import unknown_key
from composer.document.node import Mapping, Node, Scalar, Sequence, to_python
from composer.expr.opening import is_template
from composer.recipe.shown import kind_of
from composer.sources.origin import Origin
from composer.sources.trust import Trust

TRUST = "trust"
FILES, REFERENCES = "files", "references"
KEYS = (FILES, REFERENCES)


def read_trust(node: Mapping, folder: Path, sink: Sink) -> Trust:
    """Return the section of a recipe in `folder`; faulty entries go to the sink and allow nothing."""
    written = node.entries[TRUST][1]
    if not isinstance(written, Mapping):
        message = f"`{TRUST}` expects a mapping, got {kind_of(to_python(written))}"
        sink.error("wrong-type", message, written.span, help=f"write `{TRUST}: {{{FILES}: [FOLDER]}}`")
        return Trust()
    for name, (key, _) in written.entries.items():
        if name not in KEYS:
            sink.add(unknown_key(name, KEYS, key.span, message=f"`{TRUST}` has no key `{name}`"))
    files = [_folder(text, span, folder, sink=sink) for text, span in _texts(written, FILES, sink)]
    references = tuple(
        text for text, span in _texts(written, REFERENCES, sink) if _is_narrow(text, span, sink)
    )
    return Trust(tuple(each for each in files if each is not None), references)


def refuse_trust(node: Mapping, origin: Origin, sink: Sink) -> None:
    """Report the section in a recipe from elsewhere, which cannot grant trust to itself."""
    sink.error(
        "source-outside",
        f"`{TRUST}` in a recipe of `{origin.id}` counts for nothing: only your own recipe says what it trusts",
        node.entries[TRUST][0].span,
        help=f"write in your own recipe what you trust; this `{TRUST}` has to go",
    )


def _texts(written: Mapping, name: str, sink: Sink) -> list[tuple[str, Span]]:
    if name not in written.entries:
        return []
    value = written.entries[name][1]
    items: tuple[Node, ...] = value.items if isinstance(value, Sequence) else ()
    found = []
    if not isinstance(value, Sequence):
        message = f"`{TRUST}.{name}` expects a list, got {kind_of(to_python(value))}"
        sink.error("wrong-type", message, value.span, help=f"write `{name}: [{_example(value)}]`")
    for item in items:
        if isinstance(item, Scalar) and item.value == "":
            sink.error("wrong-type", f"an entry of `{TRUST}.{name}` is empty", item.span, help="take it out")
        elif not isinstance(item, Scalar) or not isinstance(item.value, str):
            message = f"`{TRUST}.{name}` expects texts, got {kind_of(to_python(item))}"
            sink.error("wrong-type", message, item.span)
        elif is_template(item.value):
            message = f"`{TRUST}` is read before any parameter is known"
            sink.error("expression", message, item.span, help="write the text itself")
        else:
            found.append((item.value, item.span))
    return found


def _example(value: Node) -> str:
    return value.text if isinstance(value, Scalar) and value.text else "…"


def _folder(text: str, span: Span, folder: Path, sink: Sink) -> Path | None:
    path = folder / text
    if not os.path.isdir(path):
        hint = "`~` is not expanded: write the whole path" if text.startswith("~") else None
        sink.error(
            "file-not-found", f"the folder `{text}` of `{TRUST}.{FILES}` does not exist", span, help=hint
        )
        return None
    return Path(os.path.realpath(path))


def _is_narrow(text: str, span: Span, sink: Sink) -> bool:
    """Return whether a reference names something specific, and not a whole kind of server."""
    if text.strip("/:+@#").lower() not in ("", "http", "https", "git+https", "git+ssh"):
        return True
    message = f"`{text}` in `{TRUST}.{REFERENCES}` would allow everything"
    sink.error(
        "source-outside", message, span, help="name what is trusted: `git+file:///srv/robots`, `package:NAME`"
    )
    return False
