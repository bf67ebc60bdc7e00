"""Formulas of bounded LTL over traces, by their recursive definition in docs/semantics.md. It shares no code with the program.

It reads the states that `smc simulate` writes, and definitions and regions of scenario and property files; what needs more is `Unread`.
"""

import bisect
import csv
import io
import itertools
import math
import operator
import re

UNITS = {"s": 1, "ms": 1e-3, "min": 60, "h": 3600, "m": 1, "cm": 0.01, "mm": 1e-3, "km": 1000, "kg": 1, "N": 1, "rad": 1, "%": 0.01}
UNITS.update({"deg": math.pi / 180, "step": None, "steps": None})
TOKEN = re.compile(r"\s+|//[^\n]*|(\d+(?:\.\d+)?(?:[eE][+-]?\d+)?|\w+|<=>|=>|<=|>=|==|!=|\.\.|--|\"[^\"]*\"|.)")
ALIKE = {"⇔": "<=>", "⇒": "=>", "∨": "|", "∧": "&", "¬": "!"}
OVER_TIME, FOLDS, SUMS = ("F", "G", "X", "U", "W", "R", "over"), ("min", "max", "sum", "mean", "count"), 7
# From loose to tight; a prefix is tighter than `until`, and looser than a comparison.
LEVELS = [("<=>",), ("=>",), ("|",), ("&",), ("U", "W", "R"), (), ("<", "<=", ">", ">=", "==", "!=", "in"), ("+", "-"), ("*", "/")]
OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "+": operator.add}
OPERATORS.update({"-": operator.sub, "*": operator.mul, "^": operator.pow, "!=": lambda a, b: a != b and a == a and b == b})
OPERATORS["/"] = lambda a, b: a / b if b else math.nan if not a or a != a else math.copysign(math.inf, a)


class Unread(Exception):
    """A formula or a trace that this evaluator cannot read."""


class Undefined(Exception):
    """A value that is undefined: the trial is unresolved."""


def tokens(text):
    return [ALIKE.get(found[1], found[1]) for found in TOKEN.finditer(text) if found[1]]


