"""Agent-steps per second of JuPedSim with routing in the building of `benches/ways.rs`: 500 walls, 10 000 agents.

Needs the Python packages `jupedsim` and `shapely`; says so and ends where they are missing. Walls are 2 cm thick here,
because the geometry of JuPedSim is a polygon.
"""
import resource
import sys

try:
    import jupedsim as jps
    from shapely import LineString, Polygon, unary_union
except ImportError as missing:
    sys.exit(f"skipped: {missing}")

ROWS, COLUMNS, AGENTS, STEPS, DT = 10, 16, 10_000, 25, 0.04


def seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def walls():
    for row in range(ROWS):
        y, width = row * 14.0, COLUMNS * 10.0
        yield (0, y), (width, y)
        for column in range(COLUMNS + 1):
            yield (column * 10, y), (column * 10, y + 10)
        for column in range(COLUMNS):
            x = column * 10.0
            yield (x, y + 10), (x + 4.4, y + 10)
            yield (x + 5.6, y + 10), (x + 10, y + 10)


solid = unary_union([LineString(wall).buffer(0.01, cap_style="square") for wall in walls()])
ground = Polygon([(-12, -3), (163, -3), (163, 143), (-12, 143)]).difference(solid)
started = seconds()
simulation = jps.Simulation(model=jps.SocialForceModel(), geometry=ground, dt=DT)
stage = simulation.add_exit_stage([(-9, 60), (-4, 60), (-4, 80), (-9, 80)])
journey = simulation.add_journey(jps.JourneyDescription([stage]))
room = Polygon([(0, 0), (160, 0), (160, 140), (0, 140)]).difference(solid.buffer(0.35))
parts = sorted(getattr(room, "geoms", [room]), key=lambda part: part.bounds)
rest, area, places = AGENTS, room.area, []
for part in parts:
    count = round(rest * part.area / area)
    rest, area = rest - count, area - part.area
    places += jps.distribute_by_number(
        polygon=part, number_of_agents=count, distance_to_agents=0.65, distance_to_polygon=0.0, seed=1
    )
for place in places:
    simulation.add_agent(
        jps.SocialForceModelAgentParameters(
            position=place, desired_speed=1.34, radius=0.25, journey_id=journey, stage_id=stage
        )
    )
print(f"set up in {seconds() - started:.1f} s of CPU time")
for _ in range(3):
    started = seconds()
    simulation.iterate(STEPS)
    used = seconds() - started
    print(f"jupedsim {jps.__version__ if hasattr(jps, '__version__') else ''}: {AGENTS * STEPS / used / 1e6:.4f} M agent-steps/s")
