"""The theorems behind certificates: tails and ends of intervals, tests, estimators, and bets. docs/proofs.md says where each is from.

`verify.py` applies them to outcomes. They need nothing but Python, and share no code and no table with the program.
"""

import bisect
import collections
import itertools
import math

SLACK = 1e-9  # of thresholds in logarithms
INF = math.inf
MOST_CELLS = 5 * 10**7  # of the lattice of a proof: some seconds


class Refused(Exception):
    """A claim does not follow from the outcomes."""


class Unchecked(Exception):
    """A claim follows a rule that is not checked here."""


def require(holds, reason):
    if not holds:
        raise Refused(reason)


# Special functions: tails of Beta laws by a continued fraction (Lentz), tails of Gamma laws by sums of Poisson terms, bisection.


def ln_beta(a, b):
    return math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)


def fraction(a, b, x):
    """The continued fraction of the incomplete beta function, by Lentz's method."""
    c, value = 1.0, 1.0 / (1.0 - (a + b) * x / (a + 1) or 1e-300)
    d = value
    for m in range(1, 100_000):
        k = a + 2 * m
        top = m * (b - m) * x / ((k - 1) * k)
        d, c = 1.0 / (1.0 + top * d or 1e-300), 1.0 + top / c
        value *= c * d
        top = -(a + m) * (a + b + m) * x / (k * (k + 1))
        d, c = 1.0 / (1.0 + top * d or 1e-300), 1.0 + top / c or 1e-300
        value *= c * d
        if abs(c * d - 1.0) < 1e-15:
            break
    return value


def ln_tails(a, b, x):
    """Logarithms of P(X <= x) and P(X > x) for X of the law Beta(a, b). P(Binomial(n, x) >= k) is P(X <= x) of Beta(k, n - k + 1)."""
    if x <= 0.0 or x >= 1.0:
        return (-INF, 0.0) if x <= 0.0 else (0.0, -INF)
    front = a * math.log(x) + b * math.log1p(-x) - ln_beta(a, b)
    if x < (a + 1) / (a + b + 2):
        lower = front - math.log(a) + math.log(fraction(a, b, x))
        return lower, math.log1p(-math.exp(min(lower, -1e-300)))
    upper = front - math.log(b) + math.log(fraction(b, a, 1.0 - x))
    return math.log1p(-math.exp(min(upper, -1e-300))), upper


def gamma_tails(k, x):
    """P(X <= x) and P(X > x) for X of the law Gamma(k): k events of a Poisson process come until x or not."""
    first, step = (k, 1) if x < k else (k - 1, -1)
    term = math.exp(first * math.log(x) - x - math.lgamma(first + 1))
    total, j = 0.0, first
    while j >= 0 and term > 1e-18 * total:
        total, j = total + term, j + step
        term *= x / j if step > 0 else (j + 1) / x
    return (total, 1.0 - total) if x < k else (1.0 - total, total)


def bisected(low, high, is_below, precision=0.0):
    """The neighbours between which a condition ends to hold."""
    while low < (middle := 0.5 * (low + high)) < high and high - low > precision:
        low, high = (middle, high) if is_below(middle) else (low, middle)
    return low, high


def smallest(low, holds):
    """The smallest whole number from `low` on that holds, of those after which all hold."""
    step = 1
    while not holds(low + step):
        step *= 2
    return bisect.bisect_left(range(low, low + step), True, key=holds) + low


def hull(pairs):
    lows, highs = zip(*pairs)
    return min(lows), max(highs)


# Intervals of probabilities.


def beta_end(a, b, error):
    """Where P(X <= x) is the error: Newton's method on its logarithm, which is concave."""
    goal, x, new = math.log(error), 0.0, a / (a + b)
    while abs(new - x) > 1e-9 * new:
        x = new
        lower = ln_tails(a, b, x)[0]
        new = x - (lower - goal) * math.exp(lower + ln_beta(a, b) - (a - 1) * math.log(x) - (b - 1) * math.log1p(-x))
        new = new if new > 0.0 else 0.5 * x
    return new


def clopper_pearson(s, f, error):
    """Clopper and Pearson 1934: half of the error on either side."""
    return beta_end(s, f + 1, 0.5 * error) if s else 0.0, 1.0 - beta_end(f, s + 1, 0.5 * error) if f else 1.0


def is_narrow(s, f, error, width):
    """Whether Clopper and Pearson's interval is at most so wide: its upper end is below the lower one plus the width."""
    s, f = min(s, f), max(s, f)
    end = (beta_end(s, f + 1, 0.5 * error) if s else 0.0) + width
    return end >= 1.0 or f > 0 and ln_tails(s + 1, f, end)[1] <= math.log(0.5 * error)


