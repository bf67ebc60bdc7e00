"""The second table of docs/people.md: presets in scenes, widths and seeds to which they were not fitted. Its pictures too.

    SMC=target/release/smc python3 docs/beyond.py smc1 smc2

Exits: a crowd of 110 to 150 in a corridor of 1.8 m before an exit, as in the HERMES runs uo-180-180; the specific flow is
that between 15 % and 85 % of the crowd. Streams: a corridor that is closed to a ring of 20 m, from 8 s on (from 20 s where
two streams meet). The order of lanes is the mean square of the difference of both shares in strips of 0.4 m. Turning is how fast
those before an exit of 0.7 m change their direction, who walk faster than 0.2 m/s: 99 of 100 values, a tenth of a second apart,
are less. Companions are two with an attraction of 150 N who walk 5 m to 15 m; abreast they are where the way between them points
more aside than ahead.
"""

import collections
import csv
import io
import math
import os
import statistics
import subprocess
import sys
import tempfile

SMC = os.path.abspath(os.environ.get("SMC", "smc"))
KIND = "kind adult: preset {} {{ noise = 0.05 m/s }}\n"
RING = """horizon = {horizon} s
step = 0.02 s
scene {{
  periodic x in 0 m .. 20 m
  wall (0, 0) -- (20, 0)
  wall (0, {width}) -- (20, {width})
  region field: rect (0, 0) .. (20, {width})
}}
"""


def rows(text, seed, every, trials=1):
    """Trial, time, name, x, y, vx and vy of everybody who is there."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "a.scn")
        with open(name, "w") as file:
            file.write(text)
        call = [SMC, "simulate", name, "-n", str(trials), "--seed", str(seed), "--every", str(every), "--format", "csv"]
        out = subprocess.run(call, capture_output=True, text=True, check=True).stdout
    for row in csv.DictReader(io.StringIO(out)):
        if row["present"] == "1":
            yield int(row["trial"]), float(row["time"]), row["agent"], *(float(row[key]) for key in ("x", "y", "vx", "vy"))


def exit_scene(preset, width, count):
    half = width / 2
    return f"""horizon = 110 s
step = 0.02 s
scene {{
  wall (-8, -3) -- (0, -3) -- (0, -0.9) -- (8, -0.9) -- (8, {-half}) -- (8.2, {-half}) -- (8.2, -3)
  wall (-8, 3) -- (0, 3) -- (0, 0.9) -- (8, 0.9) -- (8, {half}) -- (8.2, {half}) -- (8.2, 3)
  wall (-8, -3) -- (-8, 3)
  region start: rect (-7.7, -2.7) .. (-0.5, 2.7)
  region out: rect (11, -1.5) .. (13, 1.5)
}}
{KIND.format(preset)}agents p[{count}]: adult {{ at = uniform in start; route = out then leave }}
"""


def exit_flow(preset, width, count, seed):
    last, times = {}, []
    for _, time, name, x, *_ in rows(exit_scene(preset, width, count), seed, 5):
        if last.get(name, 9.0) < 8.1 <= x:
            times.append(time)
        last[name] = x
    first, end = int(0.15 * len(times)), int(0.85 * len(times)) - 1
    return (end - first) / (times[end] - times[first]) / width


def turning(preset):
    before, rates = {}, []
    for _, time, name, x, _, vx, vy in rows(exit_scene(preset, 0.7, 110), 9, 5):
        heading = math.atan2(vy, vx) if 5 < x < 8 and math.hypot(vx, vy) > 0.2 else None
        if heading is not None and before.get(name) is not None:
            rates.append(abs((heading - before[name] + math.pi) % (2 * math.pi) - math.pi) / 0.1)
        before[name] = heading
    return math.degrees(sorted(rates)[int(0.99 * len(rates))])


def one_way(preset, density, width, seed):
    count = round(density * 20 * width)
    text = RING.format(horizon=16, width=width) + KIND.format(preset)
    text += f"agents p[{count}]: adult {{ at = uniform in field; velocity = (0.6, 0) m/s; direction = 0 deg }}\n"
    speeds = [row[5] for row in rows(text, seed, 10) if row[1] >= 8]
    return statistics.mean(speeds), 100 * statistics.mean(speed < -0.02 for speed in speeds)


def two_ways_scene(preset, density):
    half = round(density * 20 * 3.6 / 2)
    text = RING.format(horizon=40, width=3.6) + KIND.format(preset)
    for name, ahead in (("p", 1), ("q", -1)):
        text += f"agents {name}[{half}]: adult {{ at = uniform in field; velocity = ({0.6 * ahead}, 0) m/s; "
        text += f"direction = {0 if ahead > 0 else 180} deg }}\n"
    return text


def two_ways(preset, density, seed):
    text = two_ways_scene(preset, density)
    speeds, strips = [], collections.defaultdict(list)
    for _, time, name, _, y, vx, _ in rows(text, seed, 25):
        if time >= 20:
            ahead = 1 if name.startswith("p") else -1
            speeds.append(ahead * vx)
            strips[time, int(y / 0.4)].append(ahead)
    order = sum(len(all) * statistics.mean(all) ** 2 for all in strips.values()) / len(speeds)
    return density * statistics.mean(speeds), order, 100 * statistics.mean(speed < -0.05 for speed in speeds)


def slow_one(preset, pace):
    text = f"""horizon = 100 s
