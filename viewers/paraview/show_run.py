"""ParaView script: shows the holes of a run colored by a field, with its unit on the color bar.

    pvpython show_run.py RUN_FOLDER_OR_VTM PICTURE.png [FIELD]     writes a picture
    paraview: Macros > Import new macro, this file                 shows the selected run.vtm

ParaView has no units of its own: they stand in the field data of our files, and this script puts them on the bar.
"""

from __future__ import annotations

import importlib
import math
import os
import sys
from typing import Any

FIELD = "gaussian_curvature"
_TILE, _EDGE, _INK = (0.78, 0.80, 0.83), (0.31, 0.34, 0.37), (0.12, 0.16, 0.22)
_SHARE = 0.98  # of the holes whose absolute value the color bar reaches: a few wild ones do not wash out the rest
# blue, white, red: readable with the common color-vision deficiencies
_DIVERGING = (
    (-1.0, 0.13, 0.40, 0.67),
    (-0.5, 0.57, 0.77, 0.87),
    (0.0, 0.97, 0.97, 0.97),
    (0.5, 0.96, 0.65, 0.51),
    (1.0, 0.70, 0.09, 0.17),
)


def show(source: Any, field: str = FIELD, size: tuple[int, int] = (1000, 700)) -> Any:
    """Show tiles in gray and holes colored by a field of theirs; return the view.

    Parameters
    ----------
    source : proxy
        A run.vtm, or the output of the filter "Kirigami Fit".
    field : str
        Of the holes.
    size : (int, int)
        Of the view, in pixels.

    Raises
    ------
    ValueError
        Where the source has no such blocks, or the holes no such field.
    """
    simple, servermanager = (importlib.import_module(f"paraview.{name}") for name in ("simple", "servermanager"))
    source.UpdatePipeline()
    blocks = _named(servermanager.Fetch(source))
    if not {"tiles", "holes"} <= set(blocks):
        raise ValueError(f"expected blocks tiles and holes, as in run.vtm, got {', '.join(blocks) or 'none'}")
    holes = blocks["holes"]
    array = holes.GetCellData().GetArray(field)
    if array is None:
        cells = holes.GetCellData()
        known = ", ".join(cells.GetArrayName(k) for k in range(cells.GetNumberOfArrays()))
        raise ValueError(f"expected a field of the holes ({known}), got {field}")
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewSize = list(size)
    simple.Hide(source, view)
    for name in ("tiles", "holes"):
        part = simple.ExtractBlock(registrationName=name, Input=source, Selectors=[f"/Root/{name}"])
        display = simple.Show(part, view)
        display.SetRepresentationType("Surface With Edges" if name == "tiles" else "Surface")
        # holes without shades: their colors are those of the bar
        display.Ambient, display.Diffuse = (0.3, 0.7) if name == "tiles" else (1.0, 0.0)
        if name == "tiles":
            display.ColorArrayName = ["POINTS", ""]  # ColorBy(display, None) fails in ParaView 5.11
            display.DiffuseColor, display.AmbientColor, display.EdgeColor = _TILE, _TILE, _EDGE
        else:
            _color(simple, display, view, array, field, unit_of(holes, field))
    _light_page(view)
    view.ResetActiveCameraToNegativeZ()
    camera = view.GetActiveCamera()
    camera.Azimuth(-30.0)
    camera.Elevation(-38.0)
    camera.SetViewUp(0.0, 0.0, 1.0)
    simple.ResetCamera(view)
    camera.Zoom(1.08)
    simple.Render(view)
    return view


def unit_of(data: Any, field: str) -> str:
    """Return the unit of a field from the table in a mesh's field data; empty where there is none."""
    names, units = (data.GetFieldData().GetAbstractArray(name) for name in ("field", "field_unit"))
    if names is None or units is None:
        return ""
    found = {names.GetValue(k): units.GetValue(k) for k in range(names.GetNumberOfValues())}
    return str(found.get(field, ""))


def _color(simple: Any, display: Any, view: Any, array: Any, field: str, unit: str) -> None:
    simple.ColorBy(display, ("CELLS", field))
    values = [array.GetValue(k) for k in range(array.GetNumberOfTuples())]
    finite = [value for value in values if math.isfinite(value)] or [0.0]
    table = simple.GetColorTransferFunction(field)
    if min(finite) < 0.0:
        # zero is white: the sign can be seen
        sizes = sorted(abs(value) for value in finite)
        reach = sizes[max(math.ceil(_SHARE * len(sizes)) - 1, 0)] or sizes[-1] or 1.0
        table.RGBPoints = [number for at, *color in _DIVERGING for number in (reach * at, *color)]
        table.ColorSpace = "Lab"
        unit = f"{unit}, {_SHARE:.0%} within".lstrip(", ")
    table.NanColor = (0.6, 0.63, 0.67)
    bar = simple.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = field.replace("_", " ").replace("gaussian", "Gaussian"), unit
    bar.TitleColor = bar.LabelColor = _INK
    bar.TitleFontSize, bar.LabelFontSize, bar.ScalarBarLength = 18, 16, 0.55
    bar.WindowLocation, bar.Position = "Any Location", [0.88, 0.22]
    bar.AutomaticLabelFormat, bar.LabelFormat, bar.RangeLabelFormat = 0, "%.3g", "%.3g"
    display.SetScalarBarVisibility(view, True)


def _light_page(view: Any) -> None:
    if hasattr(view, "UseColorPaletteForBackground"):
        view.UseColorPaletteForBackground = 0
    view.Background = (1.0, 1.0, 1.0)
    view.OrientationAxesLabelColor = _INK


def _named(data: Any) -> dict[str, Any]:
    if not data.IsA("vtkMultiBlockDataSet"):
        return {}
    return {data.GetMetaData(k).Get(data.NAME()): data.GetBlock(k) for k in range(data.GetNumberOfBlocks())}


def main(words: list[str]) -> int:
    """Show the run that is named, or the source that is selected; write a picture where one is named."""
    simple = importlib.import_module("paraview.simple")
    if words:
        path = os.path.join(words[0], "run.vtm") if os.path.isdir(words[0]) else words[0]
        source = simple.OpenDataFile(path)
    else:
        source = simple.GetActiveSource()
    if source is None:
        sys.stderr.write("show_run: expected a run folder, a .vtm file or a selected source, got none\n")
        return 2
    try:
        view = show(source, words[2] if len(words) > 2 else FIELD)
    except ValueError as problem:
        sys.stderr.write(f"show_run: {problem}\n")
        return 2
    if len(words) > 1:
        simple.SaveScreenshot(words[1], view)
    return 0


if __name__ == "__main__":
    _code = main(sys.argv[1:])
    if _code and sys.argv[0]:  # a macro has no name there, and must not end the window
        sys.exit(_code)