def held_at_all_times(s, f, error, p):
    """Whether p is in the confidence sequence of Krichevsky and Trofimov 1981: the evidence against it is below 1/error (Ville 1939)."""
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

    def is_reached(self, s, f):
        return self.log(s, f) >= self.threshold

    def look(self, s, f):
        # More failures never make fewer successes enough.
        if s >= self.wanted:
            self.wanted = smallest(s, lambda more: self.is_reached(more, f))
        return s >= self.wanted


def eprocess(rule, theta):
    above, below = OneSided(theta, rule["beta"]), OneSided(1 - theta, rule["alpha"])
    return lambda s, f, success: "above" if success and above.look(s, f) else "below" if not success and below.look(f, s) else None


def three_way(rule, theta):
    """The same, and both ends of the region at once; what was once passed stays passed."""
    half, width = 0.5 * rule["alpha"], rule["indifference"]
    sides = [[OneSided(theta, half), OneSided(theta - width, half)], [OneSided(1 - theta, half), OneSided(1 - theta - width, half)]]
    passed = [False, False]

    def look(s, f, success):
        side, counts = (0, (s, f)) if success else (1, (f, s))
        passed[side] = passed[side] or sides[side][1].look(*counts)
        return ("above", "below")[side] if sides[side][0].look(*counts) else "within" if all(passed) else None

    return look


def ratio(s, f, one, other):
    """The logarithm of the likelihood of `one` over that of `other`."""
    return s * math.log(one / other) + f * math.log((1 - one) / (1 - other))


def sprt(rule, theta):
    """The likelihood ratio against each end of the region: of the other end (Wald 1945, at the thresholds 1/alpha and 1/beta), or of
    theta (Lorden 1976)."""
    low, high = theta - rule["indifference"], theta + rule["indifference"]
    one, other = (low, high) if rule["name"] == "sprt" else (theta, theta)
    say_below, say_above = (SLACK - math.log(rule[error]) for error in ("alpha", "beta"))
    is_above = lambda s, f: ratio(s, f, other, low) >= say_above
    return lambda s, f, _: "below" if ratio(s, f, one, high) >= say_below else "above" if is_above(s, f) else None


def weighed(told, rule, theta, readings):
    """That the evidence of a test is the one that is told: its logarithms for above and for below at the last trial but one and at the
    last one, where unresolved trials are read as they speak least for it."""
    if told is None:
        return
    if rule["name"] in ("eprocess", "three_way"):
        half = 0.5 * rule["alpha"]
        above, below = OneSided(theta, rule.get("beta", half)), OneSided(1 - theta, rule["alpha"] if "beta" in rule else half)
        logs = (above.log, lambda s, f: below.log(f, s))
    elif rule["name"] in ("sprt", "sprt2"):
        low, high = theta - rule["indifference"], theta + rule["indifference"]
        one, other = (low, high) if rule["name"] == "sprt" else (theta, theta)
        logs = (lambda s, f: ratio(s, f, other, low), lambda s, f: ratio(s, f, one, high))
    else:
        raise Refused("a test that only counts has no evidence")
    counts = [[(sum(part), len(part) - sum(part)) for part in (reading[:-1], reading)] for reading in (readings[0], readings[-1])]
    found = [log(*counts[-side][k]) for k in (0, 1) for side, log in enumerate(logs)]
    pairs = zip([log for both in told for log in both], found, strict=True)
    require(all(abs(a - b) <= 1e-6 * max(1.0, abs(b)) for a, b in pairs), f"the evidence is {told}, and the outcomes say {found}")


def plan(rule, theta):
    """A fixed size and a number of successes that accepts: both errors are binomial tails."""
    size, accept = rule["trials"], rule["accept"]
    rejects = ln_tails(accept, size - accept + 1, theta + rule["indifference"])[1]
    accepts = ln_tails(accept, size - accept + 1, theta - rule["indifference"])[0]
    keeps = rejects <= math.log(rule["alpha"]) + SLACK and accepts <= math.log(rule["beta"]) + SLACK
    require(keeps, f"{accept} of {size} do not keep the errors")
    return lambda s, f, _: "above" if s >= accept else "below" if f > size - accept else None


TESTS = {"eprocess": eprocess, "three_way": three_way, "sprt": sprt, "sprt2": sprt, "plan": plan}


