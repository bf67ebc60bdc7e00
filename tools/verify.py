"""Checks a certificate of smc: `python3 tools/verify.py out.smcc`. Needs nothing but Python, and shares no code with the program.

The digest of the lines is compared first. Then every decision and interval, and every stop on which a claim depends, is computed again
from the outcomes, by the rules of docs/proofs.md (theorems.py). Exit code 0: all of them are right; 1: something is refused; 2: this is
no certificate that can be read; 3: nothing is wrong, but a result is not checked here.

`python3 tools/verify.py out.smcc MODEL [PROPERTIES…] --program smc --audit 300` also runs trials again: see audit.py.
"""

import argparse
import base64
import bisect
import collections
import hashlib
import itertools
import json
import math
import sys

from theorems import (
    ESTIMATES, RACE, SLACK, TESTS, Refused, Sequence, Unchecked, at_all_times, bisected, capitals, clopper_pearson, decided,
    difference, gbas, held_at_all_times, hull, is_tail_above, is_tail_below, ln_tails, mean, mixed, require, tail, weighed,
)

FORMAT = "certificate 1"
MOST = 10**8  # outcomes of one line
INF = math.inf


class Unreadable(Exception):
    """The file is no certificate, or a damaged one."""


class Measure:
    """A number of the law of trials: a probability, a mean, or the mean of the largest share; from 0 to 1."""

    def __init__(self, of):
        self.low, self.high = of.get("range", (0.0, 1.0))
        self.scale, level = self.high - self.low, of.get("level")
        self.kind = {"expectation": "mean" if level is None else "tail"}.get(of["kind"], of["kind"])
        self.share = 1.0 - (level or 0.0)

    def to(self, x):
        """A number from 0 to 1 in the unit of the measure."""
        return self.low if x <= 0 else self.high if x >= 1 else self.low + self.scale * x

    def part(self, x):
        return (x - self.low) / self.scale

    def readings(self, line):
        """Unresolved trials read as the least, and as the largest they can be; one reading where there are none."""
        values, lost = line["truths"], set(line["unresolved"])
        if "values" in line:
            lost = {k for k, v in enumerate(line["values"]) if v is None}
            values = [0.0 if v is None else self.part(min(max(v, self.low), self.high)) for v in line["values"]]
        return [[end if k in lost else x for k, x in enumerate(values)] for end in (0, 1)] if lost else [values]

    def running(self, reading, error, word):
        """The intervals after every so many trials, which hold all at once."""
        sequence, s = Sequence(error), 0
        for n, x in enumerate(reading, 1):
            s += x
            if self.kind == "mean":
                sequence.push(x)
            if n % word == 0 or n == len(reading):
                yield at_all_times(s, n - s, error) if self.kind == "probability" else sequence.ends()

    def interval(self, line, error, told=None):
        """The interval that holds at all numbers of trials."""
        readings = self.readings(line)
        if self.kind == "tail":
            return tail(readings, self.share, error, told and (self.part(told["low"]), self.part(told["high"])))
        return hull([(0.0, 1.0), *self.running(reading, error, INF)][-1] for reading in readings)

    def holds(self, bound, line, error, word):
        """Whether trials show a constraint, or its opposite; nothing where they show neither."""
        theta, at_least, readings = self.part(bound["threshold"]), bound["at_least"], self.readings(line)
        if self.kind == "tail":
            above, below = is_tail_above(readings[0], self.share, theta, error), is_tail_below(readings[-1], self.share, theta, error)
        else:
            above = any(low > theta or at_least and low == theta for low, _ in self.running(readings[0], error, word))
            below = any(high < theta or not at_least and high == theta for _, high in self.running(readings[-1], error, word))
        return above == at_least if above or below else None


# Results.


def alike(a, b, slack=1e-7):
    return a == b or abs(a - b) <= slack * max(abs(a), abs(b)) + 1e-11


def near(a, b, what, slack=1e-7):
    """That a number of the file is the one that was computed."""
    require(None not in (a, b) and alike(a, b, slack), f"{what} is {b}, not {a}")


