"""The collision-free speed model, version 2, of JuPedSim: reads a scene as JSON, writes all positions step by step."""

import json
import sys

import jupedsim as jps
from shapely import Polygon

scene = json.load(sys.stdin)
area = Polygon(scene["outline"], scene["holes"])
simulation = jps.Simulation(model=jps.CollisionFreeSpeedModelV2(), geometry=area, dt=scene["dt"])
stage = simulation.add_direct_steering_stage()
journey = simulation.add_journey(jps.JourneyDescription([stage]))
ids = []
for x, y, _, _, speed in scene["agents"]:
    person = jps.CollisionFreeSpeedModelV2AgentParameters(
        position=(x, y), journey_id=journey, stage_id=stage, desired_speed=speed
    )
    ids.append(simulation.add_agent(person))
for person, (_, _, x, y, _) in zip(ids, scene["agents"]):
    simulation.agent(person).target = (x, y)
states = []
for _ in range(scene["steps"]):
    simulation.iterate()
    states.append([list(simulation.agent(person).position) for person in ids])
json.dump(states, sys.stdout)
