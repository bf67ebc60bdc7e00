"""Compares the measures of a trial with those of PedPy: TRIAL SCENE "X Y X Y ..." (the corners of the walkable area).

Each line of a trial has a frame, an id, a place, a speed, and the measures of that state in the order of `measures.rs`.
"""

import sys

import numpy as np
import pandas as pd
import pedpy
import shapely

path, scene, corners = sys.argv[1:]
rows = np.loadtxt(path)
data = pd.DataFrame(rows[:, :4], columns=["frame", "id", "x", "y"]).astype({"frame": int, "id": int})
trajectory = pedpy.TrajectoryData(data, frame_rate=20.0)
measures = pd.DataFrame(rows[:, 5:], index=data.frame).groupby(level=0).first()
corners = np.array(corners.split(), dtype=float).reshape(-1, 2)
walkable = pedpy.WalkableArea(shapely.Polygon(corners))
lines, hall = {
    "hall": ([[(0, -3), (1, 3)], [(4, 6), (4, -6)]], (-2, -3, 3, 2.5)),
    "room": ([[(6, 2.5), (6, 3.5)], [(9, 0), (9, 6)]], (4, 1.5, 7, 4.5)),
}[scene]
area = pedpy.MeasurementArea(shapely.box(*hall))


def compare(name, column, theirs, frames):
    ours = measures[column].loc[frames].to_numpy()
    worst = np.abs(ours - theirs.loc[frames].to_numpy()).max()
    print(f"{name} {worst:.1e}", end="; ")
    assert worst <= 1e-9, f"{name} differs by {worst}"


# The last frame of each recording is left out: PedPy sees no movement into it.
frames = measures.index[:-1]
for column, ends in enumerate(lines):
    counted, crossed = pedpy.compute_n_t(traj_data=trajectory, measurement_line=pedpy.MeasurementLine(ends))
    counted = counted.set_index("frame").cumulative_pedestrians
    compare(f"crossings {counted.iloc[-1]}", column, counted, frames)
    if column == 0:
        full = frames[20:]
        flow = counted.loc[full] - counted.shift(20).loc[full]
        compare("flow", 2, flow, full)
speed = data[["id", "frame"]].assign(speed=rows[:, 4])
speeds = pedpy.compute_mean_speed_per_frame(traj_data=trajectory, individual_speed=speed, measurement_area=area)
compare("mean speed", 3, speeds.set_index("frame").speed, frames)
density = pedpy.compute_classic_density(traj_data=trajectory, measurement_area=area)
compare("density", 7, density.set_index("frame").density, frames)
cells = pedpy.compute_individual_voronoi_polygons(
    traj_data=trajectory, walkable_area=walkable, cut_off=pedpy.Cutoff(radius=1.0, quad_segments=3)
)
density, _ = pedpy.compute_voronoi_density(individual_voronoi_data=cells, measurement_area=area)
compare("Voronoi density", 6, density.set_index("frame").density, frames)
print()
