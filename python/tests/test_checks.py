"""Checks from Python are those of the command line."""

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
import smc
from conftest import ROOT, SMALL

CHECK = "check P(F<=6 s (travelled(user) > 4 m)) >= 0.8\nestimate P(F<=6 s contact(user)) within 0.1\n"
PAIRS = sorted(path.stem for path in (ROOT / "models").glob("*.scn") if (ROOT / "properties" / f"{path.stem}.bltl").is_file())


def timeless(text: str) -> str:
    return re.sub(r'"elapsed_s": [-+0-9.e]+', '"elapsed_s": 0', text)


@pytest.mark.parametrize("name", PAIRS)
def test_json_has_the_same_bytes_as_that_of_the_command_line(name, program):
    model, properties = f"models/{name}.scn", f"properties/{name}.bltl"
    data = [str(folder) for folder in (Path("../shared/data/eth-biwi"),) if folder.is_dir()]
    more = [word for folder in data for word in ("--data", folder)]
    said = program("check", model, properties, *more, "--max-trials", "40", "--seed", "3", "--format", "json", "-q")
    if said.returncode == 2 and "does not exist" in said.stderr:
        pytest.skip("its recording is not on this machine")
    report = smc.Model(model, data=data).check(properties, seed=3, max_trials=40)
    assert timeless(report.json).strip() == timeless(said.stdout).strip()


def test_a_report_has_results(small):
    report = small.check(text=CHECK, seed=5)
    first, second = report
    assert (first.verdict, second.verdict) == ("satisfied", None)
    assert first.low >= 0.8 - 1e-9 or first.low <= first.estimate <= first.high
    assert second.low <= second.estimate <= second.high and second.high - second.low <= 0.2 + 1e-12
    assert first.certificate.startswith("P(F<=6 s (travelled(user) > 4 m)) >= 0.8, error at most 0.01")
    assert first.trials == first["trials"] and first.stopped_by == "boundary"
    assert report.satisfied and not report.interrupted and len(report) == 2
    assert str(report).count("satisfied") >= 1 and "P(F<=6 s contact(user))" in str(report)
    with pytest.raises(AttributeError, match="a result has no `verdct`"):
        _ = first.verdct


def test_rankings_have_options_and_evidence(small):
    model = smc.Model.parse(SMALL + "moves user for 2 s { stop; heading 30 deg }\n")
    report = model.check(text="rank moves of user by P(F<=6 s (travelled(user) > 5 m)) within 0.2", evidence=True)
    labels = {option["option"] for option in report[0].options}
    assert labels == {"own way", "stop", "heading 30 deg"}
    assert report[0].evidence


def test_parameters_and_sweeps(small):
    pandas = pytest.importorskip("pandas")
    report = small.with_(n="1, 3").check(text="estimate P(F<=6 s contact(user)) by okamoto(epsilon = 0.2, delta = 0.1)")
    frame = report.to_pandas()
    assert list(frame["n"]) == [1, 3] and isinstance(frame, pandas.DataFrame)
    assert list(frame["estimate"]) == [result.estimate for result in report]
    assert len(small.with_(n=3).agents) == 4 and len(small.agents) == 3


def test_errors_are_those_of_the_command_line(small, tmp_path, program):
    wrong = SMALL.replace("helbing2000", "helbing2001")
    with pytest.raises(smc.Diagnostics) as caught:
        smc.Model.parse(wrong)
    error = caught.value
    (tmp_path / "model.scn").write_text(wrong)
    said = program("show", "model.scn", cwd=tmp_path)
    assert str(error) == said.stderr.strip()
    assert (error.code, error.place) == ("E0208", "model.scn:5:24") and "did you mean" in error.hint
    assert pickle.loads(pickle.dumps(error)).errors == error.errors
    for text in ("check P(nobody) >= 0.5", "check P(", "estimate E(1 m)"):
        with pytest.raises(smc.Diagnostics):
            small.check(text=text)
    with pytest.raises(smc.Diagnostics, match="the scenario declares n"):
        small.with_(m=3)
    with pytest.raises(smc.Diagnostics):
        small.with_(n="2 parsek")
    with pytest.raises(TypeError):
        small.check()
    (tmp_path / "latin.scn").write_bytes(b"\xff\xfe")
    with pytest.raises(smc.Diagnostics, match="is not UTF-8"):
        smc.Model(tmp_path / "latin.scn")
    with pytest.raises(FileNotFoundError):
        smc.Model("nowhere.scn")
    with pytest.raises(smc.Diagnostics, match="no query is about"):
        small.check(text=CHECK, only="other")