def follows(claim, wanted, error):
    """That nothing more is claimed than what was found; where there is no claim nothing is."""
    if claim is None:
        return
    ((form, told),) = claim["claim"].items()
    require(form in wanted, f"the claim is {claim}, not {wanted}")
    if form == "Between":
        least, most = (end if told[name] is None else told[name] for name, end in (("low", -INF), ("high", INF)))
        low, high = wanted[form]
        is_no_more = (least <= low or alike(least, low)) and (most >= high or alike(most, high))
    else:
        flat = [[x if isinstance(x, list) else [x] for x in one.values()][0] for one in (told, wanted[form])]
        is_no_more = [*told] == [*wanted[form]] and all(abs(a - b) < 1e-12 for a, b in zip(*flat, strict=True))
    require(is_no_more and claim["error"] >= error - 1e-12, f"the claim is {claim}, not {wanted} with error {error}")


def ended(result, low, high, unbounded=(-INF, INF)):
    """That the ends of a result are those that were computed."""
    told = [end if result[name] is None else result[name] for name, end in zip(("low", "high"), unbounded)]
    near(low, told[0], "the lower end")
    near(high, told[1], "the upper end")
    return {"Between": (low, high)}


def bounded(line, low, high):
    """The ends for a number that may be known to be never below 0."""
    return max(low, 0.0) if line.get("time") else low, high


def until(look, truths):
    """The numbers of successes and failures after which a rule stops, and what it says; the end and nothing where it does not."""
    s = f = 0
    for truth in truths:
        s, f = s + truth, f + (not truth)
        if found := look(s, f, truth):
            return s, f, found
    return s, f, None


def stopped(result, found):
    """That the rule stops after the trials of the result, in the reading that takes longer."""
    most = max(s + f for s, f, _ in found)
    require(result["trials"] == most, f"the rule stops after {most} trials, not {result['trials']}")


def check(result, ask, line):
    """The verdict, what it claims, and with which error."""
    measure, rule, error = Measure(ask["measure"]), result["method"], ask["beside"]
    if measure.kind == "probability":
        require(rule["name"] == ask["test"]["name"], f"`{ask['test']['name']}` was asked for, not `{rule['name']}`")
        found = [until(TESTS[rule["name"]](rule, ask["threshold"]), reading) for reading in measure.readings(line)]
        stopped(result, found)
        weighed(line.get("evidence"), rule, ask["threshold"], measure.readings(line))
        decisions = {decision for *_, decision in found}
        decision = decisions.pop() if len(decisions) == 1 else None
    error = error if measure.kind == "probability" else rule["delta"]
    low, high = bounded(line, *(measure.to(x) for x in measure.interval(line, error, result)))
    if measure.kind != "probability":
        decision = "above" if low > ask["threshold"] else "below" if high < ask["threshold"] else None
    verdict = "undecided" if decision in (None, "within") else "satisfied" if (decision == "above") == ask["at_least"] else "violated"
    require(result["verdict"] == verdict, f"the outcomes say {verdict}, not {result['verdict']}")
    found = ended(result, low, high)
    if decision and measure.kind != "probability":
        return {"Decided": {"Above" if decision == "above" else "Below": ask["threshold"]}}, error
    claim, wrong = decided(rule, ask, decision) if decision else (None, error)
    return ({"Decided": claim} if decision else found), wrong


def checks(result, queries, claim, lines):
    """A check, or one under every value of a parameter: each is a check of its own, and all errors add up."""
    parts = result["every"]["values"] if "every" in result else [result]
    found = [check({**result, **part}, query["ask"]["check"], line) for part, query, line in zip(parts, queries, lines, strict=True)]
    verdicts = [part["verdict"] for part in parts]
    verdict = "violated" if "violated" in verdicts else "satisfied" if {*verdicts} == {"satisfied"} else "undecided"
    require(result["verdict"] == verdict, f"the outcomes say {verdict}: {', '.join(verdicts)}")
    least = next(k for k, part in enumerate(parts) if len(parts) == 1 or part["value"] == result["every"]["least"])
    follows(claim, found[least][0], sum(error for _, error in found) if verdict == "satisfied" else found[least][1])