class Parser:
    """Trees of formulas and numbers: an operator or a name, and its parts."""

    def __init__(self, words):
        self.words, self.k, self.is_bound = [*words, "", "", ""], 0, False

    def next(self, *wanted):
        """The next word, if it is one of these."""
        if wanted and self.words[self.k] not in wanted:
            return None
        self.k += 1
        return self.words[self.k - 1]

    def expect(self, *wanted):
        if not (word := self.next(*wanted)):
            raise Unread(f"`{self.words[self.k]}` where `{wanted[0]}` is expected")
        return word

    def formula(self, level=0):
        if level == len(LEVELS):
            return self.unary()
        if not LEVELS[level]:
            return self.prefix(level)
        left = self.formula(level + 1)
        while word := self.next(*LEVELS[level]):
            window = self.window() if word in OVER_TIME else ()
            left = (word, left, self.formula(level + (word != "=>")), *window)
        return left

    def prefix(self, level):
        word = self.next("!", "F", "G", "X", "forall", "exists")
        if not word:
            return self.formula(level + 1)
        if word in ("forall", "exists"):
            name, members = self.members()
            self.expect(":")
            return word, self.formula(), name, members
        window = self.window() if word != "!" else ()
        return word, self.prefix(level), *window

    def window(self):
        """The ends of a window; the last one is nothing where it is the horizon."""
        if self.next("<="):
            return None, self.bound()
        if not self.next("["):
            return None, None
        low, _, high, _ = self.bound(), self.expect(","), self.bound(), self.expect("]")
        return low, high

    def bound(self):
        if self.next("∞"):
            return None
        self.is_bound, is_steps = True, self.next("#")
        bound = self.formula(SUMS)
        self.is_bound = False
        return ("*", bound, ("steps",)) if is_steps else bound

    def members(self):
        name, _ = self.next(), self.expect("in")
        return name, self.formula(SUMS)

    def unary(self):
        if self.next("-"):
            return "*", ("given", -1.0), self.unary()
        base = self.primary()
        return ("^", base, self.unary()) if self.next("^") else base

    def primary(self):
        word = self.next()
        if word[:1].isdigit():
            return self.number(float(word))
        if word == "(":
            inner = self.parts()
            return inner[0] if len(inner) == 1 else ("point", *inner)
        if word in FOLDS and self.words[self.k] in ("<=", "["):
            window = self.window()
            return "over", self.primary(), *window, word
        if not re.fullmatch(r"[^\W\d]\w*", word):
            raise Unread(f"`{word}`")
        if self.words[self.k] == "(" and not self.is_bound:
            self.k += 1
            return self.fold(word) if word in FOLDS else ("call", word, *self.parts())
        if self.words[self.k] == "[" and self.words[self.k + 2] == "]":
            word, self.k = f"{word}[{self.words[self.k + 1]}]", self.k + 3
        node = "name", word
        while self.next("."):
            node = "field", node, self.next()
        return node

    def parts(self):
        found = []
        while not self.next(")"):
            found += [self.formula()] if not found or self.expect(",") else []
        return found

    def number(self, value):
        """A number with its unit, which follows at once."""
        sign, steps = 1, False
        while self.words[self.k] in UNITS or self.words[self.k] == "/" and self.words[self.k + 1] in UNITS:
            sign = -1 if self.next("/") else sign
            factor, power = UNITS[self.next()], int(self.next()) if self.next("^") else 1
            steps, value = factor is None, value * (factor or 1) ** (sign * power)
        return ("*", ("given", value), ("steps",)) if steps else ("given", value)

    def fold(self, word):
        """`count(a in S: φ)`, `min(x for a in S)`, `min(x, y)`."""
        if word == "count" and self.words[self.k + 1] == "in":
            name, members = self.members()
            body = self.formula() if self.next(":") else ("given", True)
        else:
            body = self.formula()
            if not self.next("for"):
                self.next(",")
                return "fold", word, ("list", body, *self.parts()), None, None
            name, members = self.members()
        self.expect(")")
        return "fold", word, body, name, members


class Region:
    """A rectangle, a circle or a polygon; points are complex numbers. The rim is part of it."""

    def __init__(self, form, corners, radius):
        self.form, self.corners, self.radius = form, corners, radius

    def holds(self, p):
        a, b = self.corners[0], self.corners[-1]
        if self.form == "circle":
            return abs(p - a) <= self.radius
        if self.form == "rect":
            return min(a.real, b.real) <= p.real <= max(a.real, b.real) and min(a.imag, b.imag) <= p.imag <= max(a.imag, b.imag)
        sides = ((a, b) for a, b in zip(self.corners, self.corners[1:] + [a]) if (a.imag > p.imag) != (b.imag > p.imag))
        return sum(p.real < a.real + (p.imag - a.imag) / (b - a).imag * (b - a).real for a, b in sides) % 2 == 1

    def area(self):
        a, b = self.corners[0], self.corners[-1]
        if self.form != "polygon":
            return math.pi * self.radius**2 if self.form == "circle" else abs((b - a).real * (b - a).imag)
        return abs(sum((p.conjugate() * q).imag for p, q in zip(self.corners, self.corners[1:] + [a]))) / 2


