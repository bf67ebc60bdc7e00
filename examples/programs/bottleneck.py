"""Twenty people leave a hall of 5 m by 4 m through a door, in JuPedSim.

Writes a row for each person every 0.5 s, and one without an id when nobody is left.
"""

import argparse
import random

import jupedsim
import shapely

parser = argparse.ArgumentParser()
parser.add_argument("--seed", type=int, required=True)
parser.add_argument("--width", type=float, required=True)
call = parser.parse_args()
draw = random.Random(call.seed)

hall = shapely.box(0, 0, 5, 4)
door = shapely.box(5, 2 - call.width / 2, 8, 2 + call.width / 2)
exit_area = shapely.box(7, 2 - call.width / 2, 8, 2 + call.width / 2)

simulation = jupedsim.Simulation(
    model=jupedsim.CollisionFreeSpeedModel(), geometry=shapely.union(hall, door), dt=0.05
)
stage = simulation.add_exit_stage(exit_area)
journey = simulation.add_journey(jupedsim.JourneyDescription([stage]))
places = jupedsim.distribute_by_number(
    polygon=hall, number_of_agents=20, distance_to_agents=0.4, distance_to_polygon=0.25, seed=call.seed
)
for place in places:
    parameters = jupedsim.CollisionFreeSpeedModelAgentParameters(
        position=place, journey_id=journey, stage_id=stage, radius=0.18, desired_speed=max(0.5, draw.gauss(1.34, 0.26))
    )
    simulation.add_agent(parameters)

print("t,id,x,y")
for state in range(61):
    time = state * 0.5
    for agent in simulation.agents():
        print(f"{time},{agent.id},{agent.position[0]:.4f},{agent.position[1]:.4f}")
    if simulation.agent_count() == 0:
        print(f"{time},,,")
        break
    simulation.iterate(10)
