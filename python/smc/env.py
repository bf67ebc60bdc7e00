"""Episodes in which a program of one's own drives an agent, as Gymnasium defines them."""

from __future__ import annotations

import numpy

try:
    import gymnasium
    from gymnasium.spaces import Box

    Base = gymnasium.Env
except ImportError:
    Box, Base = None, object


class Env(Base):
    """A trial in which `agent` is driven step by step.

    An action is the driving velocity of the agent, m/s: two numbers, at most `fastest` each. Forces act on it as on everybody,
    so its velocity follows within the relaxation time.

    An observation is a float64 array of the shape (1 + neighbours, 5). Its first row is the agent: x, y, vx, vy and radius. The
    others are those nearest to it, nearest first: their places and velocities from the agent's own, and their radii; rows of zeros
    where fewer are there.

    `reward` is a query. A reward is 0 until the query is decided, and then once what it came to: 1 or 0 of
    `check P(safe) >= 0.9`, the robustness of `estimate E(robustness(safe)) in -1 m .. 5 m`. Without a query all rewards are 0.

    An episode is terminated when the query is decided or the agent has left, and truncated at the horizon. `reset(seed=k)` begins
    trial 0 of seed k, and `reset()` the next trial of it: the same trials that a check reads.
    """

    metadata = {"render_modes": []}

    def __init__(self, model, agent: str, *, action: str = "velocity", reward: str | None = None, neighbours: int = 8, fastest: float = 2.0):
        if action != "velocity":
            raise ValueError(f"an action is a `velocity` (got `{action}`)")
        self._stage = model._inner.stage(agent, reward, neighbours)
        self._seed, self._index, self._paid = 0, -1, False
        self.dt = self._stage.dt
        """Length of a step, s."""
        if Box is not None:
            self.action_space = Box(-fastest, fastest, (2,), numpy.float64)
            self.observation_space = Box(-numpy.inf, numpy.inf, (1 + neighbours, 5), numpy.float64)

    def reset(self, *, seed: int | None = None, options: dict | None = None):
        """Begins a trial: the observation and the information about it."""
        if Base is not object:
            super().reset(seed=seed)
        if seed is None:
            self._index += 1
        else:
            self._seed, self._index = seed, 0
        seen, time, _, _, worth = self._stage.reset(self._seed, self._index)
        self._paid = worth is not None
        return seen, {"time": time, "trial": self._index, "seed": self._seed}

    def step(self, action):
        """One step with a driving velocity: observation, reward, terminated, truncated, information."""
        vx, vy = action
        seen, time, (is_here, is_over), ended, worth = self._stage.step(float(vx), float(vy))
        is_decided = worth is not None
        reward = worth if is_decided and not self._paid and worth == worth else 0.0
        self._paid = is_decided
        terminated = is_decided or not is_here or ended is not None
        info = {"time": time, "trial": self._index, "seed": self._seed, "ended": ended, "worth": worth}
        return seen, float(reward), terminated, is_over and not terminated, info
