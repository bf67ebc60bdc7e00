"""Checks a certificate of smc: `python3 tools/verify.py out.smcc`. Needs nothing but Python, and shares no code with the program.

The digest of the lines is compared first. Then every decision, stop and interval is computed again from the outcomes, by the rules
of docs/proofs.md. Exit code 0: all of them are right; 1: something is refused; 2: this is no certificate that can be read; 3: nothing
is wrong, but some result follows a rule that is not checked here.
"""

import base64
import hashlib
import json
import math
import sys

FORMAT = "certificate 1"
SLACK = 1e-9  # of thresholds in logarithms
MOST = 10**8  # outcomes of one line
INF = math.inf


class Refused(Exception):
    """A claim does not follow from the outcomes."""


class Unreadable(Exception):
    """The file is no certificate, or a damaged one."""


# Special functions: the incomplete beta function by its continued fraction (Lentz), quantiles by bisection.


def ln_beta(a, b):
    return math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)


def fraction(a, b, x):
    c, d = 1.0, 1.0 - (a + b) * x / (a + 1)
    d = 1.0 / (d if abs(d) > 1e-300 else 1e-300)
    value = d
    for m in range(1, 100_000):
        for top in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)), -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d, c = 1.0 + top * d, 1.0 + top / c
            d = 1.0 / (d if abs(d) > 1e-300 else 1e-300)
            c = c if abs(c) > 1e-300 else 1e-300
            value *= c * d
        if abs(c * d - 1.0) < 1e-15:
            break
    return value


def ln_tails(a, b, x):
    """Logarithms of P(X <= x) and P(X > x) for X of the law Beta(a, b)."""
    if x <= 0.0 or x >= 1.0:
        return (-INF, 0.0) if x <= 0.0 else (0.0, -INF)
    front = a * math.log(x) + b * math.log1p(-x) - ln_beta(a, b)
    if x < (a + 1) / (a + b + 2):
        lower = front - math.log(a) + math.log(fraction(a, b, x))
        return lower, math.log1p(-math.exp(min(lower, -1e-300)))
    upper = front - math.log(b) + math.log(fraction(b, a, 1.0 - x))
    return math.log1p(-math.exp(min(upper, -1e-300))), upper


def bisected(low, high, is_below):
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if is_below(middle) else (low, middle)
    return low, high


def clopper_pearson(s, f, error):
    """Clopper and Pearson 1934: half of the error on either side."""
    tail = math.log(0.5 * error)
    low = 0.0 if s == 0 else bisected(0.0, 1.0, lambda p: ln_tails(s, f + 1, p)[0] < tail)[0]
    high = 1.0 if f == 0 else bisected(0.0, 1.0, lambda p: ln_tails(s + 1, f, p)[1] > tail)[1]
    return low, high


def is_narrow(s, f, error, width):
    low, high = clopper_pearson(s, f, error) if s <= f else clopper_pearson(f, s, error)
    return high - low <= width


def smallest(low, holds):
    """The smallest whole number from `low` on that holds, of those after which all hold."""
    step = 1
    while not holds(low + step):
        step *= 2
    high = low + step
    low -= 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


# Tests of a probability: each reads outcomes one by one and says `above`, `below`, `within` or nothing.


class OneSided:
    """A mixture of priors above theta against P <= theta (Robbins 1970); it rises with successes."""

    def __init__(self, theta, error):
        weight = 100 if 0.01 <= theta <= 0.99 else 10
        self.theta, self.a, self.b = theta, max(weight * theta, 0.5), max(weight * (1 - theta), 0.5)
        self.prior = ln_beta(self.a, self.b) + ln_tails(self.a, self.b, theta)[1]
        self.threshold, self.wanted = SLACK - math.log(error), 0

    def log(self, s, f):
        a, b = self.a + s, self.b + f
        mass = ln_beta(a, b) + ln_tails(a, b, self.theta)[1]
        return mass - self.prior - s * math.log(self.theta) - f * math.log1p(-self.theta)

    def reached(self, s, f):
        # More failures never make fewer successes enough.
        if s < self.wanted:
            return False
        if self.log(s, f) >= self.threshold:
            return True
        self.wanted = smallest(s, lambda more: self.log(more, f) >= self.threshold)
        return False