def decided(rule, ask, decision):
    """The claim of a decision of a test, and its error."""
    theta, error = ask["threshold"], rule.get("beta" if decision == "above" else "alpha", rule.get("alpha"))
    if decision == "within":
        return {"Between": [theta - rule["indifference"], theta + rule["indifference"]]}, error
    if "indifference" in rule and rule["name"] != "three_way":
        return ({"Above": theta - rule["indifference"]} if decision == "above" else {"Below": theta + rule["indifference"]}), error
    # `>=` and `<` put the threshold above, `>` and `<=` below.
    names = ("AtLeast", "Below") if ask["at_least"] == ask["or_equal"] else ("Above", "AtMost")
    return {names[decision == "below"]: theta}, error


# Estimators of a probability: when they stop, and their interval then.


def okamoto(rule):
    """Okamoto 1958: Hoeffding's inequality at a fixed size."""
    size = math.ceil(math.log(2 / rule["delta"]) / (2 * rule["epsilon"] ** 2))
    return lambda s, f: s + f >= size, lambda s, f: (max(s / (s + f) - rule["epsilon"], 0), min(s / (s + f) + rule["epsilon"], 1))


def fixed(rule):
    return lambda s, f: s + f >= rule["trials"], lambda s, f: clopper_pearson(s, f, rule["delta"])


def ahead(is_over):
    """The same rule, looked at only where it can stop: nothing is sooner than with all further outcomes on one side."""
    at = [0]

    def stops(s, f):
        if s + f < at[0] or is_over(s, f):
            return s + f >= at[0]
        at[0] = s + f + min(smallest(0, lambda k: is_over(s + k, f)), smallest(0, lambda k: is_over(s, f + k)))
        return False

    return stops


def calibrated(rule):
    """Stops when the interval at the level gamma is narrow; at that level the whole procedure keeps its error."""
    gamma, epsilon = rule["gamma"], rule["epsilon"]

    def interval(s, f):
        prove(epsilon, gamma, rule["delta"])
        return clopper_pearson(s, f, gamma)

    return ahead(lambda s, f: is_narrow(s, f, gamma, 2 * epsilon)), interval


PROVEN = {}


