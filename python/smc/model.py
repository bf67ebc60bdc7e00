"""Models: scenarios that were understood."""

from __future__ import annotations

import contextlib
import os
import warnings
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from . import _smc
from .errors import Diagnostics
from .progress import bar
from .report import Report
from .tracks import csv_of
from .trial import Trial


Driver = Callable[[_smc.Situation], str | tuple]
"""Answers a situation with a plan. An object with a method `plan` is one as well."""


class Model:
    """A scenario that was understood.

    `path` is a scenario file. Recordings and plans that it names are looked for beside it and in the folders of `data`.
    A program that it names runs only with `allow_run=True`.

    Raises `smc.Diagnostics` with all errors of the text.
    """

    def __init__(self, path: str | os.PathLike, *, data: Iterable[str | os.PathLike] = (), allow_run: bool = False):
        name = os.fspath(path)
        folder = str(Path(name).parent)
        data = [os.fspath(one) for one in data]
        self._made_of(name, _text(name), {}, {}, folder, data, folder if allow_run else None)

    @classmethod
    def parse(
        cls,
        text: str,
        *,
        name: str = "model.scn",
        files: Mapping[str, bytes] | None = None,
        tracks: Mapping[str, object] | None = None,
        data: Iterable[str | os.PathLike] = (),
        allow_run: str | os.PathLike | None = None,
    ) -> Model:
        """The model of a text. `files` holds the bytes of files that it names, by their paths, and `tracks` DataFrames of its
        recordings, by their names (see `with_tracks`); others are looked for in the folders of `data`. A program that it names
        runs in the folder `allow_run`, if there is one."""
        model = cls.__new__(cls)
        runs_in = None if allow_run is None else os.fspath(allow_run)
        seen = {_path_of_tracks(text, track): csv_of(frame) for track, frame in (tracks or {}).items()}
        model._made_of(name, text, {}, {**(files or {}), **seen}, None, [os.fspath(one) for one in data], runs_in)
        return model

    def _made_of(self, name, text, settings, files, folder, data, runs_in):
        self._parts = (name, text, settings, files, folder, data, runs_in)
        pairs = [(key, _written(value)) for key, value in settings.items()]
        self._inner = _smc.Model(name, text, pairs, files, folder, data, runs_in)

    def _changed(self, settings=None, files=None) -> Model:
        name, text, known, held, *rest = self._parts
        model = type(self).__new__(type(self))
        model._made_of(name, text, {**known, **(settings or {})}, {**held, **(files or {})}, *rest)
        return model

    def with_(self, **parameters: float | str) -> Model:
        """The same model with other values of parameters: `model.with_(density=0.8, lane="2 m")`. A number takes the unit of
        the declared default; a text is written as in a scenario, also a sweep: `density="0.1..0.8 by 0.1"`."""
        return self._changed(settings=parameters)

    def with_tracks(self, name: str, frame) -> Model:
        """The same model with a DataFrame as the recording of the declaration `tracks name = csv "…"`.

        Columns: `id` (whole), `t` or `time` in s, or `frame` where the declaration has a rate, `x` and `y` in m, and any
        others that the format `csv` of recordings knows. Raises ValueError with the row of a missing or infinite value."""
        path = _path_of_tracks(self._parts[1], name)
        return self._changed(files={path: csv_of(frame)})

    @property
    def title(self) -> str:
        """The title of the scenario; empty without one."""
        return self._inner.title

    @property
    def agents(self) -> list[str]:
        """Names of the agents: the index of the second axis of the arrays of a trial."""
        return self._inner.agents

    @property
    def levels(self) -> list[str]:
        """Names of the levels by height, and then of the stairs; empty where the scene has none."""
        return self._inner.levels

    @property
    def warnings(self) -> str:
        """Warnings about the scenario, as the program prints them."""
        return self._inner.warnings

    def check(
        self,
        *properties: str | os.PathLike,
        text: str | None = None,
        seed: int = 0,
        max_trials: int | None = None,
        timeout: float | None = None,
        threads: int | None = None,
        only: str | Iterable[str] = (),
        evidence: bool = False,
        progress: bool | Callable[[str, int, int | None], None] = False,
        driver: Driver | Mapping[str, Driver] | None = None,
    ) -> Report:
        """Answers the queries of property files, and of a `text` such as `"estimate P(F<=10 s (user in exit))"`.

        `max_trials` bounds the trials of a query (a million by default), `timeout` the time of the call in s. `threads` never
        change a result. `only` asks queries of these properties or numbers. With `evidence` results say how their evidence grew.
        `progress` shows a bar, or is called with the query, its trials so far and those that are expected (or None).
        `driver` drives all agents, or `{"robot": mine}` those of a name or a list: a function that answers a `smc.Situation`
        with `"straight"`, `"keep"`, `("way", points)`, `("follow", rows of t, x, y, vx, vy)` or `("stand", seconds)`.

        An interruption (Ctrl-C, or the stop button of a notebook) ends sampling: the report then has what was found so far,
        and `interrupted` is true. Raises `smc.Diagnostics` with all errors of the texts."""
        files = [(os.fspath(one), _text(os.fspath(one))) for one in properties]
        if text is not None:
            files.append(("text.bltl", text))
        if not files:
            raise TypeError("name a property file, or write `text=\"check P(…) >= 0.9\"`")
        for option, value, least in (("threads", threads, 1), ("max_trials", max_trials, 1), ("timeout", timeout, 0)):
            if value is not None and not value >= least:
                raise ValueError(f"`{option}` must be at least {least} (got {value})")
        settings = {
            "seed": seed,
            "threads": threads,
            "max_trials": max_trials,
            "timeout": timeout,
            "only": [only] if isinstance(only, str) else [str(one) for one in only],
            "evidence": evidence,
        }
        shown = bar() if progress is True else contextlib.nullcontext(progress or None)
        with self._driven(driver) as inner, shown as told:
            return Report(inner.check(files, settings, told))

    @contextlib.contextmanager
    def _driven(self, driver):
        """The inner model with drivers; a failure of one becomes a warning."""
        if driver is None:
            yield self._inner
            return
        drivers = driver.items() if isinstance(driver, Mapping) else [(None, driver)]
        functions = [(name, getattr(one, "plan", one)) for name, one in drivers]
        for name, function in functions:
            if not callable(function):
                raise TypeError(f"a driver is a function of a situation, or has a method `plan` (got {function!r})")
        inner = self._inner.driven(functions)
        yield inner
        failure = inner.failure()
        if failure is not None:
            warnings.warn(failure, RuntimeWarning, stacklevel=4)

    def trial(self, index: int = 0, *, seed: int = 0, driver: Driver | Mapping[str, Driver] | None = None) -> Trial:
        """The trial of an index: the same that a check with this seed and these drivers reads."""
        return self.trials([index], seed=seed, driver=driver)[0]

    def play(self, indices: Iterable[int] = (0,), *, seed: int = 0) -> str:
        """Some trials as a page with a player."""
        return self._inner.play(seed, list(indices))

    def trials(
        self,
        indices: Iterable[int],
        *,
        seed: int = 0,
        threads: int | None = None,
        driver: Driver | Mapping[str, Driver] | None = None,
    ) -> list[Trial]:
        """Several trials, run in parallel."""
        indices = list(indices)
        if any(index >= 1 << 48 for index in indices):
            raise ValueError(f"trials are numbered from 0 to {(1 << 48) - 1}")
        with self._driven(driver) as inner:
            return [Trial(inner, seed, one) for one in inner.trials(seed, indices, threads)]

    def __repr__(self) -> str:
        name, _, settings, *_ = self._parts
        parameters = "".join(f", {key}={value!r}" for key, value in settings.items())
        return f"smc.Model({name!r}{parameters})"

    def __reduce__(self):
        return (_again, (type(self), self._parts))


def _again(cls, parts):
    model = cls.__new__(cls)
    model._made_of(*parts)
    return model


def _text(name: str) -> str:
    try:
        return Path(name).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        text = f"{name} is not UTF-8: byte {error.start}"
        raise Diagnostics(f"error[E0107]: {text}", [("E0107", name, 0, 0, text, "save the file as UTF-8")]) from None


def _written(value) -> str:
    """A value as a scenario has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)):
        return ",".join(_written(one) for one in value)
    return repr(float(value)) if not float(value).is_integer() else str(int(value))


def _path_of_tracks(text: str, name: str) -> str:
    """The path of the declaration `tracks name = csv "path"`."""
    import re

    found = re.search(rf'^\s*tracks\s+{re.escape(name)}\s*=\s*(\w+)\s+"([^"]*)"', text, re.MULTILINE)
    if found is None:
        raise ValueError(f"the scenario has no recording `{name}`: write `tracks {name} = csv \"{name}.csv\"`")
    if found[1] != "csv":
        raise ValueError(f"the recording `{name}` is `{found[1]}`; a DataFrame takes the place of `csv`")
    return found[2]
