"""The pictures of one browser: what a hand does to the camera, what lies under it, and the images."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from PIL import Image

from viewers.workbench.placing import Placing, turn_and_ratio
from viewers.workbench.state import Selection
from viewers.workbench.web import camera
from viewers.workbench.web.pictures import HANDS, MOST, Pictures, numbers


@pytest.fixture
def eye():
    from vtkmodules.vtkRenderingCore import vtkCamera

    made = vtkCamera()
    made.SetParallelProjection(True)
    made.SetPosition(3.0, -4.0, 5.0)
    made.SetFocalPoint(0.5, 0.2, 0.1)
    made.SetViewUp(0.0, 0.0, 1.0)
    made.SetParallelScale(2.0)
    return made


def seen(eye, point):
    """Where a point is seen, from the middle and in shares of the height (right and down)."""
    right, up = camera._axes(eye)
    from_middle = np.array(point) - np.array(eye.GetFocalPoint())
    return np.array([from_middle @ right, -(from_middle @ up)]) / (2.0 * eye.GetParallelScale())


def test_shifting_moves_what_is_seen_by_the_drag(eye):
    point = (1.0, 1.0, -1.0)
    before = seen(eye, point)
    camera.shift(eye, 0.2, -0.1)
    assert np.allclose(seen(eye, point) - before, (0.2, -0.1))


def test_zooming_keeps_what_lies_under_the_hand(eye):
    point = (1.0, 1.0, -1.0)
    there = seen(eye, point)
    camera.zoom(eye, 1.7, *there)
    assert np.allclose(seen(eye, point), there) and eye.GetParallelScale() == pytest.approx(2.0 / 1.7)


def test_turning_keeps_the_distance_and_what_is_looked_at(eye):
    def distance():
        return np.linalg.norm(np.array(eye.GetPosition()) - np.array(eye.GetFocalPoint()))

    before, at = distance(), eye.GetFocalPoint()
    for dx, dy in ((0.3, 0.0), (0.0, 0.9), (-2.0, 1.5)):
        camera.turn(eye, dx, dy)
        right, up = camera._axes(eye)
        assert distance() == pytest.approx(before) and eye.GetFocalPoint() == at
        assert np.allclose([right @ right, up @ up, right @ up], [1.0, 1.0, 0.0])


def test_a_drag_about_the_middle_has_an_angle_and_a_ratio():
    middle = (300.0, 200.0)
    for degrees, ratio in ((30.0, 1.5), (-170.0, 0.5), (0.0, 1.0)):
        a = np.radians(20.0), np.radians(20.0 + degrees)
        first, last = (
            (middle[0] + r * np.cos(angle), middle[1] - r * np.sin(angle))
            for r, angle in zip((80, 80 * ratio), a, strict=True)
        )
        found = turn_and_ratio(tuple(map(float, first)), tuple(map(float, last)), middle)
        assert found == pytest.approx((degrees, ratio))


@pytest.mark.parametrize("bad", [{}, {"x": "1"}, {"x": None}, {"x": True}, {"x": float("inf")}, {"x": [1]}])
def test_messages_without_numbers_are_refused(bad):
    with pytest.raises(ValueError, match="expected a finite number"):
        numbers(bad, "x")


@pytest.fixture
def pictures(opengl, no_open_plotter, session):
    made = Pictures(600, 300)
    made.show(session.scenes(), True, "first")
    yield made
    made.close()


def place_of(pictures, side, point):
    """Where a point in space is drawn, in pixels from the upper left."""
    renderer = pictures.plotter.renderers[side]
    renderer.SetWorldPoint(*point, 1.0)
    renderer.WorldToDisplay()
    x, y, _ = renderer.GetDisplayPoint()
    return x, pictures.height - 1 - y


def test_a_picture_is_an_image_of_its_size_and_shows_something(pictures):
    for is_moving in (True, False):
        image = Image.open(io.BytesIO(pictures.image(is_moving)))
        assert image.format == "JPEG" and image.size == (600, 300)
        assert np.asarray(image.convert("L")).std() > 5
    pictures.resize(10**6, 1)
    assert pictures.width == MOST and pictures.height > 1


def test_what_is_hit_is_what_is_drawn_there(pictures, session):
    pictures.image(False)
    sheet = session.results.sheet
    for tile in (0, 7, 20):
        x, y = place_of(pictures, 0, session.poses.flat[sheet.tiles[tile]].mean(axis=0))
        hit = pictures.hit(x, y)
        assert (hit.side, hit.name, hit.face) == (0, "tiles", tile)
    assert pictures.hit(2.0, 2.0).face == -1


def test_turning_one_view_turns_both_until_they_are_told_not_to(pictures, session):
    pictures.turn(450.0, 100.0, 30.0, 10.0)
    assert pictures.views.is_linked
    pictures.show(session.scenes(), False, "first")
    before = pictures.views.camera(0).GetPosition()
    pictures.turn(450.0, 100.0, 30.0, 10.0)
    assert pictures.views.camera(0).GetPosition() == before != pictures.views.camera(1).GetPosition()


def test_a_new_target_is_framed_and_a_new_fit_keeps_the_users_view(pictures, session):
    pictures.zoom(450.0, 100.0, 3.0)
    zoomed = pictures.views.camera(1).parallel_scale
    pictures.show(session.scenes(), True, "first")
    assert pictures.views.camera(1).parallel_scale == zoomed
    pictures.show(session.scenes(), True, "second")
    assert pictures.views.camera(1).parallel_scale > zoomed


def test_placing_lays_while_the_hand_moves_and_fits_when_it_lets_go(session, engine):
    session.do(session.state.with_spec(session.state.spec.changed(tiles=60, cells=None)))
    placing, count = Placing(session), len(engine.asked)
    words = placing.drag(20.0, 2.0, False)
    assert words == "15 tiles, orientation 20.0\N{DEGREE SIGN}" and session.state.spec.tiles == 60
    placing.drag(30.0, 2.0, False)
    assert len(engine.asked) == count + 1, "one layout at a time"
    placing.drag(40.0, 2.0, True)
    assert (session.state.spec.orientation, session.state.spec.tiles) == (40.0, 15)
    assert engine.asked[-1] == session.state.spec


def test_a_browser_gets_images_as_it_shows_them_and_picks(visit, opengl):
    async def act(at):
        import aiohttp

        async with at.client.ws_connect(
            at.address.replace("http", "ws") + "pictures", headers={"Origin": at.origin}
        ) as ws:

            async def images(count):
                found = []
                while len(found) < count:
                    message = await ws.receive(timeout=120)
                    assert message.type in (aiohttp.WSMsgType.BINARY, aiohttp.WSMsgType.TEXT)
                    if message.type is aiohttp.WSMsgType.BINARY:
                        found.append(message.data)
                        await ws.send_str('{"kind": "shown"}')
                return found

            await ws.send_str(json.dumps({"kind": "size", "width": 600, "height": 300, "ratio": 1}))
            first = (await images(1))[0]
            assert Image.open(io.BytesIO(first)).size == (600, 300)
            await ws.send_str(json.dumps({"kind": "turn", "x": 450, "y": 100, "dx": 60, "dy": 0}))
            rough, good = await images(2)
            assert rough != first and len(good) > len(rough)
            await ws.send_str(json.dumps({"kind": "click", "x": 450, "y": 150}))
            await images(1)
            assert isinstance(at.server.session.state.selection, Selection)
            assert at.server.desk.onlookers
        # what is no message of the page ends that browser's socket, and nothing else
        for nonsense in ("[]", "{", '{"kind": "size"}', '{"kind": "shown"}', '{"kind": "size", "width": 1e999}'):
            async with at.client.ws_connect(
                at.address.replace("http", "ws") + "pictures", headers={"Origin": at.origin}
            ) as ws:
                await ws.send_str(nonsense)
                assert (await ws.receive(timeout=120)).type is aiohttp.WSMsgType.CLOSE
        assert (await at.get("?secret=x"))[0] == 200

    visit(act)


def test_every_hand_names_what_it_needs():
    assert set(HANDS) == {"turn", "shift", "zoom"}