def band(n, rule):
    """Dvoretzky, Kiefer and Wolfowitz, with the constant of Massart 1990. Before its end the error is spent over all numbers of trials."""
    return math.sqrt(math.log(2 * (n * (n + 1) if n < rule["trials"] else 1) / rule["delta"]) / (2 * n))


def quantile(rule, level, values):
    """Order statistics: ranks from binomial tails; or from the band."""
    n, known, error = len(values), sorted(v for v in values if v is not None), rule["delta"]
    first = lambda holds: bisect.bisect_left(range(n), True, key=holds)
    if rule["name"] == "dkw":
        lower, upper = math.floor((level - band(n, rule)) * n), math.ceil((level + band(n, rule)) * n)
    elif n < rule["trials"]:
        is_in = lambda k: held_at_all_times(k, n - k, 0.5 * error, level)
        lower, upper = first(lambda k: k / n >= level or is_in(k)), first(lambda k: (k + 1) / n > level and not is_in(k + 1)) + 1
    else:
        goal = math.log(0.5 * error)
        lower = first(lambda k: ln_tails(k + 1, n - k, level)[1] > goal)
        upper = first(lambda k: ln_tails(k + 1, n - k, level)[0] <= goal) + 1
    ranked = [-INF] * (n - len(known) + 1) + known  # those that are unresolved lie below everything, or above
    return ranked[max(lower, 0)], known[upper - 1] if 0 < upper <= len(known) else INF


def curve(rule, of, values):
    """The band, at the last bound of the curve."""
    n, last = len(values), of["times"][-1] + 1e-9
    low = sum(v is not None and v <= last for v in values) / n
    low, high = max(low - band(n, rule), 0.0), min(low + values.count(None) / n + band(n, rule), 1.0)
    return (1.0 - high, 1.0 - low) if of["falls"] else (low, high)


def estimate(result, queries, claim, lines):
    ask, rule, line = queries[0]["ask"]["estimate"], result["method"], lines[0]
    measure = Measure(ask["measure"])
    if measure.kind == "probability":
        readings = measure.readings(line)
        # The estimate of two readings does not say what each of them is.
        known = result["estimate"] if len(readings) == 1 else None
        stops, interval = gbas(rule, known) if rule["name"] == "gbas" else ESTIMATES[rule["name"]](rule)
        found = [until(lambda s, f, _: stops(s, f), reading) for reading in readings]
        stopped(result, found)
        low, high = hull(interval(s, f) if is_over else at_all_times(s, f, rule["delta"]) for s, f, is_over in found)
    elif measure.kind == "mean":
        low, high = bounded(line, *map(measure.to, mean(rule, measure.readings(line), measure.scale)))
    elif measure.kind == "tail":
        low, high = map(measure.to, measure.interval(line, rule["delta"], result))
    elif measure.kind == "quantile":
        low, high = bounded(line, *quantile(rule, ask["measure"]["level"], line["values"]))
    else:
        low, high = curve(rule, ask["measure"], line["values"])
    follows(claim, ended(result, low, high), rule["delta"])


def compare(result, queries, claim, lines):
    ask, rule = queries[0]["ask"]["compare"], result["method"]
    measure = Measure(ask["first"])
    if measure.kind == "tail":
        sides = [measure.interval(line, 0.5 * ask["delta"], result[side]) for line, side in zip(lines, ("first", "second"))]
        low, high = (measure.scale * (sides[0][k] - sides[1][1 - k]) for k in (0, 1))
    else:
        # Unresolved trials are read against the first and for the second, and the other way round.
        first, second = (measure.readings(line) for line in lines)
        pairs = [[a - b for a, b in zip(first[k], second[-1 - k])] for k in ((0, -1) if len(first) + len(second) > 2 else (0,))]
        if measure.kind == "probability":
            counts = [[pair.count(d) for d in (1, 0, -1)] for pair in (pairs[0], pairs[-1])]
            low, high = difference(counts[0], ask["delta"]), -difference(counts[1][::-1], ask["delta"])
        else:
            found = mean(rule, [[0.5 * (d + 1) for d in pair] for pair in pairs], 2 * measure.scale)
            low, high = (min(max(2 * x - 1, -1), 1) * measure.scale for x in found)
    follows(claim, ended(result, low, high), ask["delta"])