def eprocess(rule, ask):
    above, below = OneSided(ask["theta"], rule["beta"]), OneSided(1 - ask["theta"], rule["alpha"])
    return lambda s, f, success: "above" if success and above.reached(s, f) else "below" if not success and below.reached(f, s) else None


def three_way(rule, ask):
    theta, half = ask["theta"], 0.5 * rule["alpha"]
    low, high = theta - rule["indifference"], theta + rule["indifference"]
    above, below = OneSided(theta, half), OneSided(1 - theta, half)
    over_low, under_high, passed = OneSided(low, half), OneSided(1 - high, half), [False, False]

    def look(s, f, success):
        if success:
            passed[0] = passed[0] or over_low.reached(s, f)
            found = "above" if above.reached(s, f) else None
        else:
            passed[1] = passed[1] or under_high.reached(f, s)
            found = "below" if below.reached(f, s) else None
        return found or ("within" if all(passed) else None)

    return look


def sprt(rule, ask):
    """Wald 1945, at the thresholds 1/alpha and beta."""
    low, high = ask["theta"] - rule["indifference"], ask["theta"] + rule["indifference"]
    win, lose = math.log(low / high), math.log((1 - low) / (1 - high))
    say_below, say_above = SLACK - math.log(rule["alpha"]), math.log(rule["beta"]) - SLACK

    def look(s, f, _):
        ratio = s * win + f * lose
        return "below" if ratio >= say_below else "above" if ratio <= say_above else None

    return look


def sprt2(rule, ask):
    """Lorden 1976: theta against each end of the region."""
    theta, low, high = ask["theta"], ask["theta"] - rule["indifference"], ask["theta"] + rule["indifference"]

    def look(s, f, _):
        over = [s * math.log(theta / end) + f * math.log((1 - theta) / (1 - end)) for end in (low, high)]
        if over[1] >= SLACK - math.log(rule["alpha"]):
            return "below"
        return "above" if over[0] >= SLACK - math.log(rule["beta"]) else None

    return look


def plan(rule, ask):
    """A fixed size and a number of successes that accepts: both errors are binomial tails."""
    size, accept = rule["trials"], rule["accept"]
    low, high = ask["theta"] - rule["indifference"], ask["theta"] + rule["indifference"]
    rejects, accepts = ln_tails(accept, size - accept + 1, high)[1], ln_tails(accept, size - accept + 1, low)[0]
    if rejects > math.log(rule["alpha"]) + SLACK or accepts > math.log(rule["beta"]) + SLACK:
        raise Refused(f"{accept} of {size} do not keep the errors")
    return lambda s, f, _: "above" if s >= accept else "below" if f > size - accept else None


TESTS = {"eprocess": eprocess, "three_way": three_way, "sprt": sprt, "sprt2": sprt2, "plan": plan}


def claim_of(rule, ask, decision):
    """What a decision of a test claims, and with which error."""
    theta, error = ask["theta"], rule["beta" if decision == "above" else "alpha"] if "beta" in rule else rule["alpha"]
    if decision == "within":
        return {"Between": [theta - rule["indifference"], theta + rule["indifference"]]}, error
    if "indifference" in rule and rule["name"] != "three_way":
        return ({"Above": theta - rule["indifference"]} if decision == "above" else {"Below": theta + rule["indifference"]}), error
    # `>=` and `<` put the threshold above, `>` and `<=` below.
    names = ("AtLeast", "Below") if ask["at_least"] == ask["or_equal"] else ("Above", "AtMost")
    return {names[decision == "below"]: theta}, error


# Intervals.


def held_at_all_times(s, f, error, p):
    """Whether a probability is in the confidence sequence of Krichevsky and Trofimov: the evidence against it is below 1/error."""
    if p <= 0 and s or p >= 1 and f:
        return False
    mixture = ln_beta(s + 0.5, f + 0.5) - ln_beta(0.5, 0.5)
    return -(s * math.log(p) if s else 0.0) - (f * math.log1p(-p) if f else 0.0) < -math.log(error) - mixture + 1e-12


def at_all_times(s, f, error):
    """Its ends."""
    share = s / (s + f) if s + f else 0.5
    low = 0.0 if s == 0 else bisected(0.0, share, lambda p: not held_at_all_times(s, f, error, p))[0]
    high = 1.0 if f == 0 else bisected(share, 1.0, lambda p: held_at_all_times(s, f, error, p))[1]
    return low, high


