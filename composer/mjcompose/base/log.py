"""What a program sees of the package's work: the logger `mjcompose`, and warnings at the program's own line.

A program that wants the messages sets up `logging` as for any other package:

    logging.getLogger("mjcompose").setLevel(logging.DEBUG)

`logging` is not imported for it: a program that has not imported it has no handler either.
"""

from __future__ import annotations

import sys
import warnings

from mjcompose.base.diagnostic import caller


def log(message: str, *arguments: object, level: int = 20) -> None:
    """Log a message under `mjcompose`. The default level is that of `logging.INFO`; 10 is `logging.DEBUG`.

    >>> import logging
    >>> handler = logging.StreamHandler(sys.stdout)
    >>> logger = logging.getLogger("mjcompose")
    >>> logger.addHandler(handler)
    >>> log("built %s", "cell", level=logging.WARNING)
    built cell
    >>> logger.removeHandler(handler)
    """
    logging = sys.modules.get("logging")
    if logging is not None:
        logging.getLogger("mjcompose").log(level, message, *arguments)


def warn(message: str, category: type[Warning]) -> None:
    """Warn at the innermost line of the call stack outside of this package, as Python's own warnings do."""
    frame = caller()
    module = str(frame.f_globals.get("__name__", "<unknown>"))
    registry = frame.f_globals.setdefault("__warningregistry__", {})
    warnings.warn_explicit(
        message, category, frame.f_code.co_filename, frame.f_lineno, module=module, registry=registry
    )
