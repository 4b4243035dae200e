"""Pictures and reports of a design or a run: the one module of the computing room that asks the viewers.

`viewers` is imported inside the functions, so that computing starts without VTK and matplotlib.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.judging import patch_points
from kirisurf.runs import Run
from kirisurf.runs.table import curvature_rows
from kirisurf.surface import Surface
from kirisurf.targets import loaded
from kirisurf.tessellation import Tessellation

if TYPE_CHECKING:
    from viewers.report import ReportParts
    from viewers.scenes import Sheet

PICTURES = ("overview", "target", "pattern", "deployed", "mean_curvature", "gaussian_curvature", "asked_stretch")
REPORT = "report.html"
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


def draw_pictures(drawn: Sheet, folder: Path, names: Sequence[str] = PICTURES) -> tuple[dict[str, Path], str]:
    """Write the standard pictures as `NAME.png`.

    Parameters
    ----------
    drawn : Sheet
    folder : Path
    names : sequence of str
        Some of `PICTURES`.

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
    from viewers.scenes import standard_scenes
    from viewers.snapshot import NoOpenGLError, render, render_overview

    answer = probe()
    if not answer.available:
        return {}, answer.reason
    scenes = standard_scenes(drawn)
    pictures: dict[str, Path] = {}
    try:
        for name in names:
            path = folder / f"{name}.png"
            if name == "overview":
                pictures[name] = render_overview(scenes, path)
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
) -> ReportParts:
    """Return what a report shows, from the record of a run (complete or about to be written).

    Seconds and warnings of drawing are not part of it: the same design gives the same report.
    """
    from viewers.report import ReportParts

    holes = {name: values for (where, name), values in fields.items() if where == "hole"}
    beside = result["certificate_beside"]
    judged_beside = {name: beside[name] for name in beside["limits"] if name in beside}
    width, height = np.ptp(contracted, axis=0).tolist()
    units = str(result["units"])
    return ReportParts(
        title=title or f"kirisurf: {result['target']['name']}",
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
    )


def run_report_parts(run: Run) -> ReportParts:
    """Return what a report on a finished run shows."""
    pictures = {name: run.folder / f"{name}.png" for name in PICTURES if (run.folder / f"{name}.png").is_file()}
    missing = "" if pictures else "The run holds no pictures."
    return report_parts(run.result, run.contracted, run.fields, pictures, missing, f"kirisurf: {run.name}")


def write_report(parts: ReportParts | Sequence[ReportParts], path: Path) -> Path:
    """Write one self-contained HTML file on one run, or comparing several.

    Raises
    ------
    OutputError
        Where it cannot be written.
    """
    from viewers.report import write_report

    return write_report(parts, path)


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