step = 0.02 s
scene {{
  wall (-15, 0) -- (65, 0)
  wall (-15, 1.2) -- (65, 1.2)
  region goal: rect (60, 0) .. (65, 1.2)
  region start: rect (-14, 0) .. (-1, 1.2)
}}
{KIND.format(preset)}kind walker: adult {{ speed = 1.25 m/s }}
kind slow: adult {{ speed = {pace} m/s; radius = 0.3 m }}
agents p[24]: walker {{ at = uniform in start; route = goal then leave }}
agent last: slow {{ at = (0, 0.6); route = goal then leave }}
"""
    return statistics.mean(row[5] for row in rows(text, 8, 25, 2) if row[2] == "last" and row[1] > 5)


def head_on(preset):
    text = f"""horizon = 8 s
step = 0.02 s
scene {{ region start: rect (4.99, -0.5) .. (5.01, 0.5) }}
{KIND.format(preset)}kind walker: adult {{ speed = 1.34 m/s }}
agent a: walker {{ at = (-5, 0); velocity = (1.34, 0) m/s; route = (20, 0) }}
agent b: walker {{ at = uniform in start; velocity = (-1.34, 0) m/s; route = (-20, 0) }}
"""
    places, nearest = collections.defaultdict(dict), {}
    for trial, time, name, x, y, *_ in rows(text, 4, 2, 40):
        places[trial, time][name] = (x, y)
    for (trial, _), both in places.items():
        if len(both) == 2:
            nearest[trial] = min(nearest.get(trial, math.inf), math.dist(both["a"], both["b"]))
    return statistics.median(nearest.values())


def companions(preset, count):
    """The distance of two and the share of the time abreast; of three, how far the middle one is behind the others."""
    text = f"""horizon = 14 s
step = 0.02 s
scene {{
  wall (0, 0) -- (40, 0)
  wall (0, 4) -- (40, 4)
  region east: rect (38, 0.4) .. (40, 3.6)
}}
{KIND.format(preset)}group all[{count}]: adult {{ at = uniform in circle (2, 2) radius 0.9 m; route = east; attraction = 150 N }}
"""
    places = collections.defaultdict(list)
    for trial, time, _, x, y, *_ in rows(text, 5, 25, 30):
        if time >= 5:
            places[trial, time].append((y, x))
    if count == 3:
        middle = lambda all: (all[0][1] + all[2][1]) / 2 - all[1][1]
        return statistics.median(middle(sorted(all)) for all in places.values())
    apart = [(abs(a[1] - b[1]), abs(a[0] - b[0])) for a, b in places.values()]
    return statistics.median(math.hypot(*one) for one in apart), statistics.mean(along < across for along, across in apart)


def corner(preset):
    """How near to the edge the centre of somebody comes who is alone."""
    text = f"""horizon = 20 s
