"""How straight people walk: recorded straight takes beside walks of a learned gait on open floor.

    python3 benches/straight.py [PROGRAM [FOLDER]]

Reads the straight takes of Bandai-Namco in the folder `$SMC_DATA` (unless set, `../shared/data`), and lets PROGRAM (unless set,
target/release/smc) simulate walks of 12 m. With FOLDER it writes 30 walks of each there, turned so that they go along x, as
tables for `smc gait compare`. Needs numpy.
"""
import csv
import glob
import io
import os
import subprocess
import sys

import numpy as np

DATA = os.path.join(os.environ.get("SMC_DATA", "../shared/data"), "mocap")
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "target/release/smc"
FOLDER = sys.argv[2] if len(sys.argv) > 2 else None
RATE = 30
SCENE = """horizon = 30 s
step = 1 s / 60
scene {{ point goal: ({length}, 0); region around: rect (-2, -3) .. (14, 3) }}
kind w: stepped {{ radius = 0.25 m; gait = learned "cmu.gait" }}
agent a: w {{ at = (0, 0); route = goal }}
"""


def recorded():
    takes = os.path.join(DATA, "takes.csv")
    if not os.path.exists(takes):
        sys.exit(f"skipped: {takes} is not there")
    straight = {(row["file"], row["clip"]) for row in csv.DictReader(open(takes)) if row["kind"] == "straight"}
    for path in sorted(glob.glob(os.path.join(DATA, "bandai-namco-2/*.csv"))):
        clips = {}
        for row in csv.DictReader(open(path)):
            clips.setdefault(row["clip"], []).append((float(row["hip_x"]), -float(row["hip_z"])))
        for clip, places in clips.items():
            if ("bandai-namco-2/" + os.path.basename(path), clip) in straight:
                yield np.array(places)


def simulated(length, count):
    words = [PROGRAM, "walk", "-", "-n", str(count), "--data", "gaits", "--fps", str(RATE), "--format", "traces"]
    done = subprocess.run(words, input=SCENE.format(length=length), capture_output=True, text=True, check=True)
    walks = {}
    for row in csv.DictReader(io.StringIO(done.stdout)):
        walks.setdefault(row["walk"], []).append((float(row["x"]), float(row["y"])))
    return [np.array(walk) for walk in walks.values()]


def turned(walk):
    """The walk from the origin along x."""
    way = walk[-1] - walk[0]
    along = way / np.hypot(*way)
    return np.c_[(walk - walk[0]) @ along, (walk - walk[0]) @ np.array([-along[1], along[0]])]


def smooth(walk):
    """Averaged over a second, about a stride."""
    mean = np.ones(RATE + 1) / (RATE + 1)
    return np.c_[np.convolve(walk[:, 0], mean, "valid"), np.convolve(walk[:, 1], mean, "valid")]


def told(name, walks):
    worst, headings, widths = [], [], []
    for walk in walks:
        path = turned(smooth(walk))
        worst.append(np.abs(path[:, 1]).max())
        stride = path[RATE:] - path[:-RATE]
        headings += list(np.degrees(np.arctan2(stride[:, 1], stride[:, 0])))
        widths.append(turned(walk)[:, 1].max() - turned(walk)[:, 1].min())
    print(
        f"{name}: {len(walks)} walks; smoothed path off its chord at most {np.median(worst):.3f} m (median), "
        f"{np.percentile(worst, 90):.3f} m (90 %); direction of strides {np.std(headings):.1f} degrees; "
        f"hip within {np.median(widths):.3f} m across"
    )


def write(path, walks):
    with open(path, "w") as out:
        out.write("walk,t,x,y\n")
        for k, walk in enumerate(walks):
            for n, (x, y) in enumerate(turned(walk)):
                out.write(f"{k},{n / RATE:.4f},{x:.4f},{y:.4f}\n")


takes = list(recorded())
told("recorded", takes)
told("simulated", simulated(8.5, 200))
if FOLDER:
    write(os.path.join(FOLDER, "recorded.csv"), takes[:: max(1, len(takes) // 30)][:30])
    write(os.path.join(FOLDER, "simulated.csv"), simulated(8.5, 30))
