"""Pictures and reports of a design or a run: the one module of the computing room that asks the viewers.

`viewers` is imported inside the functions, so that computing starts without VTK and matplotlib.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.formats.atomic import write_bytes, write_text
from kirisurf.judging import patch_points
from kirisurf.runs import Run
from kirisurf.runs.table import curvature_rows
from kirisurf.spec import FitSpec
from kirisurf.spec_words import shown_options
from kirisurf.surface import Surface
from kirisurf.targets import loaded
from kirisurf.tessellation import Tessellation

if TYPE_CHECKING:
    from viewers.report import ReportParts
    from viewers.scenes import Sheet

STANDARD = ("overview", "target", "pattern", "deployed", "asked_stretch")
MAPS = (
    "mean_curvature",
    "target_mean_curvature",
    "mean_curvature_difference",
    "gaussian_curvature",
    "target_gaussian_curvature",
    "gaussian_curvature_difference",
    "distance",
)
PANELS = ("residence", "residuals")
"""Several maps in one picture."""

PICTURES = (*STANDARD, *MAPS, *PANELS)
FIGURE, MAP, PANEL = ((1280, 1000), 36.0), ((960, 780), 26.0), (((1040, 840), 36.0), ((600, 510), 26.0))
"""Pixels and lines of text (see `viewers.snapshot.render`) of what stands alone in the report, of one of three in a
row, and of one panel of two or of more."""

REPORT, THUMBNAIL = "report.html", "thumbnail.png"
PATCH_POINTS = 9
"""Points along every side of a hole's curved patch in a picture."""


def sheet(
    tessellation: Tessellation,
    deployed: np.ndarray,
    contracted: np.ndarray,
    target: Surface,
    fields: Mapping[tuple[str, str], np.ndarray],
    units: str | None,
    stretch: tuple[np.ndarray, tuple[float, float]] | None = None,
) -> Sheet:
    """Return what pictures are drawn from: holes as curved patches; fields with several columns are left out.

    `stretch` is what the target asks for at every vertex (v,), and the range of what the tessellation gives.
    """
    from viewers.scenes import Sheet

    plain = {key: values for key, values in fields.items() if values.ndim == 1}
    return Sheet.from_arrays(
        tessellation.tiles,
        tessellation.holes,
        deployed,
        contracted,
        target,
        plain,
        patch_points(tessellation, deployed, PATCH_POINTS),
        units=units or "unit",
        name=target.name,
        asked_stretch=None if stretch is None else stretch[0],
        possible_stretch=None if stretch is None else stretch[1],
    )


def run_sheet(run: Run) -> Sheet:
    """Return what pictures of a run are drawn from."""
    found = run.result.get("feasibility")
    stretch = None if found is None else (run.asked_stretch, (float(found["least"]), float(found["most"])))
    return sheet(run.tessellation, run.deployed, run.contracted, run.target, run.fields, run.spec.units, stretch)


