"""How often people change their acceleration: pieces of constant acceleration per 10 m of recorded walks.

Reads `mocap/takes.csv` and the takes that it names in the folder `$SMC_DATA` (unless set, `../shared/data`). Needs numpy. The speed is that of
the hip, averaged over a stride. A piece goes on as long as a straight line in u = v^2 over the distance meets the speed
within a tolerance.
"""
import csv
import os
import sys

import numpy as np

DATA = os.path.join(os.environ.get("SMC_DATA", "../shared/data"), "mocap")
TAKES = os.path.join(DATA, "takes.csv")
# Lengths of CMU takes in ASF/AMC, m.
UNIT = 2.54 / 100 / 0.45

if not os.path.exists(TAKES):
    sys.exit(f"skipped: {TAKES} is not there")


def clips(path, known={}):
    if path not in known:
        found = {}
        for row in csv.DictReader(open(path)):
            found.setdefault(row["clip"], []).append((float(row["hip_z"]), float(row["hip_x"])))
        known[path] = {name: np.array(places) for name, places in found.items()}
    return known[path]


def hip(take):
    """The places of the hip on the floor, m; none of formats that are not read here."""
    path = os.path.join(DATA, take["file"])
    if path.endswith(".csv"):
        return clips(path).get(take["clip"])
    if path.endswith(".amc"):
        rows = [line.split()[1:4] for line in open(path) if line.startswith("root ")]
        return np.array([(float(z) * UNIT, float(x) * UNIT) for x, _, z in rows])
    return None


def mean(values, count):
    return np.convolve(values, np.ones(count) / count, mode="valid")


def pieces(x, u, v, tolerance, ahead):
    count, start = 0, 0
    while start < len(x) - 1:
        last = start + 1
        for end in range(start + 1, len(x)):
            if x[end] - x[start] <= 1e-9:
                continue
            line = u[start] + (u[end] - u[start]) * (x[start : end + 1] - x[start]) / (x[end] - x[start])
            if np.max(np.abs(np.sqrt(np.maximum(line, 0)) - v[start : end + 1])) <= tolerance:
                last = end
            elif end - last > ahead:
                break
        count, start = count + 1, last
    return count


tolerances = [0.03, 0.05, 0.1]
found = {tolerance: [] for tolerance in tolerances}
for take in csv.DictReader(open(TAKES)):
    places, fps = hip(take), float(take["fps"])
    if places is None or len(places) < 3 * fps or float(take["cadence_per_min"] or 0) <= 0:
        continue
    stride = int(round(120 / float(take["cadence_per_min"]) * fps))
    path = np.stack([mean(places[:, 0], stride), mean(places[:, 1], stride)], axis=1)
    if len(path) < fps:
        continue
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    x = np.concatenate([[0], np.cumsum(steps)])
    if x[-1] < 3:
        continue
    v = mean(steps * fps, max(3, int(0.2 * fps)))
    for tolerance in tolerances:
        found[tolerance].append(10 * pieces(x[: len(v)], v * v, v, tolerance, int(fps)) / x[-1])
for tolerance, counts in found.items():
    low, middle, high = np.percentile(counts, [10, 50, 90])
    print(f"within {tolerance} m/s: {middle:.1f} pieces per 10 m (80 % of {len(counts)} takes: {low:.1f} to {high:.1f})")