# Rankings.


class Aim:
    """A number of all options: which of them are shown to be no more than a gap better than others."""

    def __init__(self, of, epsilon, threshold, error, lines):
        self.measure, self.threshold, self.error, self.lines = Measure(of), threshold, error, lines
        self.epsilon, self.known = epsilon / self.measure.scale, {}
        self.readings = {option: self.measure.readings(line) for option, line in lines.items()}

    def interval(self, option):
        if option not in self.known:
            self.known[option] = self.measure.interval(self.lines[option], self.error)
        return self.known[option]

    def shows(self, rival, leader, gap):
        """Bets on the difference of pairs, after any number of them; where the rival has no more trials they are taken to hold."""
        if self.measure.kind == "tail":
            return self.interval(rival)[1] <= self.interval(leader)[0] + gap + 2e-6  # the precision of ends
        own, other = self.readings[leader][0], self.readings[rival][-1]
        least = max(self.epsilon, 0.25)
        part = (1 - least) / max(1 - gap, 1e-6) if gap > least else 1.0
        changes, common = collections.Counter(), min(len(own), len(other))
        for n, (a, b) in enumerate(itertools.zip_longest(own, other[: len(own)], fillvalue=1.0), 1):
            changes[part * (gap - b + a)] += 1
            if (n % 32 == 0 or n in (common, len(own))) and mixed(capitals(changes, RACE)) >= self.threshold - 1e-6:
                return True
        return False


def rank(result, queries, claim, lines):
    """The choice is within the gap of every option that may be better, and satisfies all constraints; or the front."""
    ask, rule = queries[0]["ask"]["rank"], result["method"]
    width, delta, measure, table = 1 + len(ask["beside"]), rule["delta"], Measure(ask["measure"]), {}
    for k in range(0, len(lines), width):
        table.setdefault(lines[k]["option"], []).append(lines[k : k + width])
    require([line["option"] for line in lines] == [one["label"] for one in ask["options"] for _ in range(width)], "these are other options")
    options, found = [*table], claim["claim"]
    ((form, told),) = found.items() if isinstance(found, dict) else [(found, None)]
    require(claim["error"] >= delta - 1e-12, f"the error is {delta}, not {claim['error']}")
    if rule["name"] in ("okamoto", "least_score") or measure.kind == "tail" and not ask["beside"]:
        ends = {option: joint(result, rule, measure, option, [line for line, *_ in table[option]], len(lines)) for option in options}
        gap = max([ends[option][1] for option in options if option != told["choice"]], default=0.0) - ends[told["choice"]][0]
        gap = measure.scale * max(gap, rule["epsilon"] if rule["name"] == "okamoto" else 0.0)
        require(told["gap"] >= gap - 1e-6 * measure.scale, f"`{told['choice']}` is within {gap} of the best, not {told['gap']}")
        return
    aims = [(ask["measure"], rule["epsilon"]), *((one, one["role"]["aim"]["epsilon"]) for one in ask["beside"] if "aim" in one["role"])]
    bounds = [(k, one, one["role"]["constraint"]) for k, one in enumerate(ask["beside"], 1) if "constraint" in one["role"]]
    tails, k = sum(Measure(of).kind == "tail" for of, _ in aims), len(options)
    # Constraints have half of the error, and so have the intervals of tails on a front; bets have the rest.
    own = 0.5 * delta if bounds or tails else delta
    misleading = k - 1 if form != "Front" else k * (k - 1) * len(aims)
    threshold = math.log(max(misleading, 1) / own)
    columns = lambda at: {option: table[option][0][at] for option in options}
    aims = [Aim(of, epsilon, threshold, own / k / max(tails, 1), columns(at)) for at, (of, epsilon) in enumerate(aims)]
    fits = {option: True for option in options}
    for option in options:
        for at, of, bound in bounds:
            side, error = Measure(of), own / (k * len(bounds))
            # An interval of a number has half of its error on either side, and only one side can mislead.
            holds = side.holds(bound, table[option][0][at], error if side.kind == "probability" else 2 * error, rule["word"])
            fits[option] = False if holds is False or fits[option] is False else fits[option] and holds
    if form == "Nothing":
        require(not any(fit is not False for fit in fits.values()), "an option may satisfy the constraints")
    elif form == "Best":
        choice, gap, aim = told["choice"], told["gap"] / measure.scale, aims[0]
        require(fits[choice], f"`{choice}` may violate a constraint")
        for rival in options:
            is_worse = lambda: any(fits[other] and aim.shows(rival, other, 0.0) for other in options if other != rival)
            close = rival == choice or fits[rival] is False or aim.shows(rival, choice, gap) or is_worse()
            require(close, f"`{rival}` may be better than `{choice}` by more than {told['gap']}")
    else:
        matched = lambda one, other: all(aim.shows(one, other, aim.epsilon) for aim in aims)
        kept = lambda one, other: any(aim.shows(other, one, 0.0) for aim in aims) or matched(other, one)
        for option in options:
            others = [other for other in told["options"] if other != option]
            if option in told["options"]:
                require(all(kept(option, other) for other in others), f"`{option}` may be dominated")
            else:
                require(any(matched(option, other) for other in others), f"`{option}` may exceed all of the front")


