"""Random changes of certificates, their digests made right, in both verifiers: `python3 benches/mutants.py SMC [COUNT]`.

Each mutant has one change: a number of a result, of its claim or of what was asked is another one, an outcome is flipped, two are
swapped, one is dropped or appended, an unresolved trial is added, a result has the outcomes of another one, a verdict or a choice is
another one. The table says how many of each kind `smc verify` and `tools/verify.py` refuse, and of how many an audit of 300 draws
finds what they cannot see.
"""

import base64
import collections
import contextlib
import hashlib
import io
import json
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "tools"))
import verify  # noqa: E402

COIN = """horizon = 10 s
step = 1 s
param p = 0.7 in 0 .. 1
process coin { var heads = 0; when heads < 10 at p * 1 /s -> heads = heads + 1 }
"""
RULES = """property heads = F<=1 s (coin.heads >= 1)
check P(heads) >= 0.3
check P(heads) < 0.7 by sprt(alpha = 0.02, beta = 0.01, indifference = 0.05)
check P(heads) > 0.3 by sprt2(alpha = 0.01, beta = 0.01, indifference = 0.1)
check P(heads) >= 0.4 by plan(alpha = 0.01, beta = 0.01, indifference = 0.05)
estimate P(heads) within 0.05
estimate P(heads) by okamoto(epsilon = 0.05, delta = 0.05)
estimate P(heads) by clopper_pearson(trials = 321)
estimate P(heads) by spending(epsilon = 0.05, delta = 0.05)
estimate E(coin.heads at 5 s) in 0 .. 10 within 0.5
estimate Q(0.9, time_until(coin.heads >= 3))
estimate Q(0.5, time_until(coin.heads >= 3)) by dkw(trials = 500)
check E(coin.heads at 5 s) in 0 .. 10 >= 3
rank p in 0.5, 0.7, 0.9 by P(heads) within 0.1
compare P(heads) under p = 0.5 with p = 0.9 within 0.1
"""
# What outcomes do not say, or nothing is concluded from.
UNSAID = {"index", "line", "file", "shrunk", "no_way", "warnings", "stopped_by", "shortfall", "horizon", "censored", "model", "column", "world", "said", "text", "name", "certifies", "query", "every", "given", "point", "settings", "kind", "interval", "of", "unit"}


def numbers(value, path=()):
    """The places of the numbers of a value that say something."""
    if isinstance(value, dict):
        for name in value:
            if name not in UNSAID:
                yield from numbers(value[name], (*path, name))
    elif isinstance(value, list):
        for k, one in enumerate(value):
            yield from numbers(one, (*path, k))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path


def change(value, path, make):
    for name in path[:-1]:
        value = value[name]
    value[path[-1]] = make(value[path[-1]])


def truths(line):
    return verify.unpacked(dict(line))["truths"]


