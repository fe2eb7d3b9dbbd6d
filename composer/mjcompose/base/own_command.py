"""The script that runs `mjcompose` in another process: `python -I own_command.py MODULE_PATH WORD…`.

`MODULE_PATH` is the module path of the parent as JSON, so nothing is imported from the current folder, and everything
from where the parent has it.
"""

import json
import runpy
import sys

if __name__ == "__main__":
    sys.path[:] = json.loads(sys.argv[1])
    sys.argv[:] = ["mjcompose", *sys.argv[2:]]
    runpy.run_module("mjcompose", run_name="__main__")