def joint(result, rule, measure, option, lines, columns):
    """The interval of the least score of an option under several models; those of all columns hold at once."""
    size = math.ceil(2 * math.log(2 * columns / rule["delta"]) / rule["epsilon"] ** 2)
    if rule["name"] == "okamoto" and all(line["count"] >= size for line in lines):
        shares = [sum(reading) / len(reading) for reading in measure.readings(lines[0])]
        return min(shares) - 0.5 * rule["epsilon"], max(shares) + 0.5 * rule["epsilon"]
    told = next(one for one in result["options"] if one["option"] == option)
    told = told.get("under") or [told]
    ends = [measure.interval(line, rule["delta"] / columns, one) for line, one in zip(lines, told, strict=True)]
    return min(low for low, _ in ends), min(high for _, high in ends)


def splitting(result, queries, claim, lines, runs):
    """Estimates of independent runs are unbiased, so bets on them certify a lower bound, and plain trials certify an upper one.
    Student's interval of the runs is asymptotic: it is computed again, and certifies nothing."""
    ask, told, line = queries[0]["ask"]["estimate"], result["splitting"], lines[0]
    replicas, number, planned, delta, _ = ask["estimator"]["values"]
    n, s, lost = line["count"], sum(line["truths"]), len(line["unresolved"])
    interval, one_sided = (clopper_pearson, 2 * delta) if n == planned else (at_all_times, delta)
    plain, above, floor = hull(interval(k, n - k, 0.01) for k in (s, s + lost)), interval(s + lost, n - s - lost, one_sided)[1], 0.0
    is_adaptive, columns, found = ask["estimator"]["name"] == "splitting", [ask["measure"]["target"]["column"], ask["level"]], []
    for reading in (False, True):
        rule = lambda run: [run["columns"], run["rule"]["adaptive"], run["rule"]["replicas"], run["rule"]["delta"], run["lost_reaches"]]
        wanted = [columns, is_adaptive, replicas, delta, reading]
        own = [record for run, record in runs if rule(run) == wanted and 1 <= run["branch"] <= number]
        for record in own if is_adaptive else []:
            # The product of the shares that survive is largest if all are alike; paths beyond the first replace those that do not.
            splits = max(len(record["levels"]), 1)
            most = max(1 - (record["paths"] / replicas - 1) / splits, 0) ** splits
            require(record["estimate"] <= most + SLACK, f"no run of {record['paths']} paths estimates {record['estimate']}")
        if len(own) == number and (not reading or any(record["lost"] for _, record in runs)):
            z = [record["estimate"] for record in own]
            center, x = sum(z) / number, bisected(0.0, 1.0, lambda x: ln_tails(0.5 * number - 0.5, 0.5, x)[0] < math.log(delta))[0]
            spread = math.sqrt(sum((y - center) ** 2 for y in z) / number / (number - 1))
            half = math.sqrt((number - 1) * (1 - x) / x) * spread
            capital = lambda m: mixed(capitals(collections.Counter(y / m - 1 for y in z), [0.1, 0.3, 0.6, 0.9]))
            floor = floor if reading else bisected(0.0, max(z), lambda m: capital(m) >= -math.log(delta))[0]
            found.append((center, max(center - half, 0.0), center + half))
    if found:
        means, lows, highs = zip(*found)
        wanted = {"estimate": sum(means) / len(means), "low": min(lows), "high": max(highs), "floor": floor}
        for name, value in wanted.items():
            near(value, told[name], f"`{name}` of the runs")
        above = plain[1] if any(above < mean <= plain[1] for mean in means) else above
    is_clear = floor <= above
    low, high = floor if is_clear else 0.0, above if is_clear and n else 1.0
    follows(claim, {"Between": (low, high)}, ((low > 0) + (high < 1)) * delta)
    return " (the interval of the runs is not certified: asymptotic)"


