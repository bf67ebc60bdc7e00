"""The notebooks of `python/examples` run, and show what they should."""

from pathlib import Path

import pytest
from conftest import ROOT

nbformat = pytest.importorskip("nbformat")
preprocessors = pytest.importorskip("nbconvert.preprocessors")
for library in ("ipykernel", "matplotlib", "pandas", "pedpy"):
    pytest.importorskip(library)

SHOWN = {
    "corridor": ["satisfied", "chosen", "<iframe sandbox="],
    "sweep": ["density", "image/png"],
    "controller": ["certified: P(safe) in", "distance(robot, a) > 0.7 m"],
    "driver": ["given: the given drivers of robot", "<iframe sandbox="],
    "recording": ["people, mean speed", "P(G<=4.8 s", "simulated: "],
}


@pytest.mark.parametrize("path", sorted((ROOT / "python/examples").glob("*.ipynb")), ids=lambda path: Path(path).stem)
def test_a_notebook_runs(path):
    book = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells), "notebooks are kept without outputs"
    preprocessors.ExecutePreprocessor(timeout=300, kernel_name="python3").preprocess(book, {"metadata": {"path": str(ROOT)}})
    shown = str([cell.outputs for cell in book.cells if cell.cell_type == "code"])
    for wanted in SHOWN[path.stem]:
        assert wanted in shown, f"{wanted}: {shown[:2000]}"
