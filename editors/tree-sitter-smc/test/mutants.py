"""Tests the grammar on shipped files and on mutants of them: `python3 mutants.py SMC TREE_SITTER [COUNT]`.

SMC is the program `smc`, TREE_SITTER the program `tree-sitter`. COUNT mutants that `smc fmt` accepts (1000 unless stated)
must parse without an ERROR or MISSING node, and their items must begin where the rule of line ends says. Files in
`tests/planted` are left out: they have mistakes.
"""

import json
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
FOLDERS = ["models", "properties", "examples", "validation", "benches", "docs", "tests/languages"]
KEYWORDS = json.loads((HERE.parents[1] / "keywords.json").read_text())

TOKEN = re.compile(
    r"(?P<blank>[ \t\r\n\ufeff]+|//[^\n]*|/\*.*?\*/)|[^\W\d]\w*|\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
    r'|"(?:\\[^\n]|[^"\\\n])*"|<=>|===|==|=>|!=|<=|>=|->|--|\.\.|&&|\|\||\*\*|:=|.',
    re.S,
)
BETWEEN = set("+ - * / ^ == != ≠ <= ≤ < >= ≥ > & ∧ | ∨ => ⇒ <=> ⇔ , -> -- ..".split())
NAME = re.compile(r"[^\W\d]")


def tokens(text):
    """The tokens with their places, and whether each is the first of its line."""
    found, starts = [], True
    for match in TOKEN.finditer(text):
        if match["blank"]:
            starts |= "\n" in match[0]
        else:
            found.append((match.start(), match[0], starts))
            starts = False
    return found


def begins(word, following):
    """Whether a word and what follows it surely begin an item."""
    name = NAME.match(following) and following not in ("in", "U", "W", "R")
    return bool(name) and word in KEYWORDS.get("declares", [])


def item_starts(text, properties):
    """Where the items begin, those of blocks among them, by the rule of `docs/scenario.md`."""
    found = tokens(text)
    words = [token[1] for token in found] + ["", ""]
    infix = {"in", "U", "W", "R"} if properties else {"in"}
    starts, stack, in_item = [], [], False
    for at, (place, word, starts_line) in enumerate(found):
        depth = stack[-1] if stack else 0
        if word == "}":
            stack.pop()
            in_item = True
            continue
        if word == ";" and not (stack and stack[-1]):
            in_item = False
            continue
        if in_item and starts_line and depth == 0:
            before, second = words[at - 1], words[at + 1]
            sets = second == "=" and before not in ("->", "|", ":", ",", "under", "with")
            goes_on = not sets and not begins(word, second) and (
                before in BETWEEN | infix | {"=", ":", "!"}
                or word in BETWEEN | infix | {"(", ")", "]", "{"}
                or (word in KEYWORDS["continues"] and second != ":")
            )
            in_item = goes_on
        if not in_item:
            starts.append(len(text[:place].encode()))
            in_item = True
        if word in ("(", "["):
            if not stack:
                stack.append(0)
            stack[-1] += 1
        elif word in (")", "]"):
            stack[-1] -= 1
        elif word == "{":
            if not stack:
                stack.append(0)
            stack.append(0)
            in_item = False
    return starts


def mutant(text, chance):
    """A text with one to three changes."""
    for _ in range(chance.choice([1, 1, 2, 3])):
        found = tokens(text)
        if not found:
            break
        at = chance.randrange(len(found))
        place, word, _ = found[at]
        end = place + len(word)
        gap = found[at + 1][0] if at + 1 < len(found) else len(text)
        match chance.randrange(14):
            case 0:
                text = text[:place] + text[end:]
            case 1 if gap < len(text):
                other = found[at + 1][1]
                text = text[:place] + other + text[end:gap] + word + text[gap + len(other) :]
            case 2:
                ends = [i for i, c in enumerate(text) if c == "\n"]
                if ends:
                    end = chance.choice(ends)
                    text = text[:end] + chance.choice([" ", "; ", ""]) + text[end + 1 :]
            case 3:
                numbers = [token for token in found if token[1][0].isdigit()]
                if numbers:
                    place, word, _ = chance.choice(numbers)
                    number = chance.choice(["0", "7", "0.5", "1e3", "2.5e-2", ".5", "80 %", "3 m/s", "1 /min", "#4"])
                    text = text[:place] + number + text[place + len(word) :]
            case 4:
                text = text[:end] + text[gap:]
            case 5:
                text = text.replace("\r\n", "\n").replace("\n", "\r\n")
            case 6:
                comment = chance.choice(["/* note */", "// note\n", "/* two\n lines */", " // a { ( [\n"])
                text = text[:end] + comment + text[end:]
            case 7:
                text = text[:end] + chance.choice(["\n", "\n\n", "\r\n  ", "\t", "\n// note\n"]) + text[end:]
            case 8:
                text = text[:place] + chance.choice(KEYWORDS["continues"] + KEYWORDS["items"]) + text[end:]
            case 9:
                names = [token for token in found if NAME.match(token[1])]
                if names:
                    old = chance.choice(names)[1]
                    new = chance.choice(["F", "U", "min", "s", "m", "end", "route", "radius", "è", "x1", "sum", "by"])
                    text = re.sub(rf"\b{old}\b", new, text)
            case 10:
                marks = {"&": "∧", "|": "∨", "=>": "⇒", "<=": "≤", ">=": "≥", "!=": "≠", "!": "¬"}
                text = text[:place] + marks.get(word, word) + text[end:]
            case 11:
                lines = text.split("\n")
                lines.insert(chance.randrange(len(lines)), chance.choice(lines))
                text = "\n".join(lines)
            case 12 if word == ";" or found[at][2]:
                text = text[:place] + ("\n" if word == ";" else ";" + word) + text[end:]
            case _:
                text = text[:place] + "(" + word + ")" + text[end:]
    return text


