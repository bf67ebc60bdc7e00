"""Pages in notebooks: in a frame that can neither send anything nor read the notebook."""

import html

MOST = 8 << 20
"""The largest page that is put into a notebook, bytes."""


def framed(page: str, save: str) -> str:
    """A page as a frame; a sentence for one that is too large."""
    if len(page.encode()) > MOST:
        size = len(page.encode()) >> 20
        return f"<p>The page has {size} MB, too many for a notebook. Save it: <code>{html.escape(save)}</code></p>"
    return (
        '<iframe sandbox="allow-scripts" style="width: 100%; height: 640px; border: 0" '
        f'srcdoc="{html.escape(page, quote=True)}"></iframe>'
    )
