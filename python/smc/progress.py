"""A line that says how far a check is."""

import contextlib
import sys


@contextlib.contextmanager
def bar():
    """A bar of tqdm where that is installed, else a line on standard error."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        tqdm = None
    if tqdm is None:

        def line(query: str, trials: int, of: int | None) -> None:
            about = "" if of is None else f" of about {of}"
            print(f"\r{trials}{about} trials · {query}"[:110], end="", file=sys.stderr, flush=True)

        yield line
        print(file=sys.stderr)
        return
    with tqdm(unit=" trials") as shown:

        def tell(query: str, trials: int, of: int | None) -> None:
            if shown.desc != f"{query}: ":
                shown.reset()
                shown.set_description(query)
            shown.total = of
            shown.update(trials - shown.n)

        yield tell
