"""The page as one file that needs no network: the program, the model, and the licences of the program."""

from __future__ import annotations

import base64
import html
import json
import lzma
import zlib
from collections.abc import Mapping
from pathlib import Path

from composer.view.description import Description

BUILT = Path(__file__).with_name("built")
# Only content of the file: no requests at all.
_ALONE = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:;"
    " form-action 'none'; base-uri 'none'"
)
# MuJoCo's bindings create functions from text, and the browser loads the WebAssembly from the file itself.
_PLAYED = _ALONE.replace("'unsafe-inline';", "'unsafe-inline' 'unsafe-eval'; connect-src blob:;", 1)
_LINE = 4096


def alone(description: Description, *others: Description, played: Mapping[str, bytes] | None = None) -> str:
    """Return the page of a model, or of two models, where the second is the new state of the first.

    The two share blobs. With the files of a bundle in `played` the page also has MuJoCo's WebAssembly.
    """
    models = "".join(_embedded(number, each) for number, each in enumerate((description, *others)))
    policy = _ALONE if played is None else _PLAYED
    engine = "" if played is None else _engine(played)
    return shell(
        description.title, f'<meta http-equiv="Content-Security-Policy" content="{policy}">', models + engine
    )


def _engine(files: Mapping[str, bytes]) -> str:
    """Return MuJoCo for the page, and the model that it compiles there."""
    program = lzma.decompress((BUILT / "mujoco.wasm.xz").read_bytes())
    data = _packed("physics", b"null", [*files.items(), ("mujoco.wasm", program)])
    return f"{data}<script>{_in_script((BUILT / 'physics.js').read_text(encoding='utf-8'))}</script>\n"


def live(title: str) -> str:
    """Return the page of a server, which serves the program and the models separately."""
    style, script = "<link rel=stylesheet href=page.css>", "<script src=page.js></script>"
    return shell(title, "", "", style=style, script=script).replace(
        "<html lang=en>", "<html lang=en data-live>"
    )


def shell(title: str, head: str, body: str, style: str | None = None, script: str | None = None) -> str:
    """Return the page around a model; `style` and `script` replace the program's own, which is included otherwise."""
    notice = (BUILT / "NOTICE").read_text(encoding="utf-8")
    style = (
        style if style is not None else f"<style>{(BUILT / 'page.css').read_text(encoding='utf-8')}</style>"
    )
    script = script if script is not None else f"<script>{_in_script(_program())}</script>"
    return (
        "<!doctype html>\n<html lang=en>\n<meta charset=utf-8>\n"
        '<meta name=viewport content="width=device-width,initial-scale=1">\n'
        f"<link rel=icon href=data:,>\n{head}\n<title>{html.escape(title)}</title>\n"
        f"<!--\n{notice.replace('--', '- -')}-->\n"
        f"{style}\n<div id=page></div>\n{body}{script}\n</html>\n"
    )


def _program() -> str:
    return (BUILT / "page.js").read_text(encoding="utf-8")


def _in_script(text: str) -> str:
    """Escape text so that an HTML parser does not see the end of a script in it."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def _embedded(number: int, description: Description) -> str:
    """Return the compressed model: a line of JSON with the sizes of the blobs, the model, and the new blobs."""
    blobs = [(name, description.blobs[name]) for name in description.used if name in description.blobs]
    return _packed("model", description.text.encode(), blobs, more=f" data-number={number}")


def _packed(what: str, text: bytes, blobs: list[tuple[str, bytes]], more: str = "") -> str:
    """Return compressed bytes of the class `what` that the page unpacks."""
    head = json.dumps([len(text), [[name, len(content)] for name, content in blobs]], separators=(",", ":"))
    packed = zlib.compress(b"".join([head.encode(), b"\n", text, *(content for _, content in blobs)]), 9)
    data = base64.b64encode(packed).decode("ascii")
    lines = "\n".join(data[at : at + _LINE] for at in range(0, len(data), _LINE))
    return f'<script type="application/octet-stream" class={what}{more}>\n{lines}\n</script>\n'
