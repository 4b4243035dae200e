"""Cutting files and solids of a finished run, read back from the disk: every length is the contracted pattern's."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import pyvista
import scipy.spatial
import trimesh

import kirisurf
from kirisurf.errors import ParameterError
from kirisurf.exporting import check_free, export, export_with_remarks
from kirisurf.fabrication import Fabrication, cut_lines, quarter_turned
from kirisurf.field_units import unit_of_field
from kirisurf.formats import read_fields
from kirisurf.judging import measured, origin_of
from kirisurf.runs import Run
from kirisurf.runs.run import RUN_BLOCKS
from kirisurf.sheet import Sheet
from kirisurf.surface import Surface

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("runs") / "hypar"
    return kirisurf.fit("hypar", cells=(3, 2), units="cm").save(folder, pictures=False)


def length(line: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def closed(loop: np.ndarray) -> np.ndarray:
    return np.vstack([loop, loop[:1]])


def nominal_lengths(run: Run) -> tuple[float, float]:
    """Length of all slits from hinge to hinge, and of the outline, from the tiles alone."""
    points, tessellation = run.contracted, run.tessellation
    a, b = points[tessellation.edge_pairs[:, 0]].swapaxes(0, 1)
    tiles = [closed(points[tile]) for tile in tessellation.tiles]
    slits = float(np.linalg.norm(b - a, axis=1).sum())
    return slits, sum(map(length, tiles)) - 2 * slits


def read_svg(path: Path) -> tuple[dict[str, list[np.ndarray]], np.ndarray, str]:
    root = ElementTree.parse(path).getroot()
    unit = root.attrib["width"].lstrip("0123456789.e-")
    page = np.array([float(root.attrib[side].removesuffix(unit)) for side in ("width", "height")])
    assert [float(x) for x in root.attrib["viewBox"].split()] == [0.0, 0.0, *page]
    layers = {}
    for group in root.findall(f"{SVG}g"):
        found = []
        for path_element in group.findall(f"{SVG}path"):
            words = path_element.attrib["d"]
            line = np.array([[float(x) for x in pair.split(",")] for pair in words.strip("MZ ").split(" L ")])
            found.append(closed(line) if words.endswith("Z") else line)
        layers[group.attrib["id"]] = found
    return layers, page, unit


def read_dxf(path: Path) -> tuple[dict[str, list[np.ndarray]], int]:
    document = ezdxf.readfile(path)
    assert document.audit().errors == []
    layers: dict[str, list[np.ndarray]] = {"CUT": [], "OUTLINE": []}
    for line in document.modelspace().query("LWPOLYLINE"):
        points = np.array(list(line.get_points("xy")))
        layers[line.dxf.layer].append(closed(points) if line.closed else points)
    return layers, document.header["$INSUNITS"]


@pytest.mark.parametrize("scale", [1.0, 25.4])
def test_svg_and_dxf_have_the_lengths_of_the_contracted_pattern(run: Run, tmp_path: Path, scale: float) -> None:
    making = Fabrication(hinge_width=0.02 * scale, scale=scale)
    svg, _, unit = read_svg(export(run, tmp_path / "a.svg", making=making))
    dxf, code = read_dxf(export(run, tmp_path / "a.dxf", making=making))
    slits, outline = nominal_lengths(run)
    expected = scale * (slits - 0.02 * int(run.tessellation.slit_ends.sum()))
    assert unit == "cm" and code == 5
    for cut, rim in ((svg["cut"], svg["outline"]), (dxf["CUT"], dxf["OUTLINE"])):
        assert sum(map(length, cut)) == pytest.approx(expected, rel=1e-10)
        assert sum(map(length, rim)) == pytest.approx(scale * outline, rel=1e-10)
        assert len(cut) == run.result["slits"] and len(rim) == 1
    for drawn, line in zip(svg["cut"], dxf["CUT"], strict=True):
        assert length(drawn) == pytest.approx(length(line), rel=1e-9)


def test_a_kerf_moves_the_outline_out_and_shortens_every_slit(run: Run, tmp_path: Path) -> None:
    kerf = 0.004
    plain, _ = read_dxf(export(run, tmp_path / "a.dxf", hinge_width=0.02))
    made, _ = read_dxf(export(run, tmp_path / "b.dxf", making=Fabrication(hinge_width=0.02, kerf=kerf)))
    for line, shorter in zip(plain["CUT"], made["CUT"], strict=True):
        assert length(shorter) <= length(line) - 0.5 * kerf
    outer, inner = made["OUTLINE"][0], plain["OUTLINE"][0]
    assert np.ptp(outer, axis=0) == pytest.approx(np.ptp(inner, axis=0) + kerf, abs=kerf)
    assert (outer.max(axis=0) > inner.max(axis=0)).all() and (outer.min(axis=0) < inner.min(axis=0)).all()


@pytest.mark.parametrize("turned", [False, True])
def test_the_largest_scale_fills_the_sheet(run: Run, tmp_path: Path, turned: bool) -> None:
    width, height = np.ptp(run.contracted, axis=0)
    sheet = Sheet(*(40.0, 40.0 * height / width)[:: -1 if turned else 1])
    making = Fabrication(scale="max", sheet=sheet, kerf=0.02)
    written = export_with_remarks(run, tmp_path / "a.svg", making=making)
    layers, page, _ = read_svg(written.path)
    assert written.placement is not None and written.placement.turned == turned
    assert page == pytest.approx(sheet.size)
    low, high = layers["outline"][0].min(axis=0) - 0.01, layers["outline"][0].max(axis=0) + 0.01
    assert low.min() >= -1e-9 and (high <= page + 1e-9).all()
    assert low == pytest.approx(page - high, abs=1e-9)  # in the middle
    assert min((low / page).min(), ((page - high) / page).min()) < 1e-9 and high - low == pytest.approx(
        np.array(written.placement.size)
    )


def test_a_sheet_that_is_too_small_is_refused_with_the_scale_that_fits(run: Run, tmp_path: Path) -> None:
    sheet = Sheet(1.0, 0.7)
    with pytest.raises(ParameterError, match=r"--fit-sheet: expected a sheet of at least .*, got 1x0.7") as caught:
        export(run, tmp_path / "a.svg", making=Fabrication(sheet=sheet))
    assert not list(tmp_path.iterdir())
    scale = float(str(caught.value).rpartition(" ")[2])
    export(run, tmp_path / "a.svg", making=Fabrication(sheet=sheet, scale=scale))
    with pytest.raises(ParameterError, match="largest --scale"):
        export(run, tmp_path / "b.svg", making=Fabrication(sheet=sheet, scale=1.001 * scale))
    with pytest.raises(ParameterError, match="no scale fits"):
        making = Fabrication(sheet=Sheet(0.01, 0.01), kerf=0.02, hinge_width=0.05)
        export(run, tmp_path / "b.svg", making=making)


def test_a_solid_is_watertight_and_to_scale(run: Run, tmp_path: Path) -> None:
    making = Fabrication(scale=30.0, thickness=2.0, hinge_thickness=0.5, hinge_width=0.8, gap=0.4)
    written = export_with_remarks(run, tmp_path / "a.stl", making=making)
    mesh = trimesh.load(written.path, process=False)
    mesh.merge_vertices(digits_vertex=12)
    assert mesh.is_watertight and mesh.is_volume and mesh.body_count == 1
    # where a slit begins at an outermost corner, its width takes that corner
    assert mesh.extents == pytest.approx([*30.0 * np.ptp(run.contracted, axis=0), 2.0], abs=0.2)
    assert written.placement is not None
    assert (mesh.extents[:2] <= np.array(written.placement.size) + 1e-5).all()
    tiles = 30.0**2 * sum(tile_area(run.contracted[tile]) for tile in run.tessellation.tiles)
    assert 0.8 * 2.0 * tiles < mesh.volume < 2.0 * tiles


def tile_area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_the_surface_of_a_state_is_still_what_stl_means_without_a_thickness(run: Run, tmp_path: Path) -> None:
    mesh = trimesh.load(export(run, tmp_path / "a.stl", "deployed"), process=False)
    assert mesh.area == pytest.approx(sum(tile_area(run.contracted[tile]) for tile in run.tessellation.tiles), rel=1e-5)


def test_hinges_too_wide_for_some_slits_are_said(run: Run, tmp_path: Path) -> None:
    lines, _ = cut_lines(run, Fabrication())
    widest = max(length(line) for line in lines.whole)
    with pytest.raises(ParameterError, match="at most") as caught:
        export(run, tmp_path / "a.svg", hinge_width=10 * widest)
    most = float(str(caught.value).partition("at most ")[2].partition(" ")[0])
    written = export_with_remarks(run, tmp_path / "a.dxf", making=Fabrication(hinge_width=0.999 * most))
    assert len(written.warnings) == 1 and "hinges are narrower than" in written.warnings[0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"thickness": -1.0}, "--thickness: expected a number above 0, got -1.0"),
        ({"thickness": 1.0, "hinge_thickness": 2.0}, "--hinge-thickness: expected at most the thickness 1, got 2"),
        ({"hinge_thickness": 2.0}, "--hinge-thickness: expected together with --thickness"),
        ({"gap": 2.0}, "--gap: expected together with --thickness"),
        ({"kerf": 0.3, "hinge_width": 0.3}, "--kerf: expected less than the hinge width 0.3, got 0.3"),
        ({"kerf": -0.3}, "--kerf: expected a number from 0, got -0.3"),
        ({"scale": 0.0}, "--scale: expected a number above 0 or max, got 0.0"),
        ({"scale": "fit"}, "--scale: expected a number above 0 or max, got 'fit'"),
        ({"scale": "max"}, "--scale max: expected together with --fit-sheet"),
        ({"units": "parsec"}, "--units: expected one of um, mm"),
        ({"hinge_width": float("inf")}, "--hinge-width: expected a number above 0"),
    ],
    ids=str,
)
def test_wrong_choices_are_refused(values: dict, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Fabrication(**values)


def test_the_pattern_of_a_run_is_made_for_its_kerf(tmp_path: Path) -> None:
    design = kirisurf.fit("hypar", cells=(2, 2), hinge_width=0.03, kerf=0.005)
    run = design.save(tmp_path / "kerf", pictures=False)
    assert run.result["kerf"] == 0.005 and run.result["exit_code"] == 0
    layers, _, _ = read_svg(run.folder / "pattern.svg")
    lines, placement = cut_lines(run, Fabrication())
    assert lines.kerf == 0.005 and placement.scale == 1
    for drawn, line in zip(layers["cut"], lines.slits, strict=True):
        assert length(drawn) == pytest.approx(length(line), rel=1e-9)
    plain, _ = cut_lines(run, Fabrication(kerf=0.0))
    assert sum(map(length, lines.slits)) < sum(map(length, plain.slits)) - 0.0025 * len(lines.hinges)


def test_a_quarter_turn_is_no_mirror() -> None:
    assert quarter_turned(np.array([[1.0, 0], [0, 1]])) == pytest.approx(np.array([[0.0, 1], [-1, 0]]))


def test_blocks_are_the_files_of_the_run(run: Run, tmp_path: Path) -> None:
    blocks = pyvista.read(export(run, tmp_path / "s.vtm"))
    assert blocks.keys() == ["tiles", "holes", "target", "contracted"]
    for name, file in RUN_BLOCKS.items():
        assert (tmp_path / "s_vtm" / f"{name}.vtp").read_bytes() == (run.folder / file).read_bytes()
    inside = pyvista.read(run.folder / "run.vtm")
    assert inside.keys() == blocks.keys()
    for ours, theirs in zip(inside, blocks, strict=True):
        assert np.array_equal(ours.points, theirs.points) and ours.array_names == theirs.array_names


@pytest.mark.parametrize("n", [2, 6])
def test_a_series_opens_every_hole_and_ends_on_the_deployed_sheet(run: Run, tmp_path: Path, n: int) -> None:
    reader = pyvista.get_reader(export(run, tmp_path / "o.pvd", frames=n))
    assert reader.time_values == pytest.approx(np.linspace(0, 1, n), abs=0)
    angles, strains, states = [], [], []
    for time in reader.time_values:
        reader.set_active_time_value(time)
        tiles, holes = reader.read()
        assert tiles.n_cells == run.tessellation.n_tiles and holes.n_cells == len(run.tessellation.holes)
        angles.append(holes.cell_data["opening_angle"])
        strains.append(tiles.cell_data["isometry"].max())
        states.append(str(tiles.field_data["state"][0]))
        assert tiles.field_data["share"] == pytest.approx(time) and tiles.field_data["unit_of_length"][0] == "cm"
    assert np.array_equal(tiles.points, run.deployed)
    assert angles[-1] == pytest.approx(run.fields["hole", "opening_angle"], abs=1e-12)
    assert (np.diff(angles, axis=0) > 0).all() and np.abs(angles[0]).max() < 1e-6
    assert strains[0] < 1e-9 and strains[-1] < 1e-9
    assert [("not a mechanism" in state) for state in states] == [0 < time < 1 for time in reader.time_values]


def test_the_closed_frame_is_the_contracted_sheet_moved_rigidly(run: Run, tmp_path: Path) -> None:
    export(run, tmp_path / "o.pvd", frames=2)
    closed = pyvista.read(tmp_path / "o_pvd" / "0000_tiles.vtp").points
    flat = np.column_stack([run.contracted, np.zeros(len(run.contracted))])
    assert scipy.spatial.distance.pdist(closed) == pytest.approx(scipy.spatial.distance.pdist(flat), abs=1e-12)
    assert closed.mean(axis=0) == pytest.approx(run.deployed.mean(axis=0), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("a.pvd", {"frames": 1}, "--frames: expected a number from 2 to 1000, got 1"),
        ("a.pvd", {"frames": 1001}, "--frames: expected a number from 2 to 1000, got 1001"),
        ("a.pvd", {"state": "deployed"}, "expected no --state for .pvd, which holds both, got deployed"),
        ("a.vtm", {"state": "contracted"}, "expected no --state for .vtm, which holds both, got contracted"),
    ],
)
def test_wrong_choices_for_blocks_and_series(run: Run, tmp_path: Path, name: str, options: dict, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        export(run, tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_pieces_that_are_in_the_way_are_said(run: Run, tmp_path: Path) -> None:
    export(run, tmp_path / "a.vtm")
    (tmp_path / "a.vtm").unlink()
    with pytest.raises(ParameterError, match="a_vtm: expected a new folder, got one that exists; --overwrite"):
        check_free([tmp_path / "a.vtm"], run.folder, overwrite=False)
    check_free([tmp_path / "a.vtm"], run.folder, overwrite=True)
    (tmp_path / "a_vtm" / "notes.txt").write_text("mine")
    with pytest.raises(ParameterError, match=r"a_vtm: expected a new folder for the pieces of a\.vtm, got one with"):
        check_free([tmp_path / "a.vtm"], run.folder, overwrite=True)


def test_a_far_target_has_its_origin_in_every_file(tmp_path: Path) -> None:
    target, shift = kirisurf.load("hypar"), np.array([5e5, 2e6, -300.0])
    run = kirisurf.fit((target.vertices + shift, target.faces), cells=(2, 2)).save(tmp_path / "far", pictures=False)
    assert np.abs(run.origin).max() > 1e6
    for file in RUN_BLOCKS.values():
        assert np.array_equal(read_fields(run.folder / file).about["origin"], [run.origin])
    states = [export(run, tmp_path / f"{state}.vtp", state) for state in ("deployed", "contracted")]
    assert np.array_equal(origin_of(states[0]), run.origin)
    assert np.array_equal(origin_of(run.folder / "deployed.obj"), origin_of(run.folder / "deployed.vtp"))
    # judged against the target in its own frame, and against the one that the run holds in the shifted frame
    far = (target.vertices + shift, target.faces)
    expected = {name: run.certificate[name] for name in ("distance_rms", "coverage", "length")}
    for deployed, contracted in (states, (run.folder / "deployed.obj", run.folder / "contracted.obj")):
        for goal in (far, run.folder / "target.vtp"):
            rows = kirisurf.audit(deployed, contracted, goal).rows
            assert {name: rows[name] for name in expected} == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_units_of_fields_say_how_they_grow_with_the_sheet() -> None:
    """Twice the sheet has a quarter of the Gaussian curvature: a field in unit^p grows by 2^p, all others stay."""
    design = kirisurf.fit("paraboloid", cells=(2, 2))
    powers = {"u": 1, "u\u00b2": 2, "1/u": -1, "1/u\u00b2": -2}
    found = []
    for scale in (1.0, 2.0):
        target = Surface.from_arrays(scale * design.surface.vertices, design.surface.faces)
        sheet = scale * design.deployed_points, scale * design.contracted_points
        found.append(measured(design.tessellation, *sheet, target).fields)
    for (where, name), values in found[0].items():
        factor = 2.0 ** powers.get(unit_of_field(name, "u"), 0)
        size = np.nanmax(np.abs(values), initial=0.0)
        np.testing.assert_allclose(
            found[1][where, name], factor * values, rtol=1e-6, atol=1e-7 * factor * size + 1e-10, err_msg=name
        )
