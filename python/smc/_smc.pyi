from collections.abc import Callable
from typing import Any

__version__: str

class Model:
    title: str
    agents: list[str]
    warnings: str
    def __init__(
        self,
        name: str,
        text: str,
        settings: list[tuple[str, str]],
        files: dict[str, bytes],
        folder: str | None,
        data: list[str],
        runs_in: str | None,
    ) -> None: ...
    def check(
        self,
        properties: list[tuple[str, str]],
        settings: dict[str, Any],
        progress: Callable[[str, int, int | None], None] | None,
    ) -> Report: ...
    def play(self, seed: int, indices: list[int]) -> str: ...
    def trials(self, seed: int, indices: list[int], threads: int | None) -> list[dict[str, Any]]: ...

class Report:
    def json(self) -> str: ...
    def text(self) -> str: ...
    def warnings(self) -> str: ...
    def is_satisfied(self) -> bool: ...
    def page(self) -> str: ...

def command(words: list[str]) -> int: ...
