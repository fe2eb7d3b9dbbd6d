"""Another package is imported as `composer`, in the same environments. Each works, whichever was installed first."""

from __future__ import annotations

import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
OTHER = "mosaicml"


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("wheels")
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder)]
    for name in (OTHER, str(ROOT)):
        if subprocess.run([*pip, name], capture_output=True, check=False).returncode:
            pytest.skip(f"no wheel of {name} can be had")
    ours, theirs = (next(folder.glob(f"{name}-*.whl")) for name in ("mjcompose", OTHER))
    return {"ours": ours, "theirs": theirs}


@pytest.mark.slow
@pytest.mark.parametrize("order", [("ours", "theirs"), ("theirs", "ours")], ids=" then ".join)
def test_both_can_be_installed(wheels: dict[str, Path], order: tuple[str, str], tmp_path: Path) -> None:
    venv.create(tmp_path / "env", with_pip=True)
    python = str(tmp_path / "env" / ("Scripts" if sys.platform == "win32" else "bin") / "python")

    def run(*words: str) -> str:
        return subprocess.run([python, *words], capture_output=True, text=True, check=True).stdout

    for name in order:
        run("-m", "pip", "install", "--quiet", "--no-deps", str(wheels[name]))
    # pip compares each file with the hash that its wheel recorded only when it is asked to; a file of both would be in two records.
    files = "from importlib.metadata import files; print(*sorted({path.parts[0] for path in files(%r)}))"
    theirs, ours = (set(run("-c", files % name).split()) for name in (OTHER, "mjcompose"))
    assert "composer" in theirs and "mjcompose" in ours
    assert theirs & ours <= {".."}  # scripts, beside the packages
    run("-m", "pip", "uninstall", "--quiet", "--yes", OTHER)
    assert run("-c", "import mjcompose; print(mjcompose.__version__)").strip()
