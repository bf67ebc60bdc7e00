"""Episodes in which Python drives an agent."""

import math
import time

import numpy
import pytest
import smc

ALONE = """
horizon = 8 s
step = 0.05 s
kind adult: sfm preset helbing2000
agent robot: adult { at = (0, 0) }
"""

HALL = """
horizon = 6 s
step = 0.05 s
kind adult: sfm preset smc2 { noise = 0.1 m/s }
agent robot: adult { at = (0, 0); route = (20, 0) }
agents people[19]: adult { at = uniform in rect (3, -4) .. (12, 4); route = (-5, 0) }
"""


def test_the_velocity_follows_the_action():
    env = smc.Env(smc.Model.parse(ALONE), "robot")
    env.reset(seed=1)
    for _ in range(60):
        seen, reward, terminated, truncated, info = env.step((0.6, 0.8))
    assert numpy.allclose(seen[0, 2:4], (0.6, 0.8), atol=0.01) and not seen[1:].any()
    assert (reward, terminated, truncated) == (0.0, False, False) and info["time"] == pytest.approx(3)
    for _ in range(60):
        seen, *_ = env.step((0, 0))
    assert numpy.hypot(*seen[0, 2:4]) < 0.05
    while not truncated:
        _, _, terminated, truncated, info = env.step((0, 0))
        assert not terminated
    assert info["time"] == pytest.approx(8)


def test_a_query_gives_the_reward_once():
    env = smc.Env(smc.Model.parse(ALONE), "robot", reward="check P(F<=5 s (x(position(robot)) > 2 m)) >= 0.9")

    def play(velocity):
        env.reset(seed=1)
        rewards, terminated = [], False
        while not terminated:
            seen, reward, terminated, truncated, info = env.step(velocity)
            assert not truncated
            rewards.append(reward)
        return rewards, seen, info

    rewards, seen, info = play((1, 0))
    assert rewards[-1] == 1 and sum(rewards) == 1 and seen[0, 0] > 2 and info["time"] < 3.5
    rewards, seen, info = play((0, 1))
    assert sum(rewards) == 0 and info["worth"] == 0 and info["time"] == pytest.approx(5)


def test_a_robustness_is_a_reward():
    query = "estimate E(robustness(G<=2 s (x(position(robot)) < 3 m))) in -9 m .. 9 m"
    env = smc.Env(smc.Model.parse(ALONE), "robot", reward=query)
    env.reset(seed=1)
    terminated = False
    while not terminated:
        seen, reward, terminated, _, _ = env.step((1, 0))
    assert reward == pytest.approx(3 - seen[0, 0], abs=1e-9)


def test_episodes_are_the_trials_of_a_seed():
    model = smc.Model.parse(HALL)
    env = smc.Env(model, "robot", neighbours=19)
    first, info = env.reset(seed=3)
    assert info == {"time": 0.0, "trial": 0, "seed": 3} and first.shape == (20, 5)
    _, info = env.reset()
    assert info["trial"] == 1
    trial = model.trial(0, seed=3)
    distances = numpy.hypot(*(trial.positions[0, 1:] - trial.positions[0, 0]).T)
    assert numpy.allclose(numpy.hypot(first[1:, 0], first[1:, 1]), numpy.sort(distances))

    def path():
        env.reset(seed=3)
        return numpy.array([env.step((1.0, 0.2 * math.sin(k)))[0] for k in range(50)])

    assert numpy.array_equal(path(), path())


def test_gymnasium_finds_nothing_wrong():
    checker = pytest.importorskip("gymnasium.utils.env_checker")
    env = smc.Env(smc.Model.parse(HALL), "robot", reward="check P(G<=6 s (clearance(robot) > 0 m)) >= 0.5")
    checker.check_env(env, skip_render_check=True)


def test_wrong_calls_are_exceptions():
    model = smc.Model.parse(ALONE)
    with pytest.raises(smc.Diagnostics, match="there is no agent `robo`"):
        smc.Env(model, "robo")
    with pytest.raises(smc.Diagnostics, match="unknown name"):
        smc.Env(model, "robot", reward="check P(nobody) >= 0.5")
    with pytest.raises(smc.Diagnostics, match="asks nothing of a trial|no query"):
        smc.Env(model, "robot", reward="property p = true")
    with pytest.raises(ValueError, match="an action is a `velocity`"):
        smc.Env(model, "robot", action="jump")
    env = smc.Env(model, "robot")
    with pytest.raises(RuntimeError, match="call `reset`"):
        env.step((0, 0))
    env.reset(seed=1)
    with pytest.raises(ValueError, match="must be finite"):
        env.step((math.nan, 0))


def test_steps_are_fast_enough_to_learn_from():
    """No bound, so that a slow machine fails nothing: what it prints goes into BENCHMARKS.md."""
    env = smc.Env(smc.Model.parse(HALL), "robot")
    env.reset(seed=1)
    started = time.perf_counter()
    for _ in range(110):
        env.step((1, 0))
    print(f"{110 / (time.perf_counter() - started):.0f} steps/s with 20 agents")