def prove(epsilon, gamma, delta):
    """That the procedure misses every probability with at most delta.

    All orders of s successes in n trials are equally likely, so the share of those that come to (n, s) without a stop before is free
    of the probability p; it follows from one pass over the lattice. Both ends of the interval rise along the stops, so P_c(U < d) +
    P_d(L > c) bounds the misses of all p in [c, d]. By symmetry p is at most one half.
    """
    if PROVEN.setdefault((epsilon, gamma), 1.0) <= delta:
        return
    limit = smallest(1, lambda n: is_narrow(n // 2, n - n // 2, gamma, 2 * epsilon))
    if limit * limit / 8 > MOST_CELLS:
        raise Unchecked(f"the proof that the level {gamma:g} suffices takes more than {MOST_CELLS} steps")
    reach, first, stops = [1.0], 0, []  # the shares of s in first ..= n // 2
    for n in itertools.count(1):
        others = itertools.chain(reach[1:], reach[-1:] * (1 - n % 2))
        inner = [(a * s + b * (n - s)) / n for a, b, s in zip(reach, others, range(first + 1, n))]
        reach = [reach[0] * (n - first) / n, *inner]
        while reach and is_narrow(s := first, n - s, gamma, 2 * epsilon):
            ways = math.lgamma(n + 1) - math.lgamma(s + 1) - math.lgamma(n - s + 1)
            stops.append((s, n - s, ways, *clopper_pearson(s, n - s, gamma), reach.pop(0)))
            first += 1
        if not reach:
            break
    stops += [(f, s, ways, 1 - high, 1 - low, part) for s, f, ways, low, high, part in reversed(stops) if s != f]
    lows, highs = [stop[3] for stop in stops], [stop[4] for stop in stops]
    require(lows == sorted(lows) and highs == sorted(highs), f"the ends of intervals at the level {gamma:g} do not rise")

    def mass(p, part, sign):
        """The probability of stops in a direction; beyond p they become ever less likely."""
        total, log, rest = 0.0, math.log(p or 1e-300), math.log1p(-p)
        for s, f, ways, _, _, share in part:
            term = math.exp(ways + s * log + f * rest)
            total += term * share
            if term < 1e-15 and sign * (s - p * (s + f)) > 0:
                break
        return total + 1e-12 * len(stops)

    def bound(c, d, of):
        below, above = bisect.bisect_left(highs, of[1]), bisect.bisect_right(lows, of[0])
        return mass(c, reversed(stops[:below]), -1) + mass(d, stops[above:], 1)

    def is_kept(c, d, of=None, depth=12):
        if bound(c, d, of or (c, d)) <= delta:
            return True
        inside = cuts[bisect.bisect_right(cuts, c) : bisect.bisect_left(cuts, d)] if not of else []
        middle, of = (inside[len(inside) // 2], None) if inside else (0.5 * (c + d), of or (c, d))
        return depth > 0 and is_kept(c, middle, of, depth - bool(of)) and is_kept(middle, d, of, depth - bool(of))

    cuts = sorted({p for p in lows + highs if 0.0 < p < 0.5} | {0.0, 0.5})
    require(is_kept(0.0, 0.5), f"at the level {gamma:g} the procedure may miss with more than {delta:g}")
    PROVEN[epsilon, gamma] = min(delta, PROVEN[epsilon, gamma])


def spending(rule):
    """A union bound over looks, each half as many trials later than the one before."""
    level, width = rule["delta"] / rule["looks"], 2 * rule["epsilon"]
    n = max(math.ceil(math.log(0.5 * level) / math.log1p(-width)), 1) if width < 1 else 1
    last = smallest(1, lambda n: is_narrow(n // 2, n - n // 2, level, width))
    looks = {math.ceil(n * 1.5**k) for k in range(200)}
    looks = {look for look in looks if look < last} | {last}
    require(len(looks) <= rule["looks"], f"there are {len(looks)} looks, not {rule['looks']}")
    stops = lambda s, f: s + f >= last or s + f in looks and is_narrow(s, f, level, width)
    return stops, lambda s, f: clopper_pearson(s, f, level)


def massart(rule):
    """Jegourel, Sun and Dong 2017: the bound of Massart, at the end of a running interval that is nearest to one half."""
    epsilon, share = rule["epsilon"], rule["auxiliary"]
    limit = math.ceil(math.log(2 / rule["delta"]) / (2 * epsilon**2))
    factor = 2 / (9 * epsilon**2) * math.log(2 / (rule["delta"] - share))

    def is_over(s, f):
        low, high = clopper_pearson(s, f, share)
        spread = (1.5 + epsilon) ** 2
        if high < 0.5:
            spread = (3 * high + epsilon) * (3 * (1 - high) - epsilon)
        elif low > 0.5:
            spread = (3 * (1 - low) + epsilon) * (3 * low + epsilon)
        return s + f >= min(limit, factor * spread)

    return ahead(is_over), okamoto(rule)[1]


def gbas(rule, estimate):
    """Huber 2017: R, the sum of an exponential number for each trial until the k-th success, times P has the law Gamma(k). The numbers
    follow from the seed; R follows from the estimate (k - 1)/R, and has the law Gamma(n) before the outcomes are known."""
    error, k = (0.9 if rule["cap"] else 1.0) * rule["delta"], rule["successes"]
    miss = lambda k: gamma_tails(k, (k - 1) / (1 + rule["epsilon"]))[0] + gamma_tails(k, (k - 1) / (1 - rule["epsilon"]))[1]
    require(k == smallest(2, lambda k: miss(k) <= error), f"{k} successes are not those of the errors")

    def interval(s, f):
        if s < k:
            return clopper_pearson(s, f, 0.1 * rule["delta"])
        if not estimate or estimate >= 1:
            raise Unchecked("the sum of exponential numbers does not follow from the estimate")
        total = (k - 1) / estimate
        require(min(gamma_tails(s + f, total)) > 1e-9, f"no sum of {s + f} exponential numbers is {total}")
        ends = [bisected(0.0, 9.0 * k, lambda x: gamma_tails(k, x)[0] < 0.5 * error)[0]]
        ends.append(bisected(0.0, 9.0 * k, lambda x: gamma_tails(k, x)[1] > 0.5 * error)[1])
        return tuple(min(end / total, 1.0) for end in ends)

    return lambda s, f: s >= k or s + f >= rule["cap"], interval


def unspecific(rule):
    """The default that was ended before it mattered which procedure it is."""
    return lambda s, f: False, None


ESTIMATES = {"okamoto": okamoto, "clopper_pearson": fixed, "calibrated": calibrated, "spending": spending, "massart": massart}
ESTIMATES["default"] = unspecific


# Bets: capital that does not grow on average reaches 1/error with a probability of at most the error (Ville 1939).


def geometric(number, least, most):
    return [least * (most / least) ** (k / (number - 1)) for k in range(number)]


BETS, RACE = geometric(16, 0.002, 0.95), geometric(12, 0.02, 0.95)


def capitals(changes, bets):
    """The logarithms of the capital of each bet: it is multiplied by 1 + bet * change as often as the change comes."""
    return [sum(n * math.log1p(bet * x) for x, n in changes.items()) for bet in bets]


def mixed(logs):
    """The logarithm of the capital of all bets, among which it was spread."""
    return (most := max(logs)) + math.log(sum(math.exp(log - most) for log in logs) / len(logs))


def difference(counts, error):
    """The lower end of P(first) - P(second) from how often the first alone held, both alike, and the second alone."""
    total, mean = sum(counts), (counts[0] - counts[2]) / max(sum(counts), 1)
    against = lambda m: mixed(capitals(dict(zip([(d - m) / (1 + m) for d in (1, 0, -1)], counts)), BETS))
    return bisected(-1 + 1e-15, mean, lambda m: against(m) >= math.log(2 / error) + SLACK)[0] if total else -1.0


# Means of values in [0, 1], and of their largest share.


class Sequence:
    """The empirical Bernstein confidence sequence of Waudby-Smith and Ramdas 2024."""

    def __init__(self, error, aim=None):
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

    def ends(self):
        centre, radius = (self.weighted / self.bets, (self.log + self.variance) / self.bets) if self.n else (0.5, 0.5)
        return centre - radius, centre + radius


def mean(rule, readings, scale):
    """The interval of a mean: the sequence at 0.8 of the error; at a size fixed beforehand also Hoeffding's at the rest; of `okamoto`
    Hoeffding's alone."""
    epsilon, delta = rule.get("epsilon", 0.0) / scale, rule["delta"]
    cap = 0.2 * delta if rule["name"] != "okamoto" else 0.0
    size = math.ceil(math.log(2 / (cap or delta)) / (2 * epsilon**2)) if epsilon else rule["trials"]
    ends = []
    for reading in readings:
        sequence, n = Sequence(delta - cap, size if not epsilon or not cap else None), len(reading)
        require(n <= size, f"the rule stops after {size} trials, not {n}")
        for x in reading:
            sequence.push(x)
        (low, high), reach = sequence.ends(), math.sqrt(math.log(2 / (cap or delta)) / (2 * max(n, 1))) if cap else epsilon
        hoeffding = sequence.sum / max(n, 1) - reach, sequence.sum / max(n, 1) + reach
        ends.append((low, high) if n < size else (max(low, hoeffding[0]), min(high, hoeffding[1])) if cap else hoeffding)
    return hull(ends)


def is_tail_above(values, share, u, error):
    """Y_c = c + max(X - c, 0) / share has its least mean over c at the quantile: the mean of the largest share (Rockafellar and Uryasev
    2000). Where that is u or less, bets on Y_c above u do not pay at this c, and the least capital over all c is no larger. Within a
    part of all c the capital is least at an end, but for values inside, which are put at their least."""
    values, threshold, parts = sorted(values), math.log(2 / error) - SLACK, [(0.0, u)]

    def least(*part):
        a, b = bisect.bisect_right(values, part[0]), bisect.bisect_left(values, part[1])
        inside = collections.Counter(v / u - 1 for v in values[a:b])
        changes = lambda c: inside + collections.Counter((c + (v - c) / share) / u - 1 for v in values[max(a, b) :])
        return mixed([min(pair) for pair in zip(*(capitals(changes(c) + collections.Counter({c / u - 1: a}), BETS) for c in {*part}))])

    for looked in itertools.count(1):
        if not parts:
            return True
        low, high = parts.pop()
        if least(low, high) < threshold:
            middle = 0.5 * (low + high)
            if looked > 400 or least(middle, middle) < threshold:
                return False
            parts += [(low, middle), (middle, high)]


def is_tail_below(values, share, u, error):
    """Whatever c is, the mean of Y_c is at least the tail: bets on Y_c below u, with c the quantile of the values before."""
    seen, changes, due, c = [], collections.Counter(), 32, None
    for n, value in enumerate(values):
        if n >= due:
            c, due = seen[min(max(math.ceil((1 - share) * n), 1), n) - 1], n + n // 8
        bisect.insort(seen, value)
        if c is not None and (most := c + (1 - c) / share) - u > 1e-9:
            changes[(most - c - max(value - c, 0.0) / share) / (most - u) - 1] += 1
    return mixed(capitals(changes, BETS)) >= math.log(2 / error) - SLACK


def tail(readings, share, error, told=None):
    """The ends that are told, if what lies beyond is refuted; else those that are found by bisection."""
    above = lambda u: u <= 0.0 or is_tail_above(readings[0], share, u, error)
    below = lambda u: u >= 1.0 or is_tail_below(readings[-1], share, u, error)
    low, high = told or (bisected(0.0, 1.0, above, 1e-6)[0], bisected(0.0, 1.0, lambda u: not below(u), 1e-6)[1])
    require(above(low - SLACK) and below(high + SLACK), "the interval of the largest share does not follow")
    return low, high