# The file.


def unpacked(line):
    """The outcomes of a line as truth values, or as numbers."""
    count, truths = line["count"], []
    if not 0 <= count <= MOST:
        raise Unreadable(f"{count} outcomes are more than are read")
    if "runs" in line:
        for k, length in enumerate(line["runs"] if sum(line["runs"]) == count else []):
            truths += [k % 2 == 1] * length
    elif "bits" in line:
        data = base64.b64decode(line["bits"], validate=True)
        truths = [data[k // 8] >> k % 8 & 1 == 1 for k in range(count)] if len(data) == -(-count // 8) else []
    else:
        line["values"] = [float(v) if isinstance(v, str) else v for v in line["values"]]
    lost = line["unresolved"]
    if len(line.get("values", truths)) != count or lost != sorted({*lost}) or lost and not 0 <= lost[0] <= lost[-1] < count:
        raise Unreadable("outcomes and their count differ")
    return {**line, "truths": truths}


def counted(told, lines, is_share=True):
    """That trials, successes and failures are those of the outcomes, and that the estimate is their share."""
    count, lost = sum(line["count"] for line in lines), sum(len(line["unresolved"]) for line in lines)
    require(count == told["trials"], f"{count} outcomes for {told['trials']} trials")
    held = sum(sum(line["truths"]) - sum(line["truths"][k] for k in line["unresolved"] if line["truths"]) for line in lines)
    failed = sum(len(line["truths"]) for line in lines)
    failed = failed and failed - held - lost
    found = lost, held, failed
    said = told["unresolved"], told["successes"], told["failures"]
    require(found == said, f"of the outcomes {held} hold, {failed} fail, and {lost} are unresolved")
    if held + failed and is_share:
        near((held + 0.5 * lost) / count, told["estimate"], "the estimate", 1e-9)


def fits(result, word, ask, lines):
    """That numbers of a result are those that were asked for, and of its outcomes."""
    measure, rule = ask.get("measure") or ask["first"], result["method"]
    low, high = measure.get("range", (None, None))
    for name, value in {"theta": ask.get("threshold"), "level": measure.get("level"), "low": low, "high": high}.items():
        if name in rule and value is not None:
            near(value, rule[name], f"`{name}`")
    if word == "compare":
        counted(result["first"], lines[:1])
        counted(result["second"], lines[1:])
    scores = lines[:: 1 + len(ask.get("beside", []))] if word == "rank" else lines
    for option in result.get("options", []):
        counted(option, [line for line in scores if line["option"] == option["option"]], ask["models"] == 1)
    counted(result, scores, word in ("check", "estimate") and rule["name"] != "gbas" and "splitting" not in result)


def verified(entry, lines, runs=()):
    """Checks a result; returns a remark."""
    result, claim, queries = entry["result"], entry["claim"], entry["queries"]
    ((word, ask),) = queries[0]["ask"].items()
    if len(queries) == 1:
        fits(result, word, ask, lines)
    if "splitting" in result:
        return splitting(result, queries, claim, lines, runs)
    chosen = next((ask[role]["values"] for role in ("test", "estimator", "ranking") if role in ask), [])
    numbers = [x for x in result["method"].values() if not isinstance(x, str)]
    is_known = lambda x: any(abs(x - y) <= 1e-9 * max(abs(x), 1) for y in numbers)
    require(all(map(is_known, chosen)), f"the rule has the numbers {numbers}, and {chosen} were asked for")
    if word != "rank" or claim:
        {"check": checks, "estimate": estimate, "compare": compare, "rank": rank}[word](result, queries, claim, lines)
    return ""


def read(path):
    """The head of a certificate, and its results with their outcomes and runs of splitting."""
    with open(path, "rb") as file:
        data = file.read()
    *lines, last = data.splitlines(keepends=True) or [b""]
    try:
        told = json.loads(last)["digest"]
    except (ValueError, KeyError, TypeError):
        raise Unreadable("the last line has no digest: the file is cut short, or is no certificate") from None
    if told != "sha256:" + hashlib.sha256(b"".join(lines)).hexdigest():
        raise Unreadable("the digest does not match: the file was changed")
    head, *parsed = [json.loads(line) for line in lines] or [{}]
    if head.get("smc") != FORMAT:
        raise Unreadable(f"this is not `{FORMAT}`")
    entries = []
    for line in parsed:
        if "result" in line:
            entries.append(({name: line[name] for name in ("result", "claim", "queries")}, [], []))
        elif "count" in line:
            entries[-1][1].append(line)
        else:
            entries[-1][2].extend(line["runs_of_splitting"])
    return head, entries


def main(path, *files, **options):
    try:
        head, entries = read(path)
    except (OSError, ValueError, LookupError, TypeError, AttributeError, Unreadable) as error:
        print(f"{path}: {error}", file=sys.stderr)
        return 2
    print(f"{head['scenario']}, seed {head['seed']}, version {head['version']}")
    for file, digest in head["inputs"]:
        print(f"  {file} {digest}")
    words = []
    for entry, lines, runs in entries:
        result, claim = entry["result"], entry["claim"]
        try:
            words.append("right")
            lines[:] = map(unpacked, lines)
            said = verified(entry, lines, runs)
        except Unchecked as error:
            words[-1:], said = ["not checked"], f": {error}"
        except (Refused, Unreadable, KeyError, ValueError, IndexError, TypeError, ArithmeticError, AttributeError, StopIteration) as error:
            words[-1:], said = ["refused"], f": {error}" if isinstance(error, (Refused, Unreadable)) else f": {error!r}"
        told = json.dumps(claim and claim["claim"], ensure_ascii=False).translate(str.maketrans("", "", '{}"'))
        print(f"{words[-1] + said:<12} {result['query']}: {told + ', error at most %g' % claim['error'] if claim else 'nothing'}")
    code = 1 if "refused" in words else 3 if "not checked" in words else 0
    if options.get("program"):
        import audit

        code = audit.audited(head, entries, files, options) or code
    return code


def called():
    """The words of the command line."""
    words = argparse.ArgumentParser(description="Checks a certificate of smc.")
    words.add_argument("certificate")
    words.add_argument("files", nargs="*", help="the scenario and the property files, for an audit")
    words.add_argument("--program", help="the program that runs trials again")
    words.add_argument("--audit", type=int, default=300, help="how many outcomes are run again")
    words.add_argument("--audit-seed", type=int, dest="seed")
    words.add_argument("--data", action="append", default=[], help="a folder of recordings, for the program")
    told = words.parse_intermixed_args()
    if bool(told.program) != bool(told.files):
        words.error("an audit needs the scenario, and `--program`")
    extra = [part for folder in told.data for part in ("--data", folder)]
    return main(told.certificate, *told.files, program=told.program, audit=told.audit, seed=told.seed, extra=extra)


if __name__ == "__main__":
    sys.exit(called())
