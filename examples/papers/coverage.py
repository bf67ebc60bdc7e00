"""Figures 9 and 10 of Li, Li, Ge 2019: coverage and short edges of roadmaps on `examples/papers/map.scn`.

    python3 examples/papers/coverage.py [PROGRAM]

Coverage is the area of the convex hull of the vertices over that of the square; an edge is short below 0.5 m.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "target/release/smc"
SEEDS = range(6)
ROADMAPS = [
    ("PRM with bridge test", "prm(samples = {n}, separation = 0 m, sampling = bridge, clearance = 0 m)"),
    ("PRM, uniform", "prm(samples = {n}, separation = 0 m, sampling = uniform, clearance = 0 m)"),
    ("RRT, step 0.5 m", "rrt(root = (1, 19), samples = {n}, step = 0.5 m, bias = 0, clearance = 0 m)"),
    ("RRT, bias 0.05", "rrt(root = (1, 19), samples = {n}, step = 0.5 m, bias = 0.05, clearance = 0 m)"),
]


def hull(points):
    """Area of the convex hull (Andrew's monotone chain)."""
    points = sorted(map(tuple, points))
    turn = lambda o, a, b: (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
    ring = []
    for ps in (points, points[::-1]):
        stack = []
        for p in ps:
            while len(stack) > 1 and turn(stack[-2], stack[-1], p) <= 0:
                stack.pop()
            stack.append(p)
        ring += stack[:-1]
    return 0.5 * abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1])))


def roadmap(rule, seed):
    text = (HERE / "map.scn").read_text().replace("prm(samples = samples)", rule)
    words = [PROGRAM, "path", "-", "--format", "json", "--seed", str(seed)]
    done = subprocess.run(words, input=text, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["roadmap"]


print(f"{'':22}" + "".join(f"{n:>22} vertices" for n in (100, 500, 1000)))
for name, rule in ROADMAPS:
    cells = []
    for n in (100, 500, 1000):
        covered, short = [], []
        for seed in SEEDS:
            found = roadmap(rule.format(n=n), seed)
            vertices = found["vertices"]
            covered.append(hull(vertices) / 400)
            short.append(sum(math.dist(vertices[a], vertices[b]) < 0.5 - 1e-9 for a, b, *_ in found["edges"]))
        cells.append(f"{100 * sum(covered) / len(covered):.1f} %, {sum(short) / len(short):.0f} short")
    print(f"{name:22}" + "".join(f"{cell:>31}" for cell in cells))
