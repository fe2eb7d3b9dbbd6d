"""Convert models to MuJoCo's own `MjSpec`."""

from __future__ import annotations

from typing import Any

from composer.link.request import Policy
from composer.mjcf.flat import contents, flatten, issue_warnings, name_files
from composer.mjcf.model import Model
from composer.mjcf.physics.compile import engine, refused
from composer.tree.write import to_text, write


def to_spec(model: Model, conflict: Policy) -> Any:
    """Return the composition as a `mujoco.MjSpec`. See `RootElement.to_spec`."""
    mujoco = engine()
    flat = flatten(model, conflict)
    name_files(flat)
    files = contents(flat)
    try:
        # MuJoCo reads sub-models at once, and looks for them among what is included.
        models = {name: data for name, data in files.items() if name.endswith(".xml")}
        spec = mujoco.MjSpec.from_string(to_text(flat.unit.root), include=models, assets=files)
    except (ValueError, mujoco.FatalError) as error:
        raise refused(error, write(flat.unit.root), flat) from None
    issue_warnings(flat)
    return spec
