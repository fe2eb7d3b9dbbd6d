from __future__ import annotations

import errno
import os

import pytest

from composer.bundle.output_error import unwritable
from composer.diagnostics.codes import CODES


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS, errno.ENAMETOOLONG])
def test_a_refusal_of_the_system_says_what_to_do(number: int) -> None:
    error = unwritable("out", OSError(number, os.strerror(number)))
    assert error.code == ("output-full" if number == errno.ENOSPC else "output-unwritable")
    assert error.code in CODES
    assert error.message == f"cannot write `out`: {os.strerror(number).lower()}"
    assert error.help


def test_an_error_without_a_number_is_told_by_its_text() -> None:
    assert unwritable("out", OSError("Odd")).message == "cannot write `out`: odd"
    assert unwritable("out", OSError()).message == "cannot write `out`: oserror"