step = 0.02 s
scene {{
  wall (0, 0) -- (12, 0) -- (12, 14)
  wall (0, 0) -- (0, 2) -- (10, 2) -- (10, 14)
  region end: rect (10.2, 11) .. (11.8, 12)
}}
{KIND.format(preset)}kind walker: adult {{ speed = 1.34 m/s }}
agent a: walker {{ at = uniform in rect (0.5, 0.4) .. (1, 1.6); route = end }}
"""
    nearest = {}
    for trial, _, _, x, y, *_ in rows(text, 3, 2, 20):
        nearest[trial] = min(nearest.get(trial, math.inf), math.hypot(x - 10, y - 2))
    return statistics.mean(nearest.values())


def picture(name, scene, walls, box, when, presets):
    """People at a time, a panel for each preset: those of `p` filled, those of `q` not."""
    (left, low), (right, high) = box
    scale, gap = 26, 24
    width, height = (right - left) * scale, (high - low) * scale + gap
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height * len(presets):.0f}" '
             'font-family="sans-serif" font-size="13"><rect width="100%" height="100%" fill="#fff"/>']
    for panel, preset in enumerate(presets):
        point = lambda x, y: f"{(x - left) * scale:.1f} {height * panel + gap + (high - y) * scale:.1f}"
        lines.append(f'<text x="4" y="{height * panel + 16:.0f}">{preset}, {when} s</text>')
        for wall in walls:
            lines.append(f'<path d="M{" L".join(point(*p) for p in wall)}" fill="none" stroke="#222" stroke-width="2"/>')
        for _, time, who, x, y, *_ in rows(scene(preset), 9, 25):
            if abs(time - when) < 0.01 and left < x < right:
                x, y = point(x, y).split()
                fill = "#1f6fb4" if who.startswith("p") else "#fff"
                lines.append(f'<circle cx="{x}" cy="{y}" r="{0.17 * scale:.1f}" fill="{fill}" stroke="#1f6fb4"/>')
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "pictures", name), "w") as file:
        file.write("\n".join(lines) + "\n</svg>\n")


def column(preset):
    """The cells of a preset, from top to bottom."""
    flows = lambda widths: ", ".join(f"{exit_flow(preset, b, n, 9):.2f}" for b, n in widths)
    yield flows(((0.7, 110), (0.95, 120), (1.2, 130)))
    yield flows(((0.8, 115), (1.0, 125), (1.5, 150)))
    yield ", ".join(f"{one_way(preset, density, 1.8, 5)[0]:.2f}" for density in (1.1, 1.65, 2.4, 3.1))
    yield ", ".join(f"{one_way(preset, density, 3, 8)[1]:.1f} %" for density in (3.5, 5))
    for density in (2, 2.5):
        flow, order, back = (statistics.mean(all) for all in zip(*(two_ways(preset, density, seed) for seed in (2, 3))))
        yield f"{flow:.2f}, {order:.2f}, {back:.1f} %"
    yield ", ".join(f"{slow_one(preset, pace):.2f}" for pace in (0.6, 0.8, 1.0))
    yield f"{head_on(preset):.2f}"
    yield f"{turning(preset):.0f}"
    apart, abreast = companions(preset, 2)
    yield f"{apart:.2f}, {100 * abreast:.0f} %"
    yield f"{companions(preset, 3):.2f}"
    yield f"{corner(preset):.2f}"


ROWS = [
    ("exits of 0.7, 0.95, 1.2 m: flow, /(m s)", "2.34, 1.91, 1.92"),
    ("exits of 0.8, 1.0, 1.5 m", ""),
    ("one way at 1.1, 1.65, 2.4, 3.1 per m²: speed, m/s", "1.15 to 1.29, 0.95, 0.40 to 0.55, 0.30"),
    ("one way at 3.5, 5 per m²: time backwards", "0, 0"),
    ("two ways at 2 per m²: flow, /(m s), order, time backwards", "1.27, 0.9, 0.1 %"),
    ("two ways at 2.5 per m²", "1.27, 0.85, 0"),
    ("who wants 0.6, 0.8, 1.0 m/s among faster ones: speed, m/s", "0.6, 0.8, 1.0"),
    ("two who meet: distance, m", "0.78"),
    ("before an exit of 0.7 m: turning, degrees/s", "not measured"),
    ("two companions: distance, m, and share of the time abreast", "0.69 to 0.73, 80 to 97 %"),
    ("three companions: the middle one behind the others, m", "behind: a V"),
    ("alone around a corner: distance of the centre from the edge, m", "about 0.4"),
]

presets = sys.argv[1:]
columns = [list(column(preset)) for preset in presets]
print("| what | people |", " | ".join(f"`{preset}`" for preset in presets), "|")
print("| --- | --- |", " --- |" * len(presets))
for row, (what, people) in enumerate(ROWS):
    print(f"| {what} | {people} |", " | ".join(of[row] for of in columns), "|")
wall = lambda side: [(-8, 3 * side), (0, 3 * side), (0, 0.9 * side), (8, 0.9 * side), (8, 0.475 * side), (8.2, 0.475 * side), (8.2, 3 * side)]
picture("people-exit.svg", lambda preset: exit_scene(preset, 0.95, 120), [wall(1), wall(-1)], ((-2, -3), (12, 3)), 20, presets)
sides = [[(0, 0), (20, 0)], [(0, 3.6), (20, 3.6)]]
picture("people-two-ways.svg", lambda preset: two_ways_scene(preset, 2), sides, ((0, -0.1), (20, 3.7)), 30, presets)