def packed(line, truths):
    data = bytearray(-(-len(truths) // 8))
    for k, truth in enumerate(truths):
        data[k // 8] |= truth << k % 8
    line.pop("runs", None)
    line.update(count=len(truths), bits=base64.b64encode(bytes(data)).decode())


def mutant(lines, draw):
    """A kind of change, and the lines with it; none where the change is none."""
    lines = json.loads(json.dumps(lines))
    results = [k for k, line in enumerate(lines) if "result" in line]
    at = draw.choice(results)
    end = next((k for k in results if k > at), len(lines))
    own = [line for line in lines[at + 1 : end] if "count" in line]
    kind = draw.choice(["result", "claim", "asked", "verdict", "flip", "swap", "drop", "append", "unresolved", "foreign", "seed"])
    line = draw.choice(own)
    if kind in ("result", "claim", "asked"):
        field = {"result": "result", "claim": "claim", "asked": "queries"}[kind]
        places = list(numbers(lines[at][field]))
        if not places:
            return None
        path = draw.choice(places)
        step = draw.choice([-1, 1]) * draw.choice([1e-3, 0.01, 0.5])
        change(lines[at][field], path, lambda x: x + (draw.choice([-1, 1]) if isinstance(x, int) else step * max(abs(x), 0.1)))
        kind = f"{kind}: {'.'.join(str(one) for one in path if not isinstance(one, int))}"
    elif kind == "verdict":
        result = lines[at]["result"]
        if result["verdict"]:
            result["verdict"] = {"satisfied": "violated", "violated": "satisfied"}.get(result["verdict"], "satisfied")
        elif "choice" in result:
            other = draw.choice([one["option"] for one in result["options"] if one["option"] != result["choice"]])
            result["choice"] = lines[at]["claim"]["claim"]["Best"]["choice"] = other
        else:
            return None
    elif kind == "seed":
        lines[0]["seed"] += 1
    elif "values" in line:
        values = line["values"]
        k = draw.randrange(len(values))
        if kind == "flip":
            values[k] = 1.0 if isinstance(values[k], str) else values[k] + 1
        elif kind == "swap":
            other = draw.randrange(len(values))
            if values[k] == values[other]:
                return None
            values[k], values[other] = values[other], values[k]
        elif kind == "drop":
            del values[k]
        elif kind == "append":
            values.append(values[k])
        elif kind == "unresolved":
            values[k] = None
            line["unresolved"] = sorted({*line["unresolved"], k})
        else:
            return None
        line["count"] = len(values)
        kind += " a value"
    else:
        own = truths(line)
        k = draw.randrange(len(own))
        if kind == "flip":
            own[k] = not own[k]
        elif kind == "swap":
            other = draw.randrange(len(own))
            if own[k] == own[other]:
                return None
            own[k], own[other] = own[other], own[k]
        elif kind == "drop":
            del own[k]
        elif kind == "append":
            own.append(draw.random() < 0.5)
        elif kind == "unresolved":
            line["unresolved"] = sorted({*line["unresolved"], k})
        else:
            other = draw.choice([one for one in lines if "count" in one and "values" not in one])
            if truths(other) == own:
                return None
            own = truths(other)
        packed(line, own)
    # The other results are right, and only take time.
    return kind, [lines[0], *lines[at:end]]


def written(path, lines):
    text = "".join(json.dumps(line) + "\n" for line in lines)
    path.write_text(text + json.dumps({"digest": "sha256:" + hashlib.sha256(text.encode()).hexdigest()}) + "\n")


def main(smc, count):
    draw, table = random.Random(1), collections.defaultdict(lambda: [0, 0, 0, 0, 0])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "coin.scn").write_text(COIN)
        (folder / "rules.bltl").write_text(RULES)
        call = lambda *words: subprocess.run([smc, *words], cwd=folder, capture_output=True, text=True).returncode
        call("check", "coin.scn", "rules.bltl", "-q", "--certificate", "coin.smcc")
        lines = [json.loads(line) for line in (folder / "coin.smcc").read_text().splitlines()[:-1]]
        made = 0
        while made < count:
            one = mutant(lines, draw)
            if not one:
                continue
            made += 1
            kind, changed = one
            written(folder / "mutant.smcc", changed)
            program = call("verify", "mutant.smcc", "-j", "1")
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                python = verify.main(str(folder / "mutant.smcc"))
            row = table[kind]
            row[0] += 1
            if program > 2:
                print(f"exit code {program}: {kind}", file=sys.stderr)
            row[1] += program in (1, 2)
            row[2] += python in (1, 2)
            if program == 0 and kind.split()[0].rstrip(":") in ("seed", "flip", "swap"):
                row[3] += 1
                files = ("coin.scn", "rules.bltl", "--audit", "300", "--audit-seed", str(made))
                row[4] += call("verify", "mutant.smcc", *files) == 1
    print(f"{'change':44} {'made':>6} {'smc':>6} {'python':>6} {'passed, audited':>16} {'found':>6}")
    for kind, row in sorted(table.items()):
        print(f"{kind:44} {row[0]:6} {row[1]:6} {row[2]:6} {row[3]:16} {row[4]:6}")
    total = [sum(row[k] for row in table.values()) for k in range(5)]
    print(f"{'all':44} {total[0]:6} {total[1]:6} {total[2]:6} {total[3]:16} {total[4]:6}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), int(sys.argv[2]) if len(sys.argv) > 2 else 10_000)
