from collections.abc import Callable
from typing import Any

import numpy

__version__: str

class Model:
    title: str
    levels: list[str]
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
    def driven(self, drivers: list[tuple[str | None, Callable[[Situation], Any]]]) -> Model: ...
    def failure(self) -> str | None: ...
    def stage(self, agent: str, query: str | None, neighbours: int) -> Stage: ...
    def play(self, seed: int, indices: list[int]) -> str: ...
    def trials(self, seed: int, indices: list[int], threads: int | None) -> list[dict[str, Any]]: ...

class Report:
    def json(self) -> str: ...
    def text(self) -> str: ...
    def warnings(self) -> str: ...
    def is_satisfied(self) -> bool: ...
    def page(self) -> str: ...

class Situation:
    occasion: str
    agent: str
    seed: int
    trial: int
    time: float
    dt: float
    position: tuple[float, float]
    velocity: tuple[float, float]
    goal: tuple[float, float] | None
    radius: float
    speed: float
    names: list[str]
    others: numpy.ndarray
    random: numpy.random.Generator
    memory: Any

class Stage:
    dt: float
    def reset(self, seed: int, index: int) -> tuple[Any, float, tuple[bool, bool], str | None, float | None]: ...
    def step(self, vx: float, vy: float) -> tuple[Any, float, tuple[bool, bool], str | None, float | None]: ...

def command(words: list[str]) -> int: ...