def test_models_are_shared_by_threads_processes_and_pickles(small):
    wanted = timeless(small.check(text=CHECK, seed=5).json)
    found = [None, None]

    def work(k):
        found[k] = timeless(small.check(text=CHECK, seed=5).json)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert found == [wanted, wanted]
    assert timeless(pickle.loads(pickle.dumps(small)).check(text=CHECK, seed=5).json) == wanted
    child = os.fork()
    if child == 0:
        is_same = timeless(small.check(text=CHECK, seed=5).json) == wanted
        os._exit(0 if is_same else 1)
    assert os.waitpid(child, 0)[1] == 0


def test_progress_is_told_and_its_errors_are_raised(small):
    told = []
    small.check(text=CHECK, progress=lambda query, trials, of: told.append((query, trials)))
    assert told and told[-1][1] > 0
    with pytest.raises(ZeroDivisionError):
        small.check(text=CHECK, progress=lambda *_: 1 / 0)


def test_an_interruption_leaves_what_was_found(small):
    def interrupt(query, trials, of):
        if trials > 0:
            os.kill(os.getpid(), signal.SIGINT)

    text = "estimate P(F<=6 s contact(user)) within 0.0005\nestimate P(F<=6 s (travelled(user) > 4 m)) within 0.0005"
    report = small.check(text=text, progress=interrupt)
    assert report.interrupted and report[0].stopped_by == "interrupt"
    assert report[0].trials > 0 and 0 < report[0].high - report[0].low < 1
    assert report[1].low <= report[1].high


def test_python_runs_while_trials_do(small):
    ticks = []
    done = threading.Event()

    def count():
        while not done.is_set():
            ticks.append(None)
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    small.check(text="estimate P(F<=6 s contact(user)) within 0.02")
    done.set()
    counter.join()
    assert len(ticks) > 10


def test_the_command_is_the_program(tmp_path, program):
    (tmp_path / "a.scn").write_text(SMALL)
    (tmp_path / "a.bltl").write_text("check P(F<=6 s (travelled(user) > 40 m)) >= 0.8")
    assert program("--version").stdout.startswith("smc ")
    said = program("check", "a.scn", "a.bltl", cwd=tmp_path)
    assert said.returncode == 1 and "violated" in said.stdout
    assert program("check", "a.scn", "b.bltl", cwd=tmp_path).returncode == 2
    module = subprocess.run([sys.executable, "-m", "smc", "--version"], capture_output=True, text=True)
    assert module.stdout == program("--version").stdout


def test_pages(small, tmp_path):
    report = small.check(text=CHECK, seed=5)
    report.save(tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert page.startswith("<!doctype html>") and "contact(user)" in page
    report.save(tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text()) == report.to_dict()
    framed = report._repr_html_()
    assert framed.startswith('<iframe sandbox="allow-scripts"') and "<script" not in framed
    framed = small.trial(2)._repr_html_()
    assert framed.startswith("<iframe") and "&lt;!doctype html&gt;" in framed


def test_a_page_that_is_too_large_is_not_put_into_a_notebook(small, monkeypatch):
    monkeypatch.setattr("smc.page.MOST", 1000)
    assert "report.save(&quot;report.html&quot;)" in small.check(text=CHECK)._repr_html_()


def test_another_program_runs_only_where_it_is_allowed():
    with pytest.raises(smc.Diagnostics, match="would run `sh coin.sh"):
        smc.Model("examples/programs/coin.scn").check("examples/programs/coin.bltl", only="0")
    model = smc.Model("examples/programs/coin.scn", allow_run=True)
    assert model.check("examples/programs/coin.bltl", only="0")[0].verdict == "satisfied"