class Language:
    """Definitions of a scenario and of property files."""

    def __init__(self, texts):
        self.definitions, self.states, self.trees = {}, set(), {}
        for words in map(tokens, texts):
            scopes = [""]
            for k, (word, name, then) in enumerate(zip(words, words[1:], words[2:])):
                if word == "{":
                    before = words[max(k - 5, 0) : k]
                    block = "scene" if before[-1:] == ["scene"] else "{"
                    scopes.append(before[before.index("process") + 1] if "process" in before else scopes[-1] or block)
                elif word == "}":
                    scopes.pop()
                elif word == "state":
                    self.states.add(name)
                elif word in ("horizon", "step") and name == "=":
                    self.definitions["", word] = word, None, words[k + 2 : k + 12]
                elif word == "region" and scopes[-1] in ("", "scene"):
                    self.definitions["", name] = word, None, words[k + 3 : k + 200]
                elif word in ("let", "const", "param", "property", "label", "var"):
                    end = words.index(")", k) if then == "(" else k + 1
                    if word == "var" or words[end + 1 : end + 2] == ["="]:
                        parameters = [one for one in words[k + 3 : end] if one != ","] if then == "(" else None
                        self.definitions[scopes[-1], name] = word, parameters, words[end + 2 : end + 600]

    def tree(self, scope, name):
        """The definition of a name."""
        if (scope, name) not in self.trees:
            kind, _, words = self.definitions[scope, name]
            parser = Parser(words)
            if kind == "region":
                self.trees[scope, name] = self.region(parser)
            else:
                self.trees[scope, name] = parser.formula(SUMS if kind in ("param", "const", "horizon", "step") else 0)
        return self.trees[scope, name]

    def check(self, node):
        """That all functions of a formula are known here."""
        if node[0] in ("name", "call") and self.definitions.get(("", node[1]), ("var",))[0] not in ("var", "region"):
            self.check(self.tree("", node[1]))
        elif node[0] == "call" and node[1] not in (*FUNCTIONS, "if", "time_until"):
            raise Unread(f"`{node[1]}(…)` is not known here")
        for part in node:
            if isinstance(part, tuple):
                self.check(part)

    @staticmethod
    def region(parser):
        form, corners = parser.expect("rect", "circle", "polygon"), []
        while parser.words[parser.k] == "(" or form == "rect" and parser.next(".."):
            corners.append(parser.primary())
        return "region", form, ("list", *corners), parser.formula(SUMS) if form == "circle" and parser.expect("radius") else ("given", 0.0)

    @staticmethod
    def metric(text):
        """A truth value or a number of a trial; a number may be read at one time."""
        parser = Parser(tokens(text))
        node = parser.formula()
        if parser.next("at"):
            node = "at", node, None if parser.next("end") else parser.formula(SUMS)
        if parser.words[parser.k]:
            raise Unread(f"`{parser.words[parser.k]}` in `{text}`")
        return node