def accepted(program, text, suffix):
    """Whether `smc fmt` accepts a text."""
    command = [program, "fmt", "--language", suffix[1:], "-"]
    return subprocess.run(command, input=text.encode(), capture_output=True, check=False).returncode == 0


def trees(program, paths, folder):
    """The printed trees of files."""
    listing = folder / "paths"
    listing.write_text("".join(f"{path}\n" for path in paths))
    library = folder / "smc.so"
    if not library.exists():
        subprocess.run([program, "build", "-o", library, HERE.parent], check=True)
    command = [program, "parse", "-l", library, "--lang-name", "smc", "--paths", listing]
    printed = subprocess.run(command, capture_output=True, check=False).stdout.decode()
    found = re.split(r"^(?=\(source_file|\(ERROR)", printed, flags=re.M)[1:]
    assert len(found) == len(paths), f"{len(found)} trees of {len(paths)} files"
    return found


def fault(tree, text, suffix):
    """What is wrong with a tree."""
    broken = re.search(r"\((ERROR|MISSING)[^\n]*", tree)
    if broken:
        return broken[0]
    lines = [0]
    for line in text.encode().split(b"\n"):
        lines.append(lines[-1] + len(line) + 1)
    nodes = re.findall(r"\((?:setting|declaration|statement) \[(\d+), (\d+)\]", tree)
    found = sorted({lines[int(row)] + int(column) for row, column in nodes})
    wanted = item_starts(text, suffix == ".bltl")
    if found != wanted:
        place = min(set(found) ^ set(wanted))
        return f"an item begins at byte {place} in {'the tree' if place in found else 'the rule'} only"
    return None


def main():
    smc, tree_sitter = sys.argv[1:3]
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1000
    shipped = sorted(
        path
        for folder in [ROOT / folder for folder in FOLDERS] + [ROOT.parent / "shared" / "examples"]
        for path in folder.rglob("*")
        if path.suffix in (".scn", ".bltl")
    )
    failures = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, tree in zip(shipped, trees(tree_sitter, shipped, folder)):
            wrong = fault(tree, path.read_text(), path.suffix)
            if wrong:
                failures += 1
                print(f"{path}: {wrong}")
        print(f"{len(shipped)} shipped files, {failures} with a fault")
        chance, texts, paths, tried = random.Random(54), [], [], 0
        sources = [(path.read_text(), path.suffix) for path in shipped]
        while len(texts) < count:
            tried += 1
            text, suffix = chance.choice(sources)
            text = mutant(text, chance)
            if accepted(smc, text, suffix):
                path = folder / f"{len(texts)}{suffix}"
                path.write_bytes(text.encode())
                texts.append((text, suffix))
                paths.append(path)
        wrong_mutants = 0
        for (text, suffix), tree in zip(texts, trees(tree_sitter, paths, folder)):
            wrong = fault(tree, text, suffix)
            if wrong:
                wrong_mutants += 1
                if wrong_mutants <= 5:
                    print(f"--- {wrong}\n{text}")
        print(f"{count} mutants that smc accepts, of {tried}: {wrong_mutants} with a fault")
    return 1 if failures or wrong_mutants else 0


if __name__ == "__main__":
    sys.exit(main())
