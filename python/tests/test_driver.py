"""Drivers in Python: agents that ask a function where they go."""

import itertools
import json
import os
import signal
import threading
import time
import warnings

import numpy
import pytest
import smc
from test_checks import timeless

HALL = """
horizon = 12 s
step = 0.05 s
scene { wall middle: (4, -1) -- (4, 3) }
kind adult: sfm preset helbing2000 { noise = 0.1 m/s }
agent robot: adult { at = (0, 0); route = (2, 0) -> (8, 0) }
agent cart: adult { at = (0, -3); route = (8, -3) }
agents people[3]: adult { at = uniform in rect (6, -2) .. (9, 2); route = (-5, 0) }
"""
NEAR = "check P(F<=12 s (distance(robot, cart) < 1 m)) >= 0.5"
DECIDES = "estimate P(F<=6 s (y(position(robot)) > 0.8 m)) by okamoto(epsilon = 0.2, delta = 0.1)"


@pytest.fixture
def hall():
    return smc.Model.parse(HALL)


def around(situation):
    """Past the upper end of the wall."""
    return ("way", [(3, 4), (5, 4)]) if situation.goal == (8, 0) and situation.position[0] < 4 else "straight"


def test_a_driver_leads_its_agent_and_nobody_else(hall):
    trial, plain = hall.trial(2, seed=3, driver={"robot": around}), hall.trial(2, seed=3)
    robot, cart = trial.agent("robot"), trial.agent("cart")
    assert numpy.hypot(*(trial.positions[:, robot] - (4, 4)).T).min() < 0.7
    assert plain.positions[:, robot, 1].max() < 2
    assert numpy.allclose(trial.positions[0], plain.positions[0])
    # The way of the cart is what it was but for the forces between bodies, and people still go around the wall.
    assert numpy.allclose(trial.positions[-1, cart], plain.positions[-1, cart], atol=0.5)
    assert (trial.positions[-1, 2:, 0] < 4).all()


def test_a_driver_is_told_the_situation(hall):
    seen = []
    trial = hall.trial(1, seed=4, driver={"robot": lambda situation: seen.append(situation) or around(situation)})
    first = seen[0]
    assert (first.occasion, first.agent, first.seed, first.trial, first.time, first.dt) == ("begins", "robot", 4, 1, 0, 0.05)
    assert first.position == (0, 0) and first.goal == (2, 0) and first.radius == trial.radii[0, 0] and first.speed > 0
    assert first.names == ["cart", "people[1]", "people[2]", "people[3]"] and first.memory is None
    assert numpy.array_equal(first.others[:, :2], trial.positions[0, 1:])
    assert numpy.array_equal(first.others[:, 4], trial.radii[0, 1:])
    leg = next(one for one in seen if one.occasion == "leg")
    assert leg.goal == (8, 0) and leg.time > 0 and len(seen) < 40


def test_plans_are_followed(hall):
    def stands_and_goes(situation):
        if situation.occasion == "begins":
            return ("stand", 2)
        (x, y), speed = situation.position, 0.8
        return ("follow", numpy.array([[0, x, y, 0, 0], [2, x, y + 1.6, 0, speed], [4, x, y + 3.2, 0, 0]]))

    trial = hall.trial(driver={"robot": stands_and_goes})
    at = dict(zip(trial.times.round(3), trial.positions[:, 0]))
    assert numpy.allclose(at[2.0], (0, 0), atol=0.3) and numpy.allclose(at[4.0], (0, 1.6), atol=0.4)


def test_objects_drive_with_a_memory_and_agents_have_drivers_of_their_own(hall):
    class Counts:
        def plan(self, situation):
            situation.memory = (situation.memory or 0) + 1
            if situation.memory == 3:
                times.append(situation.time)
            return ("stand", 1.0)

    times = []
    trial = hall.trial(driver={"robot": Counts(), "cart": lambda _: ("way", [(2, -6)])})
    assert times == pytest.approx([2.0], abs=0.06) and numpy.allclose(trial.positions[-1, 0], (0, 0), atol=0.5)
    assert trial.positions[:, 1, 1].min() < -5
    everybody = hall.trial(driver=lambda _: ("stand", numpy.inf))
    assert numpy.abs(everybody.positions[-1] - everybody.positions[0]).max() < 1
    listed = hall.trial(driver={"people": lambda _: ("stand", numpy.inf)})
    assert listed.positions[-1, 0, 0] > 3 and numpy.abs(listed.positions[-1, 2:] - listed.positions[0, 2:]).max() < 1


def test_reports_have_the_same_bytes_at_any_number_of_threads(hall):
    def drawn(situation):
        return ("way", [(1, situation.random.uniform(-2, 2))])

    found = [hall.check(text=NEAR + "\n" + DECIDES, seed=7, threads=threads, driver={"robot": drawn}) for threads in (1, 2, 2)]
    assert len({timeless(report.json) for report in found}) == 1
    assert found[0][0].verdict and 0 < found[0][1].estimate < 1
    assert found[0][0].certificate and "given: the given drivers of robot" in str(found[0])
    assert "y(position(robot))" in found[0].page()


def test_random_numbers_belong_to_seed_trial_agent_and_question(hall):
    drawn = {}

    def draw(situation):
        key = (situation.seed, situation.trial, situation.agent, situation.time)
        drawn.setdefault(key, set()).add(tuple(situation.random.random(2)))
        return ("stand", 4)

    for threads in (1, 2):
        for seed in (1, 2):
            hall.trials(range(20), seed=seed, threads=threads, driver={"robot": draw, "cart": draw})
    assert len(drawn) >= 2 * 20 * 2 * 3 and all(len(values) == 1 for values in drawn.values())
    assert len({value for values in drawn.values() for value in values}) == len(drawn)


