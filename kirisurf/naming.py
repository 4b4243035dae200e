"""Names that users give: what is the name of something built in, and what is a file."""

from __future__ import annotations

import re
import unicodedata


def is_file_name(text: str) -> bool:
    """Return whether a name has a folder or a suffix, as files do and built-in names do not.

    Examples
    --------
    >>> is_file_name("hood.stl"), is_file_name("./hood"), is_file_name("hood")
    (True, True, False)
    """
    return bool(re.search(r"[./\\]", text))


def printable(name: str, kept: str = "") -> str:
    r"""Return a name as it may stand in a message, a page or an XML file: what cannot be printed becomes its escape.

    Names of files may hold line ends, what steers a terminal, and bytes that are no text.

    Parameters
    ----------
    name : str
    kept : str
        Characters that stay although they cannot be printed.

    Examples
    --------
    >>> printable("größe 1.obj"), printable("a" + chr(10) + "b")
    ('größe 1.obj', 'a\\nb')
    """
    if name.isprintable():
        return name
    return "".join(
        c if c.isprintable() or c in kept else " " if unicodedata.category(c) == "Zs" else repr(c)[1:-1] for c in name
    )
