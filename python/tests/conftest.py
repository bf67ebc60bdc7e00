import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def in_the_root(monkeypatch):
    """Models are named from the root of the repository, as the command line does."""
    monkeypatch.chdir(ROOT)


@pytest.fixture
def program():
    """The command `smc` of this installation."""
    command = shutil.which("smc", path=os.pathsep.join([os.path.dirname(sys.executable), os.environ["PATH"]]))

    def call(*words: str, **more) -> subprocess.CompletedProcess:
        return subprocess.run([command, *words], capture_output=True, text=True, **more)

    return call


SMALL = """
horizon = 6 s
step = 0.05 s
param n = 2
kind adult: sfm preset helbing2000 { noise = 0.1 m/s }
agent user: adult { at = (0, 0); route = (20, 0) }
agents crowd[n]: adult { at = uniform in rect (5, -2) .. (9, 2); route = (-5, 0) }
"""


@pytest.fixture
def small():
    import smc

    return smc.Model.parse(SMALL)
