"""Pictures below one another."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from kirisurf.errors import ParameterError
from viewers.figures_stacked import stacked


def picture(width: int, height: int, color: str) -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", (width, height), color).save(buffer, "png")
    return buffer.getvalue()


def test_pictures_lie_in_order_at_one_width() -> None:
    page = np.asarray(Image.open(io.BytesIO(stacked([picture(20, 10, "red"), picture(10, 10, "blue")]))).convert("RGB"))
    assert page.shape == (10 + 30 + 20, 20, 3)
    assert (page[:10] == (255, 0, 0)).all() and (page[-20:] == (0, 0, 255)).all() and (page[10:40] == 255).all()


def test_no_picture_is_refused() -> None:
    with pytest.raises(ParameterError, match="expected pictures, got none"):
        stacked([])
