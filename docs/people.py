"""The table of docs/people.md: moves at twelve recorded instants, chosen under three models of people.

    SMC=target/release/smc SMC_DATA=path/to/data python3 docs/people.py

The recordings are ETH/BIWI (obsmat.txt of seq_hotel and seq_eth). An instant is one at which somebody walks faster than
0.9 m/s, at least two others are ahead within 5 m, and somebody would come nearer than 0.7 m within 4 s if all kept their
velocities. Of all persons with such an instant six are taken for each recording, evenly spaced by their number.
"""

import collections
import json
import math
import os
import subprocess
import tempfile

MODELS = ["smc2", "cfs2", "helbing2000"]
DATA = os.path.join(os.environ["SMC_DATA"], "eth-biwi")
SMC = os.path.abspath(os.environ.get("SMC", "smc"))
RANK = """property safe = G<=4.8 s (forall a in others: distance(user, a) > 0.8 m)
property onward = F<=4.8 s (travelled(user) > 3 m)
rank moves of user by P(safe & onward) within 0.05 confidence 95 %
rank moves of user by P(safe & onward) by okamoto(epsilon = 0.2, delta = 0.05)
"""
SCENE = """horizon = 8 s
step = 0.02 s
tracks h = eth_biwi "{file}" {{ velocity = seen }}
kind adult: preset {preset} {{ noise = 0.08 m/s }}
agent user: adult from h at {time} s id {person}
groups others: adult from h at {time} s except {person} {{
  attraction = 150 N
  heading    = recorded + normal(0 deg, 14 deg)
  speed      = wanted * normal(1, 0.15) in 0 m/s .. 3 m/s
}}
moves user for 1.6 s {{ heading from -60 deg to 60 deg by 15 deg; stop }}
"""


def instants(file, rate):
    places = collections.defaultdict(dict)
    for line in open(os.path.join(DATA, file)):
        row = [float(word) for word in line.split()]
        if row:
            places[int(row[1])][int(row[0])] = (row[2], row[4])
    step, found = round(0.4 * rate), {}
    first = min(min(track) for track in places.values())
    for person, track in places.items():
        frames = [f for f in track if f - step in track and all(f + step * k in track for k in range(1, 13))]
        fit = [f for f in frames if is_fit(places, person, f, step)]
        if fit:
            found[person] = fit[len(fit) // 2]
    people = sorted(found)
    for k in range(6):
        person = people[k * len(people) // 6]
        yield (found[person] - first) / rate, person


def is_fit(places, person, frame, step):
    def moved(who):
        (x, y), (u, v) = places[who][frame], places[who][frame - step]
        return x - u, y - v

    own, (vx, vy) = places[person][frame], moved(person)
    others = [q for q in places if q != person and frame in places[q] and frame - step in places[q]]
    gaps = [(places[q][frame][0] - own[0], places[q][frame][1] - own[1], *moved(q)) for q in others]
    if math.hypot(vx, vy) / 0.4 <= 0.9 or any(math.hypot(x, y) <= 0.9 for x, y, *_ in gaps):
        return False
    ahead = sum(math.hypot(x, y) < 5 and x * vx + y * vy > 0 for x, y, *_ in gaps)
    near = any(math.hypot(x + k * (u - vx), y + k * (v - vy)) < 0.7 for x, y, u, v in gaps for k in range(1, 11))
    return ahead >= 2 and near


def ranking(folder, words):
    call = [SMC, "check", "a.scn", "a.bltl", "-q", "--data", DATA, "--format", "json", *words]
    done = subprocess.run(call, capture_output=True, text=True, cwd=folder)
    return json.loads(done.stdout)["results"]


def main():
    print("| recording, time, person | smc2 | cfs2 | helbing2000 | all three | lost by one model | lost by all three |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    lost_alone, lost_together, agree = [], [], 0
    for file, rate in (("seq_hotel/obsmat.txt", 25), ("seq_eth/obsmat.txt", 15)):
        for time, person in instants(file, rate):
            with tempfile.TemporaryDirectory() as folder:
                open(f"{folder}/a.bltl", "w").write(RANK)
                alone, worth = {}, {}
                for preset in MODELS:
                    open(f"{folder}/a.scn", "w").write(SCENE.format(**locals()))
                    alone[preset], equal = ranking(folder, [])
                    worth[preset] = {one["option"]: one["estimate"] for one in equal["options"]}
                together = ranking(folder, ["--models", ",".join(MODELS), "--only", "0"])[0]
            loss = lambda move: [max(worth[m].values()) - worth[m][move] for m in MODELS]
            ones = [max(loss(alone[m]["choice"])) for m in MODELS]
            all_three = max(loss(together["choice"]))
            lost_alone += ones
            lost_together.append(all_three)
            choices = [alone[m]["choice"] for m in MODELS]
            agree += len(set(choices)) == 1
            short = lambda move: move.replace("heading ", "").replace(" deg", "°")
            cells = [short(one) for one in (*choices, together["choice"])]
            name = file.split("/")[0][4:]
            lost = f"{' / '.join(f'{one:.2f}' for one in ones)} | {all_three:.2f}"
            print(f"| {name}, {time:.1f} s, {person} | {' | '.join(cells)} | {lost} |", flush=True)
    mean = lambda list: sum(list) / len(list)
    print(f"\nagree in {agree}; one model loses {mean(lost_alone):.2f} on average, {max(lost_alone):.2f} at most;", end=" ")
    print(f"all three {mean(lost_together):.2f} on average, {max(lost_together):.2f} at most")


main()
