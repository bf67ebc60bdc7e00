"""Runs trials of a certificate again, through any program, and evaluates their formulas by an evaluator of its own (formulas.py).

`python3 tools/verify.py out.smcc MODEL [PROPERTIES…] --program smc --audit 300 [--audit-seed N] [--data DIR]` draws outcomes by a random
number of the verifier, writes the trace of each by `smc simulate MODEL --seed S --trial i`, and compares. Exit code 1: an outcome
differs, or a file is another one; 3: some results are not audited.
"""

import bisect
import collections
import hashlib
import itertools
import random
import re
import secrets
import subprocess

from formulas import SUMS, Language, Parser, Trial, Unread, tokens
from theorems import Refused


def outcome(line, k):
    """An outcome of a certificate; nothing where it is unresolved."""
    if k in line["unresolved"]:
        return None
    return line["values"][k] if "values" in line else line["truths"][k]


def options(head, query, place, extra):
    """The parameters under which the trials of a line were run, and the words of the call that makes them again."""
    ((word, ask),) = query["ask"].items()
    settings = dict(setting.split("=", 1) for setting in head["settings"])
    settings |= dict(query["settings"])
    words = []
    if word == "compare":
        settings |= dict(ask["settings"][place])
    elif word == "rank":
        option = ask["options"][place // (1 + len(ask["beside"]))]
        settings |= dict(option["settings"])
        words += ["--move", option["label"]] if option["advice"] else []
    words += [part for name, value in settings.items() for part in ("--set", f"{name}={value}")]
    words += ["--velocity", head["velocity"]] if head["velocity"] else []
    words += ["--models", ",".join(head["models"])] if head["models"] else []
    return settings, words + extra


def asked(language, query, place):
    """The formula or the number of a line, by the text of its query; for the check of a quantile the event that decides it."""
    ask, said, event = query["ask"], query["said"]["measure"], query["said"]["event"]
    beside = ask["rank"]["beside"] if "rank" in ask else []
    if place % (1 + len(beside)):
        said = beside[place % (1 + len(beside)) - 1]["said"]
    curve = re.fullmatch(r"P\((F|G)<=\w+ (.*)\)", said) if "'curve'" in str(ask) else None
    if event:
        return language.metric(f"{event['metric']} {event['relation']} {event['bound']}")
    if curve:
        return language.metric(f"time_until({'!' * (curve[1] == 'G')}({curve[2]}))")
    return language.metric(re.fullmatch(r"(?:P|E|Q|CVaR)\((?:[\d.]+(?: %)?, )?(.*)\)", said, re.DOTALL)[1])


def compared(trial, query, plain):
    """That the files ask a query, with its range and its threshold; lists of estimates and sweeps are looked for by their measures."""
    ((word, ask),) = query["ask"].items()
    said, text = (re.sub(r"\s+", " ", part) for part in (query["said"]["measure"], query["text"]))
    if text not in plain and (word == "check" or said not in plain):
        raise Unread("the files do not ask this")
    parser, measure = Parser(tokens(text.split(said, 1)[-1])), ask.get("measure") or ask["first"]
    number = lambda: trial.value(parser.formula(SUMS), 0, {})
    if measure.get("range") and parser.next("in"):
        low, _, high = number(), parser.expect(".."), number()
        if not same(low, measure["range"][0]) or not same(high, measure["range"][1]):
            raise Refused(f"the files say the range {low} .. {high}")
    if word == "check" and not query["said"]["event"]:
        relation, theta = parser.expect(">=", "<=", ">", "<"), number()
        if not same(theta, ask["threshold"]) or [relation[0] == ">", relation[1:] == "="] != [ask["at_least"], ask["or_equal"]]:
            raise Refused(f"the files say {relation} {theta}")


def again(program, model, head, words, trial):
    """The trace of a trial."""
    call = [program, "simulate", model, "--seed", str(head["seed"]), "--trial", str(trial), "-n", "1", "--format", "csv", *words]
    made = subprocess.run(call, capture_output=True, text=True)
    if made.returncode:
        raise Unread(f"`{' '.join(call)}`: {(made.stderr.strip().splitlines() or ['no trace'])[0]}")
    return made.stdout


def same(told, found):
    if isinstance(told, bool) or isinstance(found, bool) or None in (told, found):
        return told is not None and found is not None and bool(told) == bool(found) or told is found
    return told == found or abs(told - found) <= 1e-9 * max(1.0, abs(told), abs(found))


def readable(language, head, entries, texts, extra):
    """The lines whose formulas can be read, with what makes their trials again; and the queries that are not read, or not asked."""
    drawn, unread, refused = [], {}, {}
    plain = re.sub(r"\s+", " ", " ".join(texts))
    for entry, lines, _ in entries:
        queries, own = entry["queries"], []
        for place, line in enumerate(lines):
            query = queries[place] if len(queries) > 1 else queries[0]
            try:
                settings, words = options(head, query, place, extra)
                compared(Trial(language, "time", settings), query, plain)
                node = asked(language, query, place)
                language.check(node)
                own.append((query, line, node, settings, words))
            except Refused as error:
                refused[query["text"]] = error
            except (Unread, RecursionError) as error:
                unread[query["text"]] = error
        drawn += own if queries[0]["text"] not in {*unread, *refused} else []
    return drawn, unread, refused


def audited(head, entries, files, call):
    """Runs outcomes again that are drawn uniformly from all that can be read; the exit code."""
    given = {}
    for file in files:
        with open(file, "rb") as opened:
            data = opened.read()
        given[f"sha256:{hashlib.sha256(data).hexdigest()}"] = file, data.decode()
    known = {digest: file for file, digest in head["inputs"]}
    for digest in given.keys() - known.keys():
        print(f"refused: {given[digest][0]} is no file of the certificate")
        return 1
    for digest in known.keys() - given.keys():
        print(f"not compared: {known[digest]}")
    texts = [text for _, text in given.values()]
    language, tally = Language(texts), collections.Counter()
    drawn, unread, refused = readable(language, head, entries, texts, call["extra"])
    seed = call["seed"] if call["seed"] is not None else secrets.randbits(32)
    draw, ends = random.Random(seed), [*itertools.accumulate(line["count"] for _, line, *_ in drawn)]
    for _ in range(call["audit"] if ends and ends[-1] else 0):
        at = draw.randrange(ends[-1])
        which = bisect.bisect_right(ends, at)
        query, line, node, settings, words = drawn[which]
        trial = at - ends[which] + line["count"]
        told = outcome(line, trial)
        try:
            found = Trial(language, again(call["program"], files[0], head, words, trial), settings).outcome(node, "values" in line)
        except (Unread, RecursionError, TypeError) as error:
            tally["not audited"] += 1
            unread.setdefault(query["text"], f"trial {trial}: {error}")
            continue
        tally["audited"] += 1
        if not same(told, found):
            tally["differ"] += 1
            print(f"differs: trial {trial} is {told}, and its trace says {found}: {query['text']}")
    for word, found in (("refused", refused), ("not audited", unread)):
        for text, error in found.items():
            print(f"{word}: {error}: {text}")
    n, differ = tally["audited"], tally["differ"]
    escape = f"; {100 * (1 - 0.01 ** (1 / n)):.2f} % forged outcomes escape with a probability of 1 %" if n else ""
    missed = f", {tally['not audited']} not audited" if tally["not audited"] else ""
    print(f"audit        {n} outcomes run again{missed}, {differ} differ{escape} (--audit-seed {seed})")
    return 1 if differ or refused else 3 if unread else 0
