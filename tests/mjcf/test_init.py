from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from mjcompose import mjcf


def test_importing_it_imports_nothing_heavy(repository: Path) -> None:
    code = (
        "import sys; from mjcompose import mjcf; m = mjcf.RootElement(); m.worldbody.add('geom', size=[1]); "
        "m.to_xml_string(); print([n for n in ('mujoco', 'pydantic', 'yaml', 'click') if n in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=repository)
    assert run.stdout.strip() == "[]"


def test_everything_that_is_offered_is_there() -> None:
    assert mjcf.PREFIX_SEPARATOR == "/"
    assert all(hasattr(mjcf, name) for name in mjcf.__all__)
