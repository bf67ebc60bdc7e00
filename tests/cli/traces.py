"""Loads a trajectory with PedPy and compares it with rows `id frame x y`: FILE EXPECTED RATE."""

import pathlib
import sys

import pedpy

file, expected, rate = pathlib.Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])
is_text = file.suffix == ".txt"
load = pedpy.load_trajectory_from_txt if is_text else pedpy.load_trajectory_from_jupedsim_sqlite
loaded = load(trajectory_file=file)
assert abs(loaded.frame_rate - rate) < 1e-9, loaded.frame_rate
rows = {}
for line in open(expected):
    id, frame, x, y = line.split()
    rows[int(id), int(frame)] = float(x), float(y)
found = {(int(row.id), int(row.frame)): (row.x, row.y) for row in loaded.data.itertuples()}
assert found.keys() == rows.keys()
# The parser of pandas rounds the last digit of a text.
most = 1e-12 if is_text else 0.0
for key, place in rows.items():
    assert max(abs(a - b) for a, b in zip(place, found[key])) <= most, (key, place, found[key])
if not is_text:
    area = pedpy.load_walkable_area_from_jupedsim_sqlite(trajectory_file=file)
    # A room of 10 m by 7 m with walls of 1 mm, less a desk of 1 m^2.
    assert abs(area.area - 69) < 0.02, area.area
    assert pedpy.is_trajectory_valid(traj_data=loaded, walkable_area=area)
