"""Names that users give: what is the name of something built in, and what is a file."""

from __future__ import annotations

import re


def is_file_name(text: str) -> bool:
    """Return whether a name has a folder or a suffix, as files do and built-in names do not.

    Examples
    --------
    >>> is_file_name("hood.stl"), is_file_name("./hood"), is_file_name("hood")
    (True, True, False)
    """
    return bool(re.search(r"[./\\]", text))
