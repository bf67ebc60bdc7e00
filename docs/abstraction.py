"""The table of docs/papers.md: the moves of a group ranked by its body and by its members.

    SMC=target/release/smc python3 docs/abstraction.py

A group of 2 to 8 persons meets 14 others in a corridor. Its moves are ranked twice: the group as one body (`as particle`),
and member by member. The event is the same: in 13 s the goal, and for 6 s nobody of the crowd nearer than 5 cm. `by okamoto`
gives all moves as many trials, so that the score of each is known.
"""

import json
import os
import subprocess
import tempfile

SMC = os.path.abspath(os.environ.get("SMC", "smc"))
SCENE = """horizon = 14 s
step = 0.02 s
scene {{
  wall (0, 0) -- (24, 0)
  wall (0, 6) -- (24, 6)
  region goal: rect (13, 0) .. (24, 6)
  region there: rect (6, 0.5) .. (14, 5.5)
  region west: rect (-30, 0) .. (-20, 6)
  region east: rect (22, 0) .. (24, 6)
}}
kind adult: preset smc2 {{ }}
group party[{n}]: adult{group}; route = east }}
agents crowd[14]: adult {{ at = uniform in there; route = west }}
moves party for 2 s {{ heading from -60 deg to 60 deg by 30 deg; stop }}
"""
GROUPS = {
    "members": " { attraction = 150 N; at = uniform in circle (2.5, 3) radius 1.3 m",
    "body": " as particle { at = (2.5, 3)",
}
EVENTS = {
    "members": "F<=13 s (forall a in party: a in goal) & "
    "G<=6 s (forall a in party: forall b in crowd: distance(a, b) - radius(a) - radius(b) > 0.05 m)",
    "body": "F<=13 s (centroid(party) in goal) & "
    "G<=6 s (forall b in crowd: distance(centroid(party), b) - radius(party) - radius(b) > 0.05 m)",
}


def ranked(folder, kind, n):
    """The ranking of a group of n, and the same moves with as many trials each."""
    scene, asked = (os.path.join(folder, name) for name in ("a.scn", "a.bltl"))
    with open(scene, "w") as file:
        file.write(SCENE.format(n=n, group=GROUPS[kind]))
    with open(asked, "w") as file:
        file.write(f"property ok = {EVENTS[kind]}\nrank moves of party by P(ok) within 0.05\n")
        file.write("rank moves of party by P(ok) within 0.1 by okamoto\n")
    call = [SMC, "check", scene, asked, "-q", "-j", "1", "--format", "json"]
    return json.loads(subprocess.run(call, capture_output=True, text=True).stdout)["results"]


def order(scores):
    best_first = sorted(scores, key=lambda move: -scores[move])
    return {move: place for place, move in enumerate(best_first)}


print("| members | best by members | chosen by the body | loss | order | P of the choice: members, body | trials | µs a trial |")
print("| --- | --- | --- | --- | --- | --- | --- | --- |")
with tempfile.TemporaryDirectory() as folder:
    for n in (2, 4, 6, 8):
        found = {kind: ranked(folder, kind, n) for kind in GROUPS}
        scores = {kind: {o["option"]: o["estimate"] for o in all[1]["options"]} for kind, all in found.items()}
        members, body = scores["members"], scores["body"]
        choice, k = found["body"][0]["choice"], len(members)
        places = [order(members), order(body)]
        apart = sum((places[0][move] - places[1][move]) ** 2 for move in members)
        cost = [round(1e6 * found[kind][1]["elapsed_s"] / found[kind][1]["trials"]) for kind in GROUPS]
        print(
            f"| {n} | {found['members'][0]['choice']} | {choice} | {max(members.values()) - members[choice]:.2f} "
            f"| {1 - 6 * apart / (k * (k * k - 1)):.2f} | {members[choice]:.2f}, {body[choice]:.2f} "
            f"| {found['members'][0]['trials']}, {found['body'][0]['trials']} | {cost[0]}, {cost[1]} |"
        )
