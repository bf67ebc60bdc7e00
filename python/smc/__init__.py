"""Statistical model checking of people in motion.

>>> import smc
>>> model = smc.Model("models/corridor.scn")
>>> report = model.check("properties/corridor.bltl", seed=1)
>>> print(report)

Lengths are in m, times in s, speeds in m/s. Errors of texts are `smc.Diagnostics`, with the words of the program.
"""

from ._smc import Situation, __version__
from .errors import Diagnostics
from .model import Model
from .report import Report, Result
from .trial import Trial


def __getattr__(name: str):
    # Numpy, and Gymnasium where that is installed, take longer to import than all the rest.
    if name == "Env":
        from .env import Env

        return Env
    raise AttributeError(f"module `smc` has no attribute `{name}`")

__all__ = ["Diagnostics", "Env", "Model", "Report", "Result", "Situation", "Trial", "__version__"]
