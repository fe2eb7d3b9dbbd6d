"""Show whole models in notebooks: the tree, with a picture beside it if OpenGL is available."""

from __future__ import annotations

import base64
import warnings
from html import escape

from composer.mjcf.errors import MjcfError, MjcfWarning
from composer.mjcf.html import page
from composer.mjcf.model import Model
from composer.mjcf.physics.physics import Physics
from composer.mjcf.views import view
from composer.pictures.png import png
from composer.tree.kinds import WORLD_SECTION

_SIZE = 240, 320


def page_with_picture(model: Model) -> str:
    """Return HTML of a model's tree, with a picture if OpenGL is available and the model compiles."""
    tree, image = page(model, model.unit.root), picture(model)
    if image is None:
        return tree
    data = base64.b64encode(image).decode()
    return (
        '<div style="display: flex; gap: 1em; align-items: flex-start">'
        f'<img alt="{escape(model.name)}" src="data:image/png;base64,{data}"/>{tree}</div>'
    )


def picture(model: Model) -> bytes | None:
    """Return the whole composition in its reference configuration as a PNG, or None if it cannot be rendered."""
    top = model.top
    if not len(top.section(WORLD_SECTION)):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MjcfWarning)
        try:
            physics = Physics.from_mjcf_model(view(top, top.unit.root), conflict="warning")
            return png(physics.render(*_SIZE))
        except MjcfError:
            return None