def draw_pictures(
    drawn: Sheet,
    folder: Path,
    names: Sequence[str] = PICTURES,
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> tuple[dict[str, Path], str]:
    """Write the standard pictures and the maps as `NAME.png`.

    Parameters
    ----------
    drawn : Sheet
    folder : Path
    names : sequence of str
        Some of `PICTURES`; those that the sheet has nothing for are left out.
    ranges : mapping of str to (float, float), optional
        Ends of the color bars of some maps, such as those of the same maps of other designs. The pictures stand beside
        those of other designs then, and all have the size of maps.

    Returns
    -------
    pictures : dict of str to Path
        Those that were drawn, in order.
    reason : str
        Why there are none, and what to do; empty where there are.

    Raises
    ------
    OutputError
        Where a file cannot be written.
    """
    from viewers.opengl import probe
    from viewers.report_scenes import accuracy_scenes, curvature_scenes, ranged, residence_scenes, residual_scenes
    from viewers.scenes import standard_scenes
    from viewers.snapshot import NoOpenGLError, render, render_overview

    answer = probe()
    if not answer.available:
        return {}, answer.reason
    scenes = standard_scenes(drawn)
    maps = {**curvature_scenes(drawn), **accuracy_scenes(drawn)}
    maps |= {name: ranged(maps[name], limits, "") for name, limits in (ranges or {}).items() if name in maps}
    panels = {"residence": residence_scenes(drawn), "residuals": residual_scenes(drawn)}
    pictures: dict[str, Path] = {}
    try:
        for name in names:
            path = folder / f"{name}.png"
            if name == "overview":
                pictures[name] = render_overview(scenes, path)
            elif name in maps:
                size, lines = MAP if "curvature" in name else FIGURE
                pictures[name] = render(maps[name], path, size, lines)
            elif name in scenes and ranges is not None:
                pictures[name] = render(scenes[name], path, *MAP)
            elif panels.get(name):
                size, lines = PANEL[len(panels[name]) > 2]
                pictures[name] = render_overview(panels[name], path, len(panels[name]), size, lines)
            elif name in scenes:
                pictures[name] = render(scenes[name], path)
    except NoOpenGLError as problem:
        return pictures, str(problem)
    return pictures, ""


def report_parts(
    result: Mapping[str, Any],
    contracted: np.ndarray,
    fields: Mapping[tuple[str, str], np.ndarray],
    pictures: Mapping[str, Path],
    no_pictures: str = "",
    title: str = "",
    spec: FitSpec | None = None,
) -> ReportParts:
    """Return what a report shows, from the record of a run (complete or about to be written).

    Warnings of drawing are not part of it, and seconds are shown in comparisons alone: the same design gives the same
    report.
    """
    from viewers.report import ReportParts

    holes = {name: values for (where, name), values in fields.items() if where == "hole"}
    beside = result["certificate_beside"]
    judged_beside = {name: beside[name] for name in beside["limits"] if name in beside}
    width, height = np.ptp(contracted, axis=0).tolist()
    units = str(result["units"])
    return ReportParts(
        title=title or str(result["target"]["name"]),
        target_name=str(result["target"]["name"]),
        units="unit" if "assumed" in units else units,
        result={key: value for key, value in result.items() if key != "seconds"},
        certificate={**result["certificate"], **judged_beside},
        limits=beside["limits"],
        failures=tuple(beside["failures"]),
        fields={key: values for key, values in fields.items() if values.ndim == 1},
        numbers={key: value for key, value in result["measures"].items() if value is not None},
        tables={"curvature": curvature_rows(holes)},
        pictures=pictures,
        notes=tuple(result["notes"]),
        warnings=tuple(result.get("warnings", ())),
        history=tuple(result["history"]),
        sheet_size=(width, height),
        no_pictures=no_pictures,
        spec={} if spec is None else shown_options(spec),
        seconds=dict(result.get("seconds") or {}),
    )


def write_thumbnail(tessellation: Tessellation, points: np.ndarray, path: Path) -> Path:
    """Write a small picture of a deployed sheet, which needs no OpenGL.

    Raises
    ------
    OutputError
        Where it cannot be written.
    """
    from viewers.thumbnail import thumbnail

    write_bytes(path, thumbnail(points, tessellation.tiles, tessellation.holes))
    return path


def write_batch_report(summary: Mapping[str, Any], folder: Path, path: Path) -> Path:
    """Write one self-contained HTML file on a batch, with the thumbnails of its runs.

    Raises
    ------
    OutputError
        Where it cannot be written.
    """
    from viewers.batch_page import batch_page

    pictures: dict[str, bytes] = {}
    for item in summary["items"]:
        if item["folder"] is not None:
            # a run that somebody is about to remove has none
            with suppress(OSError):
                pictures[item["name"]] = (folder / item["folder"] / THUMBNAIL).read_bytes()
    write_text(path, batch_page(summary, pictures))
    return path


def deployment_viewer() -> Any:
    """Return the module that draws paths from flat to deployed, :mod:`viewers.figures_deployment`."""
    import viewers.figures_deployment as found

    return found


def numbers_of(parts: Sequence[ReportParts]) -> dict[str, Any]:
    """Return every number that the report of one design, or the comparison of several, shows."""
    from viewers.report_comparison import comparison_numbers
    from viewers.report_numbers import report_numbers

    return report_numbers(parts[0]) if len(parts) == 1 else comparison_numbers(parts)


def shared_ranges(parts: Sequence[ReportParts]) -> dict[str, tuple[float, float]]:
    """Return one range of K for the maps of several designs for one target in one unit; nothing where they are not."""
    from viewers.report_comparison import compares
    from viewers.report_scenes import curvature_range

    if not compares(parts):
        return {}
    ranges = [curvature_range(each.fields, "gaussian_curvature", each.units).limits for each in parts]
    return {"gaussian_curvature": (min(low for low, _ in ranges), max(high for _, high in ranges))}


def write_report(parts: ReportParts | Sequence[ReportParts], path: Path) -> Path:
    """Write one self-contained HTML file on one run, or comparing several.

    Raises
    ------
    OutputError
        Where it cannot be written.
    """
    from viewers import report

    return report.write_report(parts, path)


def serve_workbench(
    target: str, options: Mapping[str, Any], ready: Callable[[str], None], port: int = 0, is_browser_opened: bool = True
) -> str:
    """Serve a run or a target as a page on this machine, and wait until a signal ends it.

    Parameters
    ----------
    target : str
        A run folder, a mesh file, an outline, or the name of a sample.
    options : mapping
        Of `FitSpec`, on top of those of the run or of the defaults.
    ready : callable
        Receives the page's address, with its key, as soon as it answers.
    port : int
        0 for any that is free.
    is_browser_opened : bool
        Whether the page is opened in the user's browser.

    Returns
    -------
    str
        The page's address.

    Raises
    ------
    ParameterError
        Where the extra kirisurf[web] is not installed, the port cannot be had, or an option is wrong.
    KirisurfError
        Where nothing can be drawn here, or the run or the target cannot be read.
    """
    from viewers.workbench.web.libraries import require_libraries

    require_libraries()
    from concurrent.futures import ThreadPoolExecutor

    from viewers.opengl import probe
    from viewers.workbench.engine import Engine

    engine, shown = Engine(), list[str]()

    def tell(address: str) -> None:
        shown.append(address)
        ready(address)
        if is_browser_opened:
            open_page(address)

    with ThreadPoolExecutor(1) as pool:
        # asked in a child process, while this one reads and imports what the page needs
        asked = pool.submit(probe)
        from viewers.snapshot import NoOpenGLError
        from viewers.workbench.opening import open_any
        from viewers.workbench.web.opener import open_page
        from viewers.workbench.web.serving import prepare, serve

        state, results = open_any(target, **options)
        engine.warm_up()
        prepare()
        answer = asked.result()
    try:
        if not answer.available:
            raise NoOpenGLError(answer.reason)
        opened = None if results.sheet is None else Path(target)
        serve(state, results, engine, tell, port, f"kirisurf: {Path(target).name}", opened)
    finally:
        engine.close()
    return shown[0]


def show_workbench(target: str, options: Mapping[str, Any]) -> str:
    """Open a run or a target in the workbench and wait until it is closed.

    Where the workbench cannot be opened but a window can, that shows the run or the target alone.

    Parameters
    ----------
    target : str
        A run folder, a mesh file, an outline, or the name of a sample.
    options : mapping
        Of `FitSpec`, on top of those of the run or of the defaults.

    Returns
    -------
    str
        A sentence on what opened instead of the workbench, and how to get it; empty where it opened.

    Raises
    ------
    KirisurfError
        Where there is no display, the message names what to do instead; or where an option is wrong, or the run or
        the target cannot be read.
    """
    from concurrent.futures import ThreadPoolExecutor

    from viewers.workbench.desktop.probing import probe_workbench

    with ThreadPoolExecutor(1) as pool:
        # asked in a child process, while this one reads and imports what the window needs
        asked = pool.submit(probe_workbench)
        from viewers.window import show_sheet, show_surface
        from viewers.workbench.desktop.show import prepare, show_workbench
        from viewers.workbench.opening import open_any

        state, results = open_any(target, **options)
        engine = prepare()
        answer = asked.result()
    title = f"kirisurf: {Path(target).name}"
    if answer.available:
        show_workbench(state, results, title, engine)
        return ""
    engine.close()
    if results.sheet is not None:
        show_sheet(results.sheet, title)
    else:
        show_surface(loaded(state.spec)[1], title)
    return f"{answer.reason}. A plain window opened instead."


def notebook_card(
    values: Mapping[str, Any], result: Mapping[str, Any], drawn: Sheet, pattern: str, units: str = "unit"
) -> str:
    """Return the card of a design as HTML, see :func:`viewers.notebook.sheet_card`."""
    from viewers.notebook import sheet_card

    return sheet_card(values, result, drawn, pattern, units)
