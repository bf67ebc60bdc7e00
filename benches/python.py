"""What the wheel costs beside the program: `python3 benches/python.py pairs|driver|stop|arrays` where `smc` is installed."""

import os
import resource
import signal
import statistics
import subprocess
import sys
import threading
import time

import smc

MODEL, PROPERTIES = "models/corridor.scn", "properties/corridor.bltl"


def spent(work) -> tuple[float, float]:
    """Processor time and time of some work, s."""
    before, started = os.times(), time.perf_counter()
    work()
    after = os.times()
    user = sum(getattr(after, name) - getattr(before, name) for name in ("user", "system", "children_user", "children_system"))
    return user, time.perf_counter() - started


def told(name: str, list_of_pairs: list[tuple[float, float]]) -> None:
    cpu, wall = zip(*list_of_pairs)
    print(f"{name}: {statistics.median(cpu):.3f} s of the processor, {statistics.median(wall):.3f} s (medians of {len(cpu)})")


def turns(count: int, **works) -> None:
    """Measures several works in turn, and the ratio of each to the first, pair by pair."""
    found = {name: [] for name in works}
    for k in range(count):
        for name, work in sorted(works.items(), reverse=k % 2 == 1):
            found[name].append(spent(lambda: work(k)))
    base, *others = works
    for name, measured in found.items():
        told(name, measured)
    for name in others:
        for column, what in enumerate(("processor", "time")):
            ratios = [one[column] / first[column] for one, first in zip(found[name], found[base])]
            medians = [statistics.median(one[column] for one in found[key]) for key in (name, base)]
            print(f"{name} / {base}, {what}: {medians[0] / medians[1]:.4f} of medians, {statistics.median(ratios):.4f} median ratio")


def pairs(program: str) -> None:
    """`check` of the corridor from Python and by the program: the same work on one thread."""
    words = ["--only", "3", "--max-trials", "2000", "-j", "1", "-q"]

    def command(seed: int) -> None:
        subprocess.run([program, "check", MODEL, PROPERTIES, "--seed", str(seed), *words], capture_output=True)

    model = smc.Model(MODEL)
    turns(15, command=command, python=lambda seed: str(model.check(PROPERTIES, seed=seed, only="3", max_trials=2000, threads=1)))


def driver() -> None:
    """A check in which a function drives the user, who is asked once a leg and goes as without it, and one without."""
    model, asked = smc.Model(MODEL), []

    def mine(situation):
        asked.append(situation.occasion)
        return "straight"

    text = "estimate P(G<=10 s (contact(user) => F<=1 s !contact(user))) by okamoto(epsilon = 0.02, delta = 0.05)"
    turns(15, without=lambda seed: model.check(text=text, seed=seed, threads=1), driven=lambda seed: model.check(text=text, seed=seed, threads=1, driver={"user": mine}))
    print({occasion: asked.count(occasion) for occasion in set(asked)})


def stop() -> None:
    """From an interruption to the report."""
    model, found = smc.Model(MODEL), []
    for k in range(20):
        sent = []

        def interrupt():
            time.sleep(1 + 0.037 * k)
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt).start()
        report = model.check(PROPERTIES, seed=k, evidence=k % 2 == 1)
        found.append(time.perf_counter() - sent[0])
        assert report.interrupted
    print(f"stop: median {1e3 * statistics.median(found):.0f} ms, longest {1e3 * max(found):.0f} ms")


def arrays() -> None:
    """10^6 agent-states as arrays, with the simulation."""
    model, found = smc.Model(MODEL), []
    for k in range(9):
        started = time.perf_counter()
        trials = model.trials(range(37 * k, 37 * (k + 1)))
        found.append(time.perf_counter() - started)
    states = sum(trial.present.size for trial in trials)
    print(f"{states} agent-states: {1e3 * statistics.median(found):.0f} ms with the simulation")


if __name__ == "__main__":
    what, *more = sys.argv[1:]
    {"pairs": pairs, "driver": driver, "stop": stop, "arrays": arrays}[what](*more)