def okamoto(rule):
    size = math.ceil(math.log(2 / rule["delta"]) / (2 * rule["epsilon"] ** 2))
    return lambda s, f: s + f >= size, lambda s, f: (max(s / (s + f) - rule["epsilon"], 0), min(s / (s + f) + rule["epsilon"], 1))


def fixed(rule):
    return lambda s, f: s + f >= rule["trials"], lambda s, f: clopper_pearson(s, f, rule["delta"])


def calibrated(rule):
    """Stops when the interval at the level gamma is narrow. Nothing is narrower than with all further outcomes on one side."""
    gamma, width, ahead = rule["gamma"], 2 * rule["epsilon"], [0]

    def stops(s, f):
        if s + f < ahead[0]:
            return False
        if is_narrow(s, f, gamma, width):
            return True
        grow = [lambda k: is_narrow(s + k, f, gamma, width), lambda k: is_narrow(s, f + k, gamma, width)]
        ahead[0] = s + f + min(smallest(0, one) for one in grow)
        return False

    return stops, lambda s, f: clopper_pearson(s, f, gamma)


def spending(rule):
    """A union bound over looks, each half as many trials later than the one before."""

    def schedule(level):
        first = math.ceil(math.log(0.5 * level) / math.log1p(-2 * rule["epsilon"])) if rule["epsilon"] < 0.5 else 1
        last = smallest(1, lambda n: is_narrow(n // 2, n - n // 2, level, 2 * rule["epsilon"]))
        looks, n = [], max(first, 1)
        while math.ceil(n) < last:
            looks.append(math.ceil(n))
            n *= 1.5
        return looks + [last]

    number = rule["looks"]
    level = rule["delta"] / number
    looks = schedule(level)

    def stops(s, f):
        return s + f >= looks[-1] or s + f in looks and is_narrow(s, f, level, 2 * rule["epsilon"])

    return stops, lambda s, f: clopper_pearson(s, f, level)


def massart(rule):
    """Jegourel, Sun and Dong 2017: the bound of Massart, at the end of a running interval that is nearest to one half."""
    epsilon, share = rule["epsilon"], rule["auxiliary"]
    limit = math.ceil(math.log(2 / rule["delta"]) / (2 * epsilon**2))

    def stops(s, f):
        low, high = clopper_pearson(s, f, share)
        p = high if high < 0.5 else 1 - low if low > 0.5 else None
        spread = (1.5 + epsilon) ** 2 if p is None else (3 * p + epsilon) * (3 * (1 - p) - epsilon)
        return s + f >= min(limit, 2 / (9 * epsilon**2) * math.log(2 / (rule["delta"] - share)) * spread)

    return stops, lambda s, f: (max(s / (s + f) - epsilon, 0), min(s / (s + f) + epsilon, 1))


ESTIMATES = {"okamoto": okamoto, "clopper_pearson": fixed, "calibrated": calibrated, "spending": spending, "massart": massart}


# Results.


def near(a, b, what, slack=1e-7):
    """That a number of the file is the one that was computed."""
    if a is None or b is None or not (a == b or abs(a - b) <= slack * max(1.0, abs(a), abs(b))):
        raise Refused(f"{what} is {b}, not {a}")


def until(look, truths):
    """The first trial after which a rule stops, and what it says; the end of the outcomes and nothing where it does not."""
    s = f = 0
    for truth in truths:
        s, f = s + truth, f + (not truth)
        found = look(s, f, truth)
        if found:
            return s, f, found
    return s, f, None


def cases(outcomes):
    """Unresolved trials read as false, and read as true."""
    truths, lost = outcomes["truths"], set(outcomes["unresolved"])
    return [[t or (is_true and k in lost) for k, t in enumerate(truths)] for is_true in ((False, True) if lost else (False,))]


def check(result, ask, claim, outcomes):
    rule = result["method"]
    found = [until(TESTS[rule["name"]](rule, ask), case) for case in cases(outcomes)]
    decisions = {one[2] for one in found}
    if result["trials"] != max(s + f for s, f, _ in found):
        raise Refused(f"the rule stops after {max(s + f for s, f, _ in found)} trials, not {result['trials']}")
    decision = decisions.pop() if len(decisions) == 1 else None
    verdict = {None: "undecided", "within": "undecided"}.get(decision) or ("satisfied" if (decision == "above") == ask["at_least"] else "violated")
    if decision and result["verdict"] != verdict or not decision and result["verdict"] in ("satisfied", "violated"):
        raise Refused(f"the outcomes say {verdict}, not {result['verdict']}")
    if decision:
        wanted, error = claim_of(rule, ask, decision)
        told = (claim or {}).get("claim", {}).get("Decided", {})
        if list(told) != list(wanted) or not near_all(told, wanted) or claim["error"] < error - 1e-12:
            raise Refused(f"the claim is {claim}, not {wanted} with error {error}")
        ends = [at_all_times(s, f, ask["beside"]) for s, f, _ in (until(lambda *_: None, case) for case in cases(outcomes))]
        near(min(low for low, _ in ends), result["low"], "the lower end", 1e-6)
        near(max(high for _, high in ends), result["high"], "the upper end", 1e-6)


def near_all(told, wanted):
    flat = [x if isinstance(x, list) else [x] for x in (*told.values(), *wanted.values())]
    return all(abs(a - b) < 1e-12 for a, b in zip(flat[0], flat[1]))


def estimate(result, ask, claim, outcomes):
    rule = result["method"]
    ends = []
    for case in cases(outcomes):
        stops, interval = ESTIMATES[rule["name"]](rule)
        s, f, found = until(lambda s, f, _: stops(s, f), case)
        ends.append((s + f, found, interval(s, f) if found else at_all_times(s, f, rule["delta"])))
    if result["trials"] != max(n for n, *_ in ends):
        raise Refused(f"the rule stops after {max(n for n, *_ in ends)} trials, not {result['trials']}")
    low, high = min(one[2][0] for one in ends), max(one[2][1] for one in ends)
    bounded(result, claim, low, high, rule["delta"])


class Sequence:
    """The empirical Bernstein confidence sequence of Waudby-Smith and Ramdas 2024, of values in [0, 1]."""

    def __init__(self, error, aim):
        self.log, self.aim, self.n = math.log(2 / error), aim, 0
        self.sum = self.squares = self.bets = self.weighted = self.variance = 0.0

    def push(self, x):
        t = self.n + 1.0
        mean, spread = (0.5 + self.sum) / t, (0.25 + self.squares) / t
        bet = min(math.sqrt(2 * self.log / (spread * (self.aim or t * math.log(1 + t)))), 0.5)
        self.n, self.sum = self.n + 1, self.sum + x
        self.squares += (x - (0.5 + self.sum) / (t + 1)) ** 2
        self.bets, self.weighted = self.bets + bet, self.weighted + bet * x
        self.variance += (x - mean) ** 2 * (-math.log1p(-bet) - bet)

    def ends(self, size, cap, reach):
        """Lower and upper end; at the size that is fixed beforehand Hoeffding's interval holds as well."""
        centre, radius = (self.weighted / self.bets, (self.log + self.variance) / self.bets) if self.n else (0.5, 0.5)
        low, high, mean = centre - radius, centre + radius, self.sum / max(self.n, 1)
        if size and self.n >= size:
            hoeffding = reach or math.sqrt(math.log(2 / cap) / (2 * self.n))
            low, high = (mean - reach, mean + reach) if reach else (max(low, mean - hoeffding), min(high, mean + hoeffding))
        return low, high


def mean(rule, pairs, span):
    """The interval of a mean of values in a range, each given as its least and its largest possible value; and when it stops."""
    low, high = span
    planned = rule["epsilon"] / (high - low) if rule["name"] == "okamoto" else None
    epsilon = rule.get("epsilon") if not planned else None
    cap = 0.0 if planned or not ("trials" in rule or epsilon) else 0.2 * rule["delta"]
    size = math.ceil(math.log(2 / cap) / (2 * (epsilon / (high - low)) ** 2)) if epsilon else rule.get("trials")
    aim = size if not epsilon else None
    ends = [Sequence(rule["delta"] - cap, aim) for _ in range(2)]
    stopped = None
    for n, pair in enumerate(pairs, 1):
        for end, value in zip(ends, pair):
            end.push((min(max(value, low), high) - low) / (high - low))
        if epsilon and stopped is None:
            (a, b), (c, d) = (end.ends(None, cap, None) for end in ends)
            half, apart = 0.5 * (max(b, d) - min(a, c)), (ends[1].sum - ends[0].sum) / n
            part = epsilon / (high - low)
            if half <= part or b - a <= 2 * part and d - c <= 2 * part and apart > part:
                stopped = n
    found = [end.ends(size, cap, planned) for end in ends]
    to = lambda x: low if x <= 0 else high if x >= 1 else low + (high - low) * x
    return to(min(a for a, _ in found)), to(max(b for _, b in found)), min(x for x in (stopped, size, INF) if x is not None)


def expectation(result, ask, claim, outcomes):
    span = ask["estimate"]["range"]
    low, high, size = mean(result["method"], [(span if v is None else (v, v)) for v in outcomes["values"]], span)
    bounded(result, claim, low, high, result["method"]["delta"])
    if min(size, len(outcomes["values"])) != result["trials"]:
        raise Refused(f"the rule stops after {size} trials, not {result['trials']}")


def bounded(result, claim, low, high, error):
    near(low, result["low"] if result["low"] is not None else -INF, "the lower end")
    near(high, result["high"] if result["high"] is not None else INF, "the upper end")
    told = (claim or {}).get("claim", {}).get("Between")
    if told:
        least, most = (-INF if told["low"] is None else told["low"]), (INF if told["high"] is None else told["high"])
        if least > low + 1e-7 * max(1, abs(low)) or most < high - 1e-7 * max(1, abs(high)) or claim["error"] < error - 1e-12:
            raise Refused(f"the claim is {claim}, not [{low}, {high}] with error {error}")


def under_every(result, queries, claim, lines):
    """A check under every value of a parameter: each is a check of its own, and all errors add up."""
    verdicts, error = [], 0.0
    for query, line, part in zip(queries, lines, result["every"]["values"], strict=True):
        _, _, ask = asked(query)
        rule = result["method"]
        found = {until(TESTS[rule["name"]](rule, ask), case) for case in cases(line)}
        if part["trials"] != max(s + f for s, f, _ in found):
            raise Refused(f"the rule stops after {max(s + f for s, f, _ in found)} trials, not {part['trials']}")
        decisions = {one[2] for one in found}
        decision = decisions.pop() if len(decisions) == 1 else None
        verdicts.append("undecided" if decision in (None, "within") else "satisfied" if (decision == "above") == ask["at_least"] else "violated")
        error += max(rule["alpha"], rule.get("beta", 0.0))
    verdict = "violated" if "violated" in verdicts else "satisfied" if set(verdicts) == {"satisfied"} else "undecided"
    if result["verdict"] != verdict or [part["verdict"] for part in result["every"]["values"]] != verdicts:
        raise Refused(f"the outcomes say {verdict}: {', '.join(verdicts)}")
    if verdict == "satisfied" and claim["error"] < error - 1e-12:
        raise Refused(f"the error is {error}, not {claim['error']}")


def curve(result, ask, claim, outcomes):
    """A band around a distribution function (Dvoretzky, Kiefer and Wolfowitz; Massart 1990), here at its last bound."""
    values, rule, last = outcomes["values"], result["method"], ask["estimate"]["times"][-1]
    n, radius = len(values), math.sqrt(math.log(2 / rule["delta"]) / (2 * len(values)))
    if n != rule["trials"]:
        raise Refused(f"{n} trials of {rule['trials']}")
    low = sum(v is not None and v <= last for v in values) / n
    high = low + values.count(None) / n
    bounded(result, claim, max(low - radius, 0.0), min(high + radius, 1.0), rule["delta"])


def check_mean(result, ask, claim, outcomes):
    """The sequence holds at all times, so the test stops once it lies on one side of the threshold."""
    rule, theta, span = result["method"], ask["theta"], ask["check"]["range"]
    (low, high), ends, stop = span, [Sequence(rule["delta"], None) for _ in range(2)], None
    for n, value in enumerate(outcomes["values"], 1):
        for end, v in zip(ends, span if value is None else (value, value)):
            end.push((min(max(v, low), high) - low) / (high - low))
        (a, b), (c, d) = (end.ends(None, 0, None) for end in ends)
        a, b = (min(max(low + (high - low) * x, low), high) for x in (min(a, c), max(b, d)))
        if a > theta or b < theta:
            stop = n
            break
    if result["trials"] != (stop or len(outcomes["values"])):
        raise Refused(f"the rule stops after {stop} trials, not {result['trials']}")
    near(a, result["low"], "the lower end")
    near(b, result["high"], "the upper end")
    verdict = "undecided" if not stop else "satisfied" if (a > theta) == ask["at_least"] else "violated"
    if stop and (result["verdict"] != verdict or claim["claim"]["Decided"] != {"Above" if a > theta else "Below": theta} or claim["error"] < rule["delta"] - 1e-12):
        raise Refused(f"the outcomes say {verdict}, at an error of {rule['delta']}")
    if not stop and result["verdict"] in ("satisfied", "violated"):
        raise Refused("the outcomes decide nothing")


def quantile(result, ask, claim, outcomes):
    """Order statistics: ranks from binomial tails; or from the band of Dvoretzky, Kiefer and Wolfowitz (Massart 1990)."""
    rule, q, values = result["method"], ask["estimate"]["level"], outcomes["values"]
    n, known = len(values), sorted(v for v in values if v is not None)
    lost, error = n - len(known), rule["delta"]
    early = n < rule["trials"]
    if rule["name"] != "order_statistics":
        # A budget that ended sampling spends the error over all numbers of trials.
        reach = math.sqrt(math.log(2 * (n * (n + 1) if early else 1) / error) / (2 * n))
        lower, upper = math.floor((q - reach) * n), math.ceil((q + reach) * n)
    elif early:
        is_in = lambda k: held_at_all_times(k, n - k, 0.5 * error, q)
        lower = next((k for k in range(n) if k / n >= q or is_in(k)), n)
        upper = next((k for k in range(n) if (k + 1) / n > q and not is_in(k + 1)), n) + 1
    else:
        tail = math.log(0.5 * error)
        lower = next((k for k in range(n) if ln_tails(k + 1, n - k, q)[1] > tail), n)
        upper = next((k for k in range(n) if ln_tails(k + 1, n - k, q)[0] <= tail), n) + 1
    value = lambda rank, below: -INF if rank <= below else known[rank - below - 1] if rank - below <= len(known) else INF
    least = 0.0 if outcomes.get("time") else -INF
    bounded(result, claim, max(value(lower, lost) if lower >= 1 else -INF, least), value(upper, 0) if upper <= n else INF, error)


def difference(low_pairs, error):
    """Bets on the difference of pairs, which hold at all times (Ville 1939): the lower end, from (first, alike, second)."""
    first, alike, second = low_pairs
    bets = [math.exp(math.log(0.002) + k / 15 * math.log(0.95 / 0.002)) for k in range(16)]
    threshold = math.log(2 / error) + SLACK

    def against(m):
        logs = [first * math.log1p(b / (1 + m) * (1 - m)) + alike * math.log1p(-b / (1 + m) * m) + second * math.log1p(-b) for b in bets]
        return max(logs) + math.log(sum(math.exp(log - max(logs)) for log in logs) / len(logs))

    total = first + alike + second
    return bisected(-1 + 1e-15, (first - second) / total, lambda m: against(m) >= threshold)[0] if total else -1.0


def compare(result, ask, claim, first, second):
    rule, error = result["method"], ask["delta"]
    if "range" in ask["compare"]:
        (low, high), pairs = ask["compare"]["range"], []
        clip = lambda v: (low, high) if v is None else (min(max(v, low), high),) * 2
        for a, b in zip(first["values"], second["values"]):
            (a, b), (c, d) = clip(a), clip(b)
            pairs.append((a - d, b - c))
        found = mean(rule, pairs, (low - high, high - low))[:2]
    else:
        counts = []
        for is_high in (False, True):
            a = cases(first)[-1 if is_high else 0]
            b = cases(second)[0 if is_high else -1]
            counts.append((sum(x and not y for x, y in zip(a, b)), sum(x == y for x, y in zip(a, b)), sum(y and not x for x, y in zip(a, b))))
        (a, b, c), found = counts[1], (difference(counts[0], error), 0)
        found = (found[0], -difference((c, b, a), error))
    bounded(result, claim, *found, error)


def rank_fixed(result, ask, claim, lines):
    """Hoeffding's interval of half of the gap around each option, all at once: the one with the largest share is chosen."""
    rule, told = result["method"], claim["claim"]["Best"]
    size = math.ceil(2 * math.log(2 * len(lines) / rule["delta"]) / rule["epsilon"] ** 2)
    shares = {line["option"]: [sum(case) / max(len(case), 1) for case in cases(line)] for line in lines}
    if any(line["count"] < size for line in lines):
        raise Refused(f"an option has fewer than {size} trials")
    lost = max(case[-1] for case in shares.values()) - shares[told["choice"]][0]
    if told["gap"] < rule["epsilon"] + lost - 1e-9 or claim["error"] < rule["delta"] - 1e-12:
        raise Refused(f"`{told['choice']}` is {lost} from the largest share")


def rank(result, ask, claim, lines):
    """The choice is within the gap of every option: paired bets on each rival, which is taken to hold where it has no trial. Options
    that left the race were worse than another one, on the trials that both had."""
    rule, kind = result["method"], ask["rank"]
    low, high = kind.get("range", (0.0, 1.0))
    scale = lambda v: (0.0, 1.0) if v is None else (min(max((v - low) / (high - low), 0), 1),) * 2
    table = {}
    for line in lines:
        lost = set(line["unresolved"])
        values = line.get("values") or [None if k in lost else float(t) for k, t in enumerate(line["truths"])]
        table[line["option"]] = [scale(v) for v in values]
    told = (claim or {}).get("claim", {}).get("Best")
    if not told:
        raise Refused("a ranking without a choice is not certified") if claim else KeyError("no claim")
    choice, gap = told["choice"], told["gap"] / (high - low)
    threshold = math.log(max(len(table) - 1, 1) / rule["delta"])
    epsilon = rule["epsilon"] / (high - low)
    bets = [math.exp(math.log(0.02) + k / 11 * math.log(0.95 / 0.02)) for k in range(12)]

    def evidence(rival, leader, gap, is_completed):
        least = max(epsilon, 0.25)
        part = (1 - least) / max(1 - gap, 1e-6) if gap > least else 1.0
        own, other = table[leader], table[rival]
        count = len(own) if is_completed else min(len(own), len(other))
        differences = {}
        for k in range(count):
            d = (other[k][1] if k < len(other) else 1.0) - own[k][0]
            differences[d] = differences.get(d, 0) + 1
        logs = [sum(n * math.log(1 + bet * part * (gap - d)) for d, n in differences.items()) for bet in bets]
        return max(logs) + math.log(sum(math.exp(log - max(logs)) for log in logs) / len(logs))

    for rival in table:
        close = rival == choice or any(evidence(rival, choice, gap, whole) >= threshold - 1e-6 for whole in (False, True))
        if not close and not any(evidence(rival, other, 0.0, False) >= threshold - 1e-6 for other in table if other != rival):
            raise Refused(f"`{rival}` may be better than `{choice}` by more than {told['gap']}")
    if claim["error"] < rule["delta"] - 1e-12:
        raise Refused(f"the error is {rule['delta']}, not {claim['error']}")


# The file.


def unpacked(line):
    count = line["count"]
    if not 0 <= count <= MOST:
        raise Unreadable(f"{count} outcomes are more than are read")
    line.setdefault("truths", [])
    if "runs" in line:
        if sum(line["runs"]) != count:
            raise Unreadable("runs and count differ")
        for k, length in enumerate(line["runs"]):
            line["truths"] += [k % 2 == 1] * length
    elif "bits" in line:
        data = base64.b64decode(line["bits"], validate=True)
        if len(data) != -(-count // 8):
            raise Unreadable("bits and count differ")
        line["truths"] = [data[k // 8] >> k % 8 & 1 == 1 for k in range(count)]
    else:
        line["values"] = [float(v) if isinstance(v, str) else v for v in line["values"]]
    if line["unresolved"] and max(line["unresolved"]) >= count:
        raise Unreadable("an unresolved trial is not there")
    return line


def asked(query):
    """What a query asks: check, estimate, compare or rank; of which kind of number, in which range."""
    ((word, ask),) = query["ask"].items()
    measure = ask.get("measure") or ask["first"]
    kind = {"expectation": "mean" if measure.get("level") is None else "tail"}.get(measure["kind"], measure["kind"])
    return word, kind, {**ask, word: measure, "theta": ask.get("threshold")}


def counted(result, word, lines):
    """That trials, successes and failures are those of the outcomes."""
    if word == "rank":
        return
    if sum(line["count"] for line in lines) != result["trials"]:
        raise Refused(f"{sum(line['count'] for line in lines)} outcomes for {result['trials']} trials")
    if word == "compare":
        return
    lost = sum(len(line["unresolved"]) for line in lines)
    held = [sum(t for k, t in enumerate(line["truths"]) if k not in line["unresolved"]) for line in lines]
    found = (lost, sum(held), sum(len(line["truths"]) for line in lines) - sum(held) - lost if lines[0]["truths"] else 0)
    if found != (result["unresolved"], result["successes"], result["failures"]):
        raise Refused(f"of the outcomes {found[1]} hold, {found[2]} fail, {found[0]} are unresolved")
    if sum(held) and not lost and result["method"]["name"] not in ("gbas", "splitting"):
        near(result["estimate"], held[0] / lines[0]["count"], "the estimate", 1e-9)


def verified(entry, lines):
    """Checks a result; whether its rule is one of those that are checked here."""
    result, claim, queries = entry["result"], entry["claim"], entry["queries"]
    (word, kind, ask), name = asked(queries[0]), result["method"]["name"]
    if len(queries) != 1:
        known = word == "check" and kind == "probability" and name in TESTS
        if known:
            under_every(result, queries, claim, lines)
        return known
    if len(queries) == 1:
        counted(result, word, lines)
    chosen = next((ask[role]["values"] for role in ("test", "estimator", "ranking") if role in ask), [])
    numbers = [x for x in result["method"].values() if not isinstance(x, str)]
    if not all(any(abs(x - y) <= 1e-9 * max(abs(x), 1) for y in numbers) for x in chosen):
        raise Refused(f"the rule has the numbers {numbers}, and {chosen} were asked for")
    if word == "check" and kind == "probability" and name in TESTS:
        check(result, ask, claim, lines[0])
    elif word == "check" and kind == "mean":
        check_mean(result, ask, claim, lines[0])
    elif word == "estimate" and kind == "probability" and name in ESTIMATES:
        estimate(result, ask, claim, lines[0])
    elif word == "estimate" and kind == "mean":
        expectation(result, ask, claim, lines[0])
    elif word == "estimate" and kind == "curve" and not ask["estimate"]["falls"]:
        curve(result, ask, claim, lines[0])
    elif word == "rank" and name == "okamoto" and kind == "probability" and not ask["beside"]:
        rank_fixed(result, ask, claim, lines)
    elif word == "estimate" and kind == "quantile":
        quantile(result, ask, claim, lines[0])
    elif word == "rank" and name in ("betting", "one_challenger") and kind in ("probability", "mean") and not ask["beside"] and ask["models"] == 1:
        rank(result, ask, claim, lines)
    elif word == "compare" and kind in ("probability", "mean"):
        compare(result, ask, claim, *lines)
    else:
        return False
    return True


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    *lines, last = data.splitlines(keepends=True) or [b""]
    try:
        told = json.loads(last)["digest"]
    except (ValueError, KeyError, TypeError):
        raise Unreadable("the last line has no digest: the file is cut short, or is no certificate") from None
    if told != "sha256:" + hashlib.sha256(b"".join(lines)).hexdigest():
        raise Unreadable("the digest does not match: the file was changed")
    parsed = [json.loads(line) for line in lines]
    if not parsed or parsed[0].get("smc") != FORMAT:
        raise Unreadable(f"this is not `{FORMAT}`")
    return parsed


def main(path):
    try:
        head, *lines = read(path)
    except (OSError, ValueError, Unreadable) as error:
        print(f"{path}: {error}", file=sys.stderr)
        return 2
    print(f"{head['scenario']}, seed {head['seed']}, version {head['version']}")
    for file, digest in head["inputs"]:
        print(f"  {file} {digest}")
    refused = unknown = 0
    at = 0
    while at < len(lines):
        entry, own = lines[at], []
        at += 1
        while at < len(lines) and "result" not in lines[at]:
            own.append(lines[at])
            at += 1
        result = entry["result"]
        try:
            known = verified(entry, [unpacked(line) for line in own if "count" in line])
            word = "right" if known else f"not checked: {result['method']['name']}"
            unknown += not known
        except (Refused, Unreadable, KeyError, ValueError, IndexError, TypeError, ZeroDivisionError) as error:
            word, refused = f"refused: {error}" if isinstance(error, (Refused, Unreadable)) else f"refused: {error!r}", refused + 1
        print(f"{word:<12} {result['query']}: {result['certifies'] or 'nothing'}")
    return 1 if refused else 3 if unknown else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