class Trial:
    """The states of a trial. In steps an instant is the number of a state; in continuous time a number of seconds."""

    def __init__(self, language, text, settings):
        self.language, self.settings, self.times, self.states, self.memory = language, settings, [], [], {}
        horizon = language.definitions["", "horizon"][2]
        self.step = 1.0 if "step" in "".join(horizon[1:2]) else 0.0
        self.step = self.value(language.tree("", "step"), 0, {}) if ("", "step") in language.definitions else self.step
        self.horizon = self.value(language.tree("", "horizon"), 0, {})
        (head, *rows), known = csv.reader(io.StringIO(text)), {}
        for cells in rows:
            row = {name: number(cell) for name, cell in zip(head, cells)}
            if row["time"] not in self.times[-1:]:
                self.times.append(row["time"])
                self.states.append((row, {}))
            if name := row.get("agent"):
                # The values of an agent that has not come are undefined; traces lack the last ones of an agent that has left.
                before = known.get(name, dict.fromkeys(("position", "velocity", "speed", "radius", "travelled"), math.nan))
                if row["x"] is not None:
                    row["position"], row["velocity"] = complex(row["x"], row["y"]), complex(row["vx"], row["vy"])
                    way = abs(row["position"] - before.get("position", math.nan))
                    row["travelled"] = before["travelled"] + way if way == way else 0.0
                is_gone = row["x"] is None and before.get("position") == before.get("position")
                lost = ("position", "velocity", "speed", "travelled") if is_gone else ()
                now = before | {key: cell for key, cell in row.items() if cell is not None}
                now = {key: cell for key, cell in now.items() if key not in lost}
                known[name] = self.states[-1][1][name] = now

    def outcome(self, node, is_number):
        """The outcome of a trial; nothing where it is unresolved."""
        try:
            found = self.value(node, 0 if self.step else 0.0, {})
        except Undefined:
            return None
        return (float(found) if found == found else None) if is_number else truth(found)

    def state(self, t):
        return self.states[t if self.step else bisect.bisect_right(self.times, t) - 1]

    def agent(self, t, name, value):
        if name not in (agents := self.state(t)[1]):
            raise Unread(f"the trace has no agent `{name}`")
        if value not in agents[name]:
            raise Unread(f"the trace has no `{value}` of `{name}`, which has left")
        return agents[name][value]

    def present(self, t):
        return [one for one, row in self.state(t)[1].items() if row["present"]]

    def kept(self, key, make):
        if key not in self.memory:
            self.memory[key] = make()
        return self.memory[key]

    def distance(self, bound):
        seconds = self.value(bound, 0, {})
        return round(seconds / self.step) if self.step else seconds

    def ends(self, node):
        """The window of an operator."""
        low, high = node[-2:] if node[0] != "over" else node[2:4]
        return self.distance(low) if low else 0, self.distance(high) if high else None

    def shifts(self, node):
        """How far from a jump the value of a formula can change."""
        found = {0.0}.union(*(self.shifts(part) for part in node if isinstance(part, tuple)))
        if node[0] in ("name", "call") and self.language.definitions.get(("", node[1]), ("region",))[0] != "region":
            found |= self.shifts(self.language.tree("", node[1]))
        return {a + b for a in found for b in (0.0, *filter(None, self.ends(node)))} if node[0] in OVER_TIME else found

    def instants(self, t, low, high, *nodes):
        """The instants of a window at which something changes, and one between any two; and whether it is one in between."""
        end = len(self.states) - 1 if self.step else self.horizon
        low, high = t + low, end if high is None else t + high
        if self.step:
            if high > end:
                raise Unread("the trace ends before the window does")
            yield from ((n, False) for n in range(low, high + 1))
            return
        shifts = self.kept(nodes, lambda: set().union(*map(self.shifts, nodes)))
        points = sorted({low, high, *(time - shift for shift in shifts for time in self.times if low < time - shift < high)})
        yield points[0], False
        for before, after in itertools.pairwise(points):
            yield 0.5 * (before + after), True
            yield after, False

    def value(self, node, t, names):
        """The value of a formula or a number at an instant; `names` are those of quantifiers and of definitions."""
        word, *parts = node
        now = lambda part: self.value(part, t, names)
        holds = lambda part, at=t: truth(self.value(part, at, names))
        if word in OPERATORS:
            return OPERATORS[word](now(parts[0]), now(parts[1]))
        if word in ("F", "G", "X"):
            low, high = self.ends(node)
            window = (low, high) if word != "X" else (high or 1,) * 2
            return any(holds(parts[0], u) != (word == "G") for u, _ in self.instants(t, *window, parts[0])) != (word == "G")
        match word, parts:
            case "given", [value]:
                return value
            case "steps", _:
                return self.step
            case "!", [part]:
                return not holds(part)
            case "&", [one, other]:
                return holds(one) and holds(other)
            case "|", [one, other]:
                return holds(one) or holds(other)
            case "=>", [one, other]:
                return not holds(one) or holds(other)
            case "<=>", [one, other]:
                return holds(one) == holds(other)
            case "U", [left, right, *_]:
                return self.until(t, self.ends(node), lambda u: holds(left, u), lambda u: holds(right, u), left, right)
            case "W", [left, right, low, high]:
                return now(("U", left, right, low, high)) or now(("G", left, None, high))
            case "R", [left, right, *window]:
                return not now(("U", ("!", left), ("!", right), *window))
            case ("forall" | "exists"), [body, name, members]:
                return (all if word == "forall" else any)(map(truth, self.each(t, names, body, name, members)))
            case "fold", [of, body, name, members]:
                found = [*self.each(t, names, body, name, members)] if name else now(body)
                return (sum(map(truth, found)) if name else len(found[0])) if of == "count" else fold(of, found)
            case "over", [body, _, _, of]:
                return self.over(of, [(u, between, self.value(body, u, names)) for u, between in self.instants(t, *self.ends(node), body)])
            case "in", [what, where]:
                return self.value(where, t, names).holds(self.position(t, now(what)))
            case "point", [x, y]:
                return complex(now(x), now(y))
            case "list", _:
                return [*map(now, parts)]
            case "region", [form, corners, radius]:
                return self.kept(node, lambda: Region(form, now(corners), now(radius)))
            case "at", [body, time]:
                return self.value(body, self.distance(time) if time else len(self.states) - 1 if self.step else self.horizon, names)
            case "field", [of, name]:
                return self.field(t, now(of), name)
            case "name", [name]:
                return self.name(t, name, names)
            case "call", [name, *arguments]:
                return self.call(t, name, arguments, names)
        raise Unread(f"`{word}`")

    def until(self, t, window, left, right, *nodes):
        """The right one somewhere in the window, and the left one at every instant before; the right one is looked at first."""
        for u, is_between in self.instants(t, 0, window[1], *nodes):
            if u >= t + window[0] and right(u) and (not is_between or left(u)):
                return True
            if not left(u):
                return False
        return False

    def over(self, of, found):
        """A fold over a window. In continuous time a mean is that of time."""
        ends = [u for u, is_between, _ in found if not is_between]
        if self.step or of != "mean" or len(ends) == 1:
            return fold(of, [value for *_, value in found])
        parts = [value for _, is_between, value in found if is_between]
        return sum((b - a) * value for (a, b), value in zip(itertools.pairwise(ends), parts)) / (ends[-1] - ends[0])

    def each(self, t, names, body, name, members):
        of = self.value(members, t, names)
        for one in [of] if isinstance(of, str) else of:
            yield self.value(body, t, {**names, name: (("given", one), {})})

    def field(self, t, of, name):
        """A variable of a process, or of a behaviour of an agent; or what its process defines by them."""
        row, agents = self.state(t)
        if f"{of}.{name}" in row:
            return row[f"{of}.{name}"]
        if of in agents and name in row:
            return agents[of].get(name, math.nan)
        if self.language.definitions.get((process := of.split("[")[0], name), ("var",))[0] == "var":
            raise Unread(f"`{of}.{name}`")
        return self.value(self.language.tree(process, name), t, {"": of})

    def name(self, t, name, names):
        definitions = self.language.definitions
        if name in names:
            return self.value(names[name][0], t, names[name][1])
        if "" in names and (names[""].split("[")[0], name) in definitions:
            return self.field(t, names[""], name)
        if name in ("everyone", "time", "pi", "true", "false"):
            return {"everyone": self.present(t), "time": t * (self.step or 1), "pi": math.pi}.get(name, name == "true")
        kind, parameters, words = definitions.get(("", name), (None, None, None))
        if kind == "param" and name in self.settings:
            # A number without a unit takes that of the default.
            told = tokens(self.settings[name])
            return self.value(Parser(told + words[1:8] if len(told) == 1 else told).formula(SUMS), t, {})
        if kind not in (None, "var") and parameters is None:
            return self.value(self.language.tree("", name), t, {})
        return self.thing(t, name)

    def thing(self, t, name):
        """An agent, a set of agents or of processes, a process, or a state of a behaviour."""
        row, agents = self.state(t)
        if name in agents or any(column.startswith(f"{name}.") for column in row) or name in self.language.states:
            return name
        if any(one.startswith(f"{name}[") for one in self.kept("agents", lambda: {one for _, agents in self.states for one in agents})):
            return [one for one in self.present(t) if one.startswith(f"{name}[")]
        if members := [*dict.fromkeys(column.split(".")[0] for column in row if column.startswith(f"{name}["))]:
            return members
        raise Unread(f"`{name}`")

    def position(self, t, of, name="position"):
        """Of an agent, the mean of a set, or a point."""
        if isinstance(of, list):
            return fold("mean", [self.agent(t, one, name) for one in of])
        return self.agent(t, of, name) if isinstance(of, str) else of

    def call(self, t, word, parts, names):
        parameters = self.language.definitions.get(("", word), (None, None, None))[1]
        if parameters is not None:
            return self.value(self.language.tree("", word), t, {name: (part, names) for name, part in zip(parameters, parts)})
        if word == "time_until":
            found = ((u, is_between) for u, is_between in self.instants(t, 0, None, parts[0]) if truth(self.value(parts[0], u, names)))
            u, is_between = next(found, (math.inf, False))
            before = max((time for time in self.times if time <= u), default=0.0) if is_between else u
            return (u - t) * self.step if self.step else before - t
        if word == "if":
            return self.value(parts[1 if truth(self.value(parts[0], t, names)) else 2], t, names)
        if word not in FUNCTIONS:
            raise Unread(f"`{word}(…)`")
        return FUNCTIONS[word](self, t, *(self.value(part, t, names) for part in parts))

    def inside(self, t, region):
        return [row for row in map(self.state(t)[1].get, self.present(t)) if region.holds(row["position"])]

    def service(self, t, region):
        """The level of service: areas of an agent, by Fruin 1971."""
        n = len(self.inside(t, region))
        return 1 + sum(region.area() / n < bound for bound in (3.24, 2.32, 1.39, 0.93, 0.46)) if n else 1

    def dwell(self, t, of, region):
        """The time of all steps so far that began in the region."""
        is_in = lambda row: bool(row and row["present"] and region.holds(row["position"]))
        begun = lambda: [0, *itertools.accumulate(is_in(agents.get(of)) for _, agents in self.states)]
        return self.step * self.kept((of, id(region)), begun)[t]


