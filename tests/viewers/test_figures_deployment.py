"""The figure and the film of a deployment: what stands where, and that pictures tell different sheets apart."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from kirisurf.pattern import quad_pattern
from viewers import theme
from viewers.figures_deployment import FAR_APART, Curve, deployment_figure
from viewers.moving_sheet import MovingSheet, deployment_film

PLACES = np.linspace(0.0, 1.0, 21)


def curve(height: float, torsion: float = 0.0) -> Curve:
    return Curve(torsion, PLACES, height * PLACES**2, ((0.0, 0.0),), (), None, "springs back")


@pytest.fixture(scope="module")
def moving() -> MovingSheet:
    """Squares that turn and open, lying in the plane."""
    pattern = quad_pattern(2, 2)
    ends = [np.pad(state - state.mean(axis=0), ((0, 0), (0, 1))) for state in (pattern.contracted, pattern.deployed)]
    states = np.array([ends[0], 0.5 * (ends[0] + ends[1]), ends[1]])
    strains = np.linspace(0.0, 0.1, 3)[:, None] * np.linspace(0, 1, pattern.n_tiles)
    return MovingSheet(pattern.tiles, pattern.holes, states, strains, 0.1)


def opened(content: bytes) -> Image.Image:
    return Image.open(io.BytesIO(content))


def test_the_same_numbers_give_the_same_bytes(moving: MovingSheet) -> None:
    drawn = [deployment_figure([curve(1.0)], moving, [0, 10, 20], "sheet", 2e-4) for _ in range(2)]
    assert drawn[0] == drawn[1]
    assert drawn[0] != deployment_figure([curve(1.0)], moving, [0, 10, 20], "sheet")


@pytest.mark.parametrize("heights", [(1.0, 2.0), (0.0, 1.0), (0.0, 0.0), (1e-9, 1e-9)])
def test_curves_of_one_size_share_a_panel(heights: tuple[float, float], moving: MovingSheet) -> None:
    alone = opened(deployment_figure([curve(1.0)], moving, [0, 10, 20], "sheet"))
    both = opened(deployment_figure([curve(h) for h in heights], moving, [0, 10, 20], "sheet"))
    assert both.height == alone.height and both.width == alone.width


def test_curves_far_apart_stand_in_panels_of_their_own(moving: MovingSheet) -> None:
    alone = opened(deployment_figure([curve(1.0)], moving, [0, 10, 20], "sheet"))
    heights = (1.0, 1.5 * FAR_APART, 3 * FAR_APART**2)
    far = opened(deployment_figure([curve(h) for h in heights], moving, [0, 10, 20], "sheet"))
    assert far.height > 1.8 * alone.height


def test_every_curve_and_mark_is_drawn(moving: MovingSheet) -> None:
    """The color of a curve covers more of the picture once it is there, and a mark adds to it."""

    def covered(curves: list[Curve], color: str) -> int:
        picture = np.asarray(opened(deployment_figure(curves, moving, [0, 10, 20], "sheet")).convert("RGB"), int)
        wanted = [int(color[k : k + 2], 16) for k in (1, 3, 5)]
        return int((np.abs(picture - wanted).max(axis=2) < 30).sum())

    second = theme.SERIES[1]
    one, two = curve(1.0), curve(0.6, 1e-3)
    assert covered([one, two], second) > covered([one], second) + 500
    marked = replace(two, tops=((0.5, 0.15),), contact=(0.7, 0.3))
    assert covered([one, marked], second) > covered([one, two], second) + 30


def test_equilibria_past_jumps_are_a_thin_line_of_the_color_of_their_curve(moving: MovingSheet) -> None:
    def ink(branches: tuple[tuple[np.ndarray, np.ndarray], ...]) -> int:
        found = replace(curve(1.0), branches=branches)
        picture = np.asarray(opened(deployment_figure([found], moving, [0, 10, 20], "sheet")).convert("RGB"), int)
        wanted = [int(theme.SERIES[0][k : k + 2], 16) for k in (1, 3, 5)]
        return int((np.abs(picture[420:] - wanted).max(axis=2) < 90).sum())

    places = np.linspace(0.3, 0.7, 9)
    plain, one = ink(()), ink(((places, 0.7 + 0.1 * places),))
    two = ink(((places, 0.7 + 0.1 * places), (places, 0.9 - 0.1 * places)))
    assert plain + 200 < one < two - 200


def test_what_was_not_followed_is_dotted(moving: MovingSheet) -> None:
    """A jump takes ink from the curve, and only one that is said; a curve broken everywhere leaves dots alone."""

    def covered(followed: np.ndarray | None) -> int:
        found = replace(curve(1.0), followed=followed)
        picture = np.asarray(opened(deployment_figure([found], moving, [0, 10, 20], "sheet")).convert("RGB"), int)
        wanted = [int(theme.SERIES[0][k : k + 2], 16) for k in (1, 3, 5)]
        return int((np.abs(picture[420:] - wanted).max(axis=2) < 30).sum())

    everywhere = np.ones(20, bool)
    jump = everywhere.copy()
    jump[12] = False
    whole, jumped, nowhere = covered(everywhere), covered(jump), covered(~everywhere)
    assert covered(None) == whole > jumped > nowhere > 0


def test_a_path_that_ends_elsewhere_says_so(moving: MovingSheet) -> None:
    drawn = [
        deployment_figure([replace(curve(1.0), ends=ends)], moving, [0, 10, 20], "sheet") for ends in (1.0, 0.999, 0.9)
    ]
    assert drawn[0] == drawn[1] != drawn[2]


def test_a_sheet_that_lies_low_takes_a_lower_page(moving: MovingSheet) -> None:
    low = replace(moving, states=moving.states * np.array([1.0, 0.3, 1.0]))
    pages = [opened(deployment_figure([curve(1.0)], sheet, [0, 10, 20], "sheet")) for sheet in (moving, low)]
    assert pages[1].height < pages[0].height and pages[1].width == pages[0].width


def test_the_film_has_a_scale_where_there_is_strain(moving: MovingSheet) -> None:
    def corner(sheet: MovingSheet) -> np.ndarray:
        film = opened(deployment_film(sheet, np.array([0.0, 0.5, 1.0]), 1e-3, "free", 400))
        return np.asarray(film.convert("RGB"), int)[-30:, -140:]

    plain = corner(replace(moving, largest_strain=0.0, strains=0 * moving.strains))
    assert (plain == 255).all() and (corner(moving)[..., 2] < 120).sum() > 100


def test_strain_colors_the_tiles_and_no_strain_leaves_paper(moving: MovingSheet) -> None:
    size = (300, 300)
    strained = np.asarray(moving.picture(2, size), int)
    plain = np.asarray(replace(moving, largest_strain=1e-12, strains=moving.strains * 1e-11).picture(2, size), int)
    assert strained.shape == plain.shape == (300, 300, 3)
    redness = [float((picture[..., 0] - picture[..., 1]).max()) for picture in (strained, plain)]
    assert redness[0] > 90 > 40 > redness[1]


def test_all_states_are_drawn_at_one_scale(moving: MovingSheet) -> None:
    """The flat sheet covers as many pixels of tiles as the deployed one: rigid tiles keep their area."""
    plain = replace(moving, largest_strain=0.0, strains=0 * moving.strains)
    areas = [(np.asarray(plain.picture(k, (400, 400)).convert("L")) < 250).sum() for k in (0, 2)]
    assert areas[0] == pytest.approx(areas[1], rel=0.03)
    width, height = plain.extent
    assert width == pytest.approx(height, rel=1e-9)


def test_the_film_opens_and_closes(moving: MovingSheet) -> None:
    film = opened(deployment_film(moving, np.array([0.0, 0.5, 1.0]), 1e-3, "free", 160))
    assert film.n_frames == 4 and film.size[0] == 160
    frames = []
    for k in range(4):
        film.seek(k)
        frames.append(np.asarray(film.convert("RGB"), int))
    assert np.abs(frames[1] - frames[3]).max() == 0
    assert (frames[0] != frames[1]).any() and (frames[1] != frames[2]).any()


def test_sheets_do_not_cover_each_other_whatever_their_places(moving: MovingSheet) -> None:
    """States that are close on the curve are drawn as whole as those that are far apart."""

    def strip(places: np.ndarray) -> np.ndarray:
        found = replace(curve(1.0), places=places)
        picture = np.asarray(opened(deployment_figure([found], moving, [0, 10, 20], "sheet")).convert("L"), int)
        return picture[165:400]

    bent = PLACES**0.05
    bent[0] = 0.0
    # the palette of the file may differ a little
    assert (np.abs(strip(PLACES) - strip(bent)) > 20).mean() < 1e-3
