"""Errors of scenarios, property files and calls."""

import ctypes
from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One error of a text."""

    code: str
    """Stable code, such as `E0303`; `smc explain E0303` explains it."""
    file: str | None
    line: int
    """From 1; 0 without a place."""
    column: int
    message: str
    hint: str | None

    @property
    def place(self) -> str | None:
        """`corridor.scn:3:7`, or None where the error belongs to no place."""
        return None if self.file is None else f"{self.file}:{self.line}:{self.column}"


class Diagnostics(ValueError):
    """Errors of texts. The message is what the program prints, with the lines that are marked."""

    def __init__(self, text: str, found: list[tuple] = ()):
        super().__init__(text)
        self.errors = [Finding(*one) for one in found]
        """All of them, each a `Finding`."""

    @property
    def code(self) -> str | None:
        """The code of the first one."""
        return self.errors[0].code if self.errors else None

    @property
    def place(self) -> str | None:
        """The place of the first one."""
        return self.errors[0].place if self.errors else None

    @property
    def hint(self) -> str | None:
        """The hint of the first one."""
        return self.errors[0].hint if self.errors else None

    def __reduce__(self):
        found = [(one.code, one.file, one.line, one.column, one.message, one.hint) for one in self.errors]
        return (Diagnostics, (str(self), found))


def raise_in(threads: list[int], error: type[BaseException]) -> None:
    """Raises an exception in threads that do not come to an end; a call of C is ended when it comes back."""
    for thread in threads:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(error))