FUNCTIONS = {
    "position": Trial.position,
    "centroid": Trial.position,
    "velocity": lambda trial, t, of: trial.position(t, of, "velocity"),
    "speed": lambda trial, t, of: trial.agent(t, of, "speed") if isinstance(of, str) else abs(trial.position(t, of, "velocity")),
    "radius": lambda trial, t, of: trial.agent(t, of, "radius"),
    "travelled": lambda trial, t, of: trial.agent(t, of, "travelled"),
    "present": lambda trial, t, of: trial.agent(t, of, "present") == 1,
    "others": lambda trial, t, of: [one for one in trial.present(t) if one != of],
    "x": lambda trial, t, of: trial.position(t, of).real,
    "y": lambda trial, t, of: trial.position(t, of).imag,
    "distance": lambda trial, t, a, b: abs(trial.position(t, a) - trial.position(t, b)),
    "density": lambda trial, t, region: len(trial.inside(t, region)) / region.area(),
    "mean_speed": lambda trial, t, region: fold("mean", [row["speed"] for row in trial.inside(t, region)] or [0.0]),
    "level_of_service": Trial.service,
    "dwell": Trial.dwell,
    "abs": lambda trial, t, x: abs(x),
    "norm": lambda trial, t, x: abs(x),
}
FUNCTIONS.update({name: lambda trial, t, x, of=getattr(math, name): of(x) for name in ("sqrt", "exp", "sin", "cos", "floor", "ceil")})


def number(cell):
    try:
        return float(cell) if cell else None
    except ValueError:
        return cell


def truth(value):
    if not isinstance(value, (bool, float, int)):
        raise Unread(f"`{value}` is no truth value")
    return bool(value)


def fold(word, values):
    if word == "mean" and not values:
        raise Undefined
    if any(value != value for value in values):
        return math.nan
    if word in ("min", "max"):
        return min(values, default=math.inf) if word == "min" else max(values, default=-math.inf)
    return sum(values) / (len(values) if word == "mean" else 1)
