"""Figures below one another in one picture."""

from __future__ import annotations

import io
from collections.abc import Sequence

from kirisurf.errors import ParameterError
from viewers import theme

_ROOM = 30


def stacked(pictures: Sequence[bytes]) -> bytes:
    """Return pictures below one another as one, each as wide as the widest.

    Parameters
    ----------
    pictures : sequence of bytes
        PNG.

    Raises
    ------
    ParameterError
        Where there is none.

    Examples
    --------
    >>> from PIL import Image
    >>> small = io.BytesIO()
    >>> Image.new("RGB", (10, 20)).save(small, "png")
    >>> Image.open(io.BytesIO(stacked([small.getvalue()] * 2))).size
    (10, 70)
    """
    from PIL import Image

    if not pictures:
        raise ParameterError("stacked figures: expected pictures, got none")
    images = [Image.open(io.BytesIO(picture)).convert("RGB") for picture in pictures]
    width = max(image.width for image in images)
    images = [image.resize((width, round(image.height * width / image.width)), Image.LANCZOS) for image in images]
    height = sum(image.height for image in images) + _ROOM * (len(images) - 1)
    page, top = Image.new("RGB", (width, height), theme.PAPER), 0
    for image in images:
        page.paste(image, (0, top))
        top += image.height + _ROOM
    buffer = io.BytesIO()
    # with all colors: a palette for the whole page would mix those of the curves
    page.save(buffer, format="png", optimize=True)
    return buffer.getvalue()
