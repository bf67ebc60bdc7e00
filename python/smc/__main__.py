"""The command `smc`, also `python -m smc`."""

import signal
import sys

from ._smc import command


def main() -> None:
    # The program handles signals itself: the first interruption ends sampling, and the results so far are printed.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(command(["smc", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
