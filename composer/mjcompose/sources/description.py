"""The script that imports a description: `python -I description.py MODULE_PATH MODULE`.

The import clones a repository with git, which obeys the configuration of the repository around its current folder. So
it happens in a process of its own, which starts in an empty folder. It prints the paths of the description, or the
error, as JSON.
"""

import json
import sys
from contextlib import redirect_stdout
from importlib import import_module

NAMES = ("MJCF_PATH", "URDF_PATH", "REPOSITORY_PATH")


def main(path: list[str], module: str) -> None:
    sys.path[:] = path
    try:
        with redirect_stdout(sys.stderr):  # the package prints its progress
            description = import_module(module)
        paths = {name: getattr(description, name, None) for name in NAMES}
        answer = {name: None if value is None else str(value) for name, value in paths.items()}
    except Exception as error:  # of git, of the network or of a missing extra of the package
        answer = {"error": str(error) or repr(error)}
    print(json.dumps(answer))  # noqa: T201  the answer


if __name__ == "__main__":
    main(json.loads(sys.argv[1]), sys.argv[2])
