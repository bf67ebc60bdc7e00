"""Statistical model checking of people in motion.

>>> import smc
>>> model = smc.Model("models/corridor.scn")
>>> report = model.check("properties/corridor.bltl", seed=1)
>>> print(report)

Lengths are in m, times in s, speeds in m/s. Errors of texts are `smc.Diagnostics`, with the words of the program.
"""

from ._smc import __version__
from .errors import Diagnostics
from .model import Model
from .report import Report, Result
from .trial import Trial

__all__ = ["Diagnostics", "Model", "Report", "Result", "Trial", "__version__"]
