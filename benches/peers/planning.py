"""TOPP-RA, Ruckig and OMPL on the tasks of `benches/plans.rs`: the fastest profile of the path `L10 A45/7 L10 A60/3 L2`, and a
roadmap of 1000 vertices between two triangles.

Needs the Python packages `toppra`, `ruckig` and `ompl`; each is skipped with a word where it is missing. Most of the time of
OMPL is its validity test, which is a Python function here.
"""
import logging
import math
import time

logging.disable(logging.WARNING)
SPEED, ACCELERATION = 10.0, 2.0
PIECES = [(10.0, math.inf, 0.0), (7 * math.pi / 4, 7.0, 1.0), (10.0, math.inf, 0.0), (math.pi, 3.0, 1.0), (2.0, math.inf, 0.0)]


def best(task, repeats):
    times = []
    for _ in range(repeats):
        started = time.process_time()
        result = task()
        times.append(time.process_time() - started)
    return min(times) * 1e6, result


def toppra_task():
    import numpy as np
    import toppra
    import toppra.constraint as constraint

    ends = np.cumsum([0.0] + [piece[0] for piece in PIECES])

    class Rounded:
        """Position, direction and curvature by the distance along the path."""

        path_interval = np.array([0.0, ends[-1]])
        duration = ends[-1]
        dof = 2

        def __call__(self, s, order=0):
            s = np.atleast_1d(s)
            out = np.zeros((len(s), 2))
            for row, at in enumerate(s):
                x, y, heading, left = 0.0, 0.0, 0.0, at
                for length, radius, _ in PIECES:
                    step = min(left, length)
                    if math.isinf(radius):
                        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
                    else:
                        turned = heading + step / radius
                        x += radius * (math.sin(turned) - math.sin(heading))
                        y -= radius * (math.cos(turned) - math.cos(heading))
                        heading = turned
                    left -= step
                    if left <= 0:
                        break
                curvature = 0.0 if math.isinf(radius) else 1.0 / radius
                if order == 0:
                    out[row] = x, y
                elif order == 1:
                    out[row] = math.cos(heading), math.sin(heading)
                else:
                    out[row] = -curvature * math.sin(heading), curvature * math.cos(heading)
            return out

        def eval(self, s):
            return self(s)

        def evald(self, s):
            return self(s, 1)

        def evaldd(self, s):
            return self(s, 2)

    path = Rounded()
    angles = np.arange(32) * 2 * np.pi / 32
    faces = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    speeds = constraint.JointVelocityConstraint(np.array([[-SPEED, SPEED]] * 2))
    accelerations = constraint.SecondOrderConstraint(
        lambda q, dq, ddq: ddq, lambda q: faces, lambda q: np.full(32, ACCELERATION), 2
    )
    grid = np.linspace(0, ends[-1], 1001)

    def task():
        found = toppra.algorithm.TOPPRA([accelerations], path, gridpoints=grid)
        _, sd, _ = found.compute_parameterization(0, 0)
        return float(np.sum(2 * np.diff(grid) / (sd[1:] + sd[:-1])))

    return best(task, 5)


def ruckig_task():
    import ruckig

    # Lines only, between the known speeds at their ends: Ruckig follows no path.
    speeds = [0.0, math.sqrt(14), math.sqrt(14), math.sqrt(6), math.sqrt(6), 0.0]
    made = ruckig.Ruckig(1)

    def task():
        total = 0.0
        for k, (length, radius, _) in enumerate(PIECES):
            given = ruckig.InputParameter(1)
            given.current_position, given.target_position = [0.0], [length]
            given.current_velocity, given.target_velocity = [speeds[k]], [speeds[k + 1]]
            given.max_velocity = [SPEED if math.isinf(radius) else math.sqrt(ACCELERATION * radius)]
            given.max_acceleration = [ACCELERATION]
            trajectory = ruckig.Trajectory(1)
            made.calculate(given, trajectory)
            total += trajectory.duration
        return total

    return best(task, 200)


def ompl_task():
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_ERROR)
    space = base.RealVectorStateSpace(2)
    bounds = base.RealVectorBounds(2)
    bounds.setLow(0.0)
    bounds.setHigh(20.0)
    space.setBounds(bounds)

    def is_free(state):
        x, y = state[0], state[1]
        return not (x > 4 and y > 4 and x + y < 18) and not (x < 16 and y < 16 and x + y > 22)

    def task():
        information = base.SpaceInformation(space)
        information.setStateValidityChecker(is_free)
        information.setup()
        problem = base.ProblemDefinition(information)
        start, goal = space.allocState(), space.allocState()
        start[0], start[1], goal[0], goal[1] = 0.5, 19.5, 19.5, 0.5
        problem.setStartAndGoalStates(start, goal)
        planner = geometric.PRM(information)
        planner.setProblemDefinition(problem)
        planner.setup()
        while planner.milestoneCount() < 1000:
            planner.growRoadmap(0.002)
        return planner.milestoneCount()

    return best(task, 3)


for name, task in [("TOPP-RA, 1000 points, 32 faces", toppra_task), ("Ruckig, five lines", ruckig_task), ("OMPL PRM, 1000 vertices", ompl_task)]:
    try:
        used, result = task()
        print(f"{name}: {used:.1f} us of CPU time, {result:.6g}")
    except ImportError as missing:
        print(f"{name}: skipped: {missing}")
    except Exception as error:
        print(f"{name}: failed: {type(error).__name__}: {error}")