def test_a_driver_that_fails_leaves_its_trial_unresolved(hall):
    def fails(situation):
        if situation.trial % 3 == 1 and situation.occasion == "leg":
            raise ZeroDivisionError("no way out")
        return "straight"

    text = "estimate P(F<=12 s (x(position(robot)) > 7 m)) by okamoto(epsilon = 0.2, delta = 0.1)"
    with pytest.warns(RuntimeWarning, match="ZeroDivisionError: no way out") as caught:
        report = hall.check(text=text, driver={"robot": fails})
    result, said = report[0], str(caught[0].message)
    assert len(caught) == 1 and caught[0].filename == __file__
    assert said.startswith("the driver of `robot` failed in trial 1 at ") and "in fails" in said
    assert result.unresolved == len([k for k in range(result.trials) if k % 3 == 1])
    assert "the driver of `robot` failed at" in report.json
    with pytest.warns(RuntimeWarning):
        assert hall.trial(4, driver={"robot": fails}).ended == "the driver of `robot` failed"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert hall.trial(3, driver={"robot": fails}).ended is None


@pytest.mark.parametrize(
    "answer",
    [
        None,
        3,
        "jump",
        ("way", "home"),
        ("way", []),
        ("way", [(1, 2, 3)]),
        ("way", [(numpy.nan, 0)]),
        ("stand", -1),
        ("stand", numpy.nan),
        ("straight", 1),
        ("follow", [(0, 0, 0, 1, 0)]),
        ("follow", numpy.full((3, 5), numpy.nan)),
        ("follow", [(1, 0, 0, 1, 0), (2, 1, 0, 1, 0)]),
    ],
    ids=lambda answer: repr(answer)[:20],
)
def test_an_answer_that_is_no_plan_leaves_its_trial_unresolved(hall, answer):
    with pytest.warns(RuntimeWarning, match="ValueError: .*a driver answers `straight`"):
        trial = hall.trial(driver={"robot": lambda _: answer})
    assert len(trial.times) == 1 and trial.ended == "the driver of `robot` failed"


def test_a_driver_that_depends_on_other_trials_is_an_error(hall):
    count = itertools.count()
    report = hall.check(text=DECIDES, driver={"robot": lambda _: ("way", [(1, next(count) % 7 - 3)])})
    found = json.loads(report.json)["diagnostics"]
    assert [one["code"] for one in found] == ["E0915"] and "trial 0" in found[0]["message"]
    assert not report.satisfied and "the driver of `robot` gave another answer" in report.warnings


def test_drivers_are_asked_in_every_procedure(hall):
    model = smc.Model.parse(HALL + "moves cart for 2 s { stop; heading 30 deg }\n")
    report = model.check(text="rank moves of cart by P(F<=12 s (distance(robot, cart) < 2 m)) within 0.3", driver={"robot": around})
    assert {option["option"] for option in report[0].options} == {"own way", "stop", "heading 30 deg"}
    split = "estimate P(F<=12 s (y(position(robot)) > 3 m)) by splitting()"
    assert model.check(text=split, driver={"robot": around}, max_trials=200)[0].estimate > 0.9


def test_an_interruption_ends_a_check_with_a_driver(hall):
    asked = threading.Event()

    def interrupts(situation):
        if situation.trial > 200 and not asked.is_set():
            asked.set()
            os.kill(os.getpid(), signal.SIGINT)
        return "straight"

    report = hall.check(text="estimate P(F<=12 s contact(robot)) within 0.0005", driver={"robot": interrupts})
    assert report.interrupted and 0 < report[0].high - report[0].low < 1


def test_wrong_drivers_are_refused(hall):
    with pytest.raises(smc.Diagnostics, match="there is no agent `robo`"):
        hall.trial(driver={"robo": around})
    with pytest.raises(TypeError, match="a driver is a function"):
        hall.check(text=DECIDES, driver={"robot": 3})
    program = smc.Model("examples/programs/bottleneck.scn", allow_run=True)
    with pytest.raises(smc.Diagnostics, match="the program `jupedsim` moves everybody"):
        program.check(text="estimate P(F<=30 s out) within 0.1", driver={"people[1]": around})


def endless(situation):
    while situation.trial == 3:
        pass
    return "straight"


def test_an_endless_driver_is_ended_with_the_time(hall):
    with pytest.warns(RuntimeWarning, match="(?s)in trial 3 at 0 s.*TimeoutError"):
        report = hall.check(text=NEAR, driver={"robot": endless}, timeout=1)
    assert report[0].stopped_by == "deadline"


def test_an_endless_driver_is_ended_by_an_interruption(hall):
    def interrupts():
        while not reached.wait(0.01):
            pass
        time.sleep(0.1)
        os.kill(os.getpid(), signal.SIGINT)

    def hangs(situation):
        if situation.trial == 3:
            reached.set()
        return endless(situation)

    for work in (
        lambda: hall.check(text=NEAR, driver={"robot": hangs}),
        lambda: hall.trial(3, driver={"robot": hangs}),
        lambda: hall.trials(range(20), driver={"robot": hangs}),
    ):
        reached = threading.Event()
        helper = threading.Thread(target=interrupts)
        helper.start()
        begun = time.monotonic()
        try:
            assert work().interrupted
        except KeyboardInterrupt:
            pass
        helper.join()
        assert time.monotonic() - begun < 10


def test_a_scene_with_levels_is_not_driven():
    text = HALL.replace("scene { wall middle: (4, -1) -- (4, 3) }", "scene { level ground { region hall: rect (-9, -9) .. (9, 9) } }")
    with pytest.raises(smc.Diagnostics, match="drivers from outside know no levels"):
        smc.Model.parse(text).trial(driver={"robot": around})
