"""Trials as arrays."""

from __future__ import annotations

import os
from pathlib import Path

from .page import framed


class Trial:
    """The states of a trial. The first axis of its arrays is the time, the second one the agent; who is not there is NaN."""

    def __init__(self, model, seed: int, found: dict):
        self._model = model
        self.names = model.agents
        """Names of the agents, the index of the second axis."""
        self.seed = seed
        self.index = found["index"]
        self.times = found["times"]
        """Times, s (steps where these have no length): float64, (states,)."""
        self.positions = found["positions"]
        """Centres of the bodies, m: float64, (states, agents, 2)."""
        self.velocities = found["velocities"]
        """Velocities, m/s: float64, (states, agents, 2)."""
        self.radii = found["radii"]
        """Radii of the bodies, m: float64, (states, agents)."""
        self.present = found["present"]
        """Who is in the scene: bool, (states, agents)."""
        self.levels = found.get("levels")
        """The level or stairs of each agent, an index of `level_names`, −1 of who is not there: int32, (states, agents). None where
        the scene has no levels. Positions are those of the level; on stairs x is the way from the foot."""
        self.level_names = model.levels
        """Names of the levels by height, and then of the stairs."""
        self.variables = found["variables"]
        """Variables of processes by name, each float64, (states,); a truth value is 0 or 1."""
        self.ended = found["ended"]
        """Why the trial ended before the horizon; None if it did not."""

    def agent(self, name: str) -> int:
        """The place of an agent on the second axis."""
        try:
            return self.names.index(name)
        except ValueError:
            raise KeyError(f"there is no agent `{name}`") from None

    def to_pandas(self):
        """A DataFrame with a row for each agent in each state in which it is there: `time`, `name`, `id`, `x`, `y`, `vx`, `vy`,
        `radius`, and `level` where the scene has levels."""
        import numpy
        import pandas

        state, agent = numpy.nonzero(self.present)
        columns = {
            "time": self.times[state],
            "frame": state,
            "name": numpy.asarray(self.names, dtype=object)[agent],
            "id": agent,
        }
        for k, (place, velocity) in enumerate((("x", "vx"), ("y", "vy"))):
            columns[place] = self.positions[state, agent, k]
            columns[velocity] = self.velocities[state, agent, k]
        columns["radius"] = self.radii[state, agent]
        if self.levels is not None:
            columns["level"] = numpy.asarray(self.level_names, dtype=object)[self.levels[state, agent]]
        return pandas.DataFrame(columns)

    def to_pedpy(self):
        """The trial as `pedpy.TrajectoryData`."""
        import pedpy

        rate = 1.0 / (self.times[1] - self.times[0])
        return pedpy.TrajectoryData(self.to_pandas()[["id", "frame", "x", "y"]], frame_rate=float(rate))

    def save(self, path: str | os.PathLike) -> None:
        """Writes a page with a player of the trial."""
        Path(path).write_text(self._model.play(self.seed, [self.index]), encoding="utf-8")

    def _repr_html_(self) -> str:
        return framed(self._model.play(self.seed, [self.index]), 'trial.save("trial.html")')

    def __repr__(self) -> str:
        states, agents = self.present.shape
        return f"<smc.Trial {self.index} of seed {self.seed}: {states} states, {agents} agents>"
