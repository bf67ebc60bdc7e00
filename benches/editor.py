"""The language server under random edits: `python3 benches/editor.py SMC [EDITS] [FILE]`.

Scenarios and property files that ship are opened and edited at random, as an impatient writer would: characters and words go,
come twice or change places, lines are joined and torn, brackets are lost. After each edit the errors are awaited, and some question
is asked at a random place: hover, completion, definition, references, symbols, tokens, lenses, formatting, remedies. The table says
how long answers take, and how the memory grows. A server that dies ends the program.
"""

import collections
import json
import pathlib
import random
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
QUESTIONS = ["hover", "completion", "definition", "references", "documentSymbol", "semanticTokens/full", "codeLens", "formatting", "codeAction", "foldingRange"]
OPTIONS = {"tabSize": 2, "insertSpaces": True}


class Server:
    """A language server that is spoken to over its standard input and output."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.last = 0
        self.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}, "initializationOptions": {"data": [str(ROOT.parent / "shared" / "data")]}})
        self.tell("initialized", {})

    def send(self, message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def read(self):
        length = 0
        while line := self.process.stdout.readline().strip():
            if line.lower().startswith(b"content-length:"):
                length = int(line.split(b":")[1])
        if not length:
            sys.exit(f"the server has ended with {self.process.wait()}")
        return json.loads(self.process.stdout.read(length))

    def tell(self, method, parameters):
        self.send({"method": method, "params": parameters})

    def ask(self, method, parameters):
        self.last += 1
        self.send({"id": self.last, "method": method, "params": parameters})
        while (message := self.read()).get("id") != self.last or "method" in message:
            pass
        return message

    def errors(self, uri):
        while (message := self.read()).get("method") != "textDocument/publishDiagnostics" or message["params"]["uri"] != uri:
            pass

    def memory(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0]) / 1024


def edited(text, chance):
    """One random edit of a text."""
    at, to = sorted(chance.randrange(len(text) + 1) for _ in range(2))
    to = min(to, at + chance.choice([1, 1, 1, 5, 40]))
    lines = text.split("\n")
    k = chance.randrange(len(lines))
    kind = chance.randrange(7)
    if kind == 0:
        return text[:at] + text[to:]
    if kind == 1:
        return text[:at] + text[at:to] * 2 + text[to:]
    if kind == 2:
        return text[:at] + chance.choice(["(", ")", "{", "}", "[", "]", '"', " ", "\n", "é", "𝄞", "/*", "*/", "//", "\r\n", ";", ",", " 3 m ", " user ", " forall "]) + text[at:]
    if kind == 3:
        return "\n".join(lines[:k] + lines[k + 1 :])
    if kind == 4:
        return "\n".join([*lines[:k], lines[chance.randrange(len(lines))], *lines[k:]])
    if kind == 5:
        words = lines[k].split(" ")
        chance.shuffle(words)
        return "\n".join([*lines[:k], " ".join(words), *lines[k + 1 :]])
    return text[:at] + text[at:to][::-1] + text[to:]


def main(program, edits, only):
    chance, server = random.Random(7), Server(program)
    texts = {}
    if only and (path := pathlib.Path(only).resolve()).is_file():
        texts[path.as_uri()] = (path.suffix[1:], path.read_text())
    for folder, ending in (("models", "scn"), ("properties", "bltl")):
        for path in sorted((ROOT / folder).glob(f"*.{ending}")):
            if only is None:
                texts[path.as_uri()] = (ending, path.read_text())
    times, before, version = collections.defaultdict(list), None, 0
    for uri in list(texts):
        language, text = texts[uri]
        server.tell("textDocument/didOpen", {"textDocument": {"uri": uri, "languageId": language, "version": 0, "text": text}})
        server.errors(uri)
        for _ in range(-(-edits // len(texts))):
            # Most edits follow others; now and then the text is whole again.
            text = edited(text if chance.random() < 0.9 and text else texts[uri][1], chance)
            version += 1
            start = time.perf_counter()
            server.tell("textDocument/didChange", {"textDocument": {"uri": uri, "version": version}, "contentChanges": [{"text": text}]})
            server.errors(uri)
            times["errors"].append(time.perf_counter() - start)
            line = chance.randrange(text.count("\n") + 1)
            place = {"line": line, "character": chance.randrange(60)}
            asked = chance.choice(QUESTIONS)
            context = {"references": {"includeDeclaration": True}, "codeAction": {"diagnostics": []}}.get(asked)
            extra = {"options": OPTIONS, "range": {"start": place, "end": place}} | ({"context": context} if context else {})
            start = time.perf_counter()
            answer = server.ask(f"textDocument/{asked}", {"textDocument": {"uri": uri}, "position": place, **extra})
            if "error" in answer:
                sys.exit(f"{asked}: {answer['error']}")
            times[asked].append(time.perf_counter() - start)
            if version == edits // 10:
                before = server.memory()
        server.tell("textDocument/didClose", {"textDocument": {"uri": uri}})
    print(f"{version} edits of {len(texts)} files; memory {before or 0:.0f} MB after a tenth, {server.memory():.0f} MB at the end")
    print("| answer | number | median ms | 99 % ms | longest ms |\n| --- | --- | --- | --- | --- |")
    times["all"] = [one for all_of in times.values() for one in all_of]
    for name, all_of in times.items():
        all_of.sort()
        figures = [all_of[len(all_of) // 2], all_of[int(0.99 * (len(all_of) - 1))], all_of[-1]]
        print(f"| {name} | {len(all_of)} | {' | '.join(f'{1000 * figure:.1f}' for figure in figures)} |")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10_000, sys.argv[3] if len(sys.argv) > 3 else None)
