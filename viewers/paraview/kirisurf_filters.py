"""ParaView plugin: the filters "Kirigami Fit" and "Hole Curvature". Tools > Manage Plugins > Load New, this file.

A filter writes its input to a temporary file, runs the kirisurf program of the user's environment, and reads what it
wrote; `program.py` and `meshes.py` have to lie beside this file. Outside ParaView the filters are plain VTK algorithms,
without the menus that ParaView makes from the declarations.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import shlex
import sys
import tempfile
from typing import Any

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkOutputWindow


class _Undeclared:
    """Stands for ParaView's declarations in any other program: they change nothing."""

    def __getattr__(self, name: str) -> Any:
        return lambda *words, **options: lambda declared: declared


try:
    _declarations = importlib.import_module("paraview.util.vtkAlgorithm")
    smproxy, smproperty, smdomain = _declarations.smproxy, _declarations.smproperty, _declarations.smdomain
except ImportError:
    smproxy = smproperty = smdomain = _Undeclared()


def _beside(name: str) -> Any:
    """Load a module that lies beside this file: ParaView loads a plugin by its path, not as part of a package."""
    full = f"kirisurf_paraview_{name}"
    if full not in sys.modules:
        place = os.path.join(os.path.dirname(os.path.abspath(__file__)), f"{name}.py")
        spec = importlib.util.spec_from_file_location(full, place)
        if spec is None or spec.loader is None or not os.path.isfile(place):
            raise ImportError(f"expected {name}.py beside {os.path.basename(__file__)}, got none at {place}")
        module = importlib.util.module_from_spec(spec)
        sys.modules[full] = module
        spec.loader.exec_module(module)
    return sys.modules[full]


program, meshes = _beside("program"), _beside("meshes")

_DONE = (0, 1)
_BEST_SO_FAR = (5, 6, 130)
_TESSELLATIONS = (
    "quad",
    "kagome",
    "hexagon",
    "islamic-quad",
    "islamic-triangle",
    "right-triangles",
    "rotating-rectangles",
    "trihexagonal",
    "truncated-square",
)
_UNITS = ("none", "um", "mm", "cm", "m", "in", "ft")


def _choice(name: str, label: str, values: tuple[str, ...], about: str) -> str:
    """A property with a list of texts to choose from."""
    entries = "".join(f'<String value="{value}"/>' for value in values)
    return (
        f'<StringVectorProperty name="{name}" label="{label}" command="Set{name}" number_of_elements="1" '
        f'default_values="{values[0]}"><StringListDomain name="list">{entries}</StringListDomain>'
        f"<Documentation>{about}</Documentation></StringVectorProperty>"
    )


def _text(name: str, label: str, about: str, default: str = "") -> str:
    """A property that is a line of text."""
    return (
        f'<StringVectorProperty name="{name}" label="{label}" command="Set{name}" number_of_elements="1" '
        f'default_values="{default}"><Documentation>{about}</Documentation></StringVectorProperty>'
    )


_PROGRAM = _text(
    "Program",
    "Program",
    "The kirisurf program or the folder of its environment; empty: the variable KIRISURF, or the one on the path.",
)


class _KirisurfFilter(VTKPythonAlgorithmBase):
    """What the filters have in common: the program, messages and progress."""

    _program = ""

    def SetProgram(self, path: str) -> None:
        """Set the kirisurf program or the folder of its environment."""
        self._set("_program", path or "")

    def _set(self, name: str, wanted: Any) -> None:
        if getattr(self, name) != wanted:
            setattr(self, name, wanted)
            self.Modified()

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Run the program; where it fails, say why and leave the output empty.

        The answer is 1 in any case: after a 0 ParaView would run the program again with every picture.
        """
        output = self.GetOutputData(outputs, 0)
        try:
            with tempfile.TemporaryDirectory(prefix="kirisurf-") as folder:
                self._work(self.GetInputData(inputs, 0, 0), output, folder)
        except (program.ProgramError, meshes.MeshError, OSError) as problem:
            output.Initialize()
            self._complain(str(problem))
        return 1

    def _work(self, data: Any, output: Any, folder: str) -> None:
        raise NotImplementedError

    def _run(self, *words: str) -> Any:
        """Run the program and return its answer; raise what it complains of where there is nothing to read."""
        answer = program.run([program.find_program(self._program), "--json", *words], self._tell, self._is_aborted)
        if answer.code not in (*_DONE, *_BEST_SO_FAR) or "error" in answer.result or not answer.result:
            raise program.ProgramError(answer.complaint)
        return answer

    def _tell(self, share: float, line: str) -> None:
        self.SetProgressText(line[:80])
        self.UpdateProgress(share)

    def _is_aborted(self) -> bool:
        self.UpdateProgress(self.GetProgress())  # ParaView takes the click on its abort button while it is told this
        return bool(self.GetAbortExecute())

    def _complain(self, sentence: str) -> None:
        vtkOutputWindow.GetInstance().DisplayErrorText(f"{self.title}: {sentence}\n")

    def _warn(self, sentence: str) -> None:
        vtkOutputWindow.GetInstance().DisplayWarningText(f"{self.title}: {sentence}\n")


@smproxy.filter(name="KirigamiFit", label="Kirigami Fit", support_reload=False)
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkPolyData"], composite_data_supported=False)
@smproperty.xml(
    _choice("Tessellation", "Tessellation", _TESSELLATIONS, "The pattern of tiles.")
    + """<IntVectorProperty name="Tiles" command="SetTiles" number_of_elements="1" default_values="300">
      <IntRangeDomain name="range" min="1" max="4000"/>
      <Documentation>About so many tiles, trimmed to the outline of the surface; where no cells are given.
      </Documentation></IntVectorProperty>
    <IntVectorProperty name="Cells" command="SetCells" number_of_elements="2" default_values="0 0">
      <Documentation>Unit cells from side to side, stretched to the four corners of the surface: 4 4 of quad are 8 x 8
      tiles. 0 0: the number of tiles counts.</Documentation></IntVectorProperty>"""
    + _choice("Closeness", "Closeness", ("best", "exact"), "Rigid tiles near the surface, or every vertex on it.")
    + _choice("Units", "Units", _UNITS, "Unit of length of the surface.")
    + _text("MoreOptions", "More Options", "Further options of kirisurf fit, such as --min-edge 0.2 --max-seconds 60.")
    + _text("Folder", "Run Folder", "Folder for cut pattern, report and all other files; empty: nothing is kept.")
    + _PROGRAM
)
class KirigamiFit(_KirisurfFilter):
    """A flat sheet of rigid tiles that opens onto the surface: blocks tiles, holes, target and contracted."""

    title = "Kirigami Fit"
    _tessellation, _tiles, _cells, _closeness = "quad", 300, (0, 0), "best"
    _units, _more, _folder = "none", "", ""

    def __init__(self) -> None:
        super().__init__(nInputPorts=1, inputType="vtkPolyData", nOutputPorts=1, outputType="vtkMultiBlockDataSet")

    def SetTessellation(self, name: str) -> None:
        """Set the name of a tessellation, or the file of a unit cell."""
        self._set("_tessellation", name)

    def SetTiles(self, count: int) -> None:
        """Set the number of tiles."""
        self._set("_tiles", int(count))

    def SetCells(self, columns: int, rows: int) -> None:
        """Set the unit cells from side to side; 0 0 for a number of tiles."""
        self._set("_cells", (int(columns), int(rows)))

    def SetCloseness(self, mode: str) -> None:
        """Set best or exact."""
        self._set("_closeness", mode)

    def SetUnits(self, unit: str) -> None:
        """Set the unit of length, or none."""
        self._set("_units", unit)

    def SetMoreOptions(self, words: str) -> None:
        """Set further options of `kirisurf fit`."""
        self._set("_more", words or "")

    def SetFolder(self, path: str) -> None:
        """Set the folder of the run; empty for one that is removed."""
        self._set("_folder", path or "")

    def options(self) -> list[str]:
        """Return the arguments of `kirisurf fit` but for the target and the folder.

        Raises
        ------
        ProgramError
            Where further options have a quotation mark that does not end.
        """
        words = ["--tessellation", self._tessellation, "--closeness", self._closeness]
        cells = "x".join(str(count) for count in self._cells)
        words += ["--tiles", str(self._tiles)] if self._cells == (0, 0) else ["--cells", cells]
        words += [] if self._units in ("none", "") else ["--units", self._units]
        try:
            return words + shlex.split(self._more)
        except ValueError as problem:
            raise program.ProgramError(
                f"More Options: expected words and quotation marks in pairs, got {problem}"
            ) from None

    def _work(self, data: Any, output: Any, folder: str) -> None:
        target = os.path.join(folder, "target.vtp")
        meshes.write(data, target)
        kept = os.path.expanduser(self._folder.strip())
        run = os.path.abspath(kept) if kept else os.path.join(folder, "run")
        pictures = [] if kept else ["--no-pictures"]
        answer = self._run("fit", *self.options(), *pictures, "--overwrite", "-o", run, "--", target)
        # a run that was cut short may lie beside a certified one, which it does not replace
        meshes.read_blocks(output, str(answer.result.get("folder", run)))
        result = answer.result
        verdict = "certified" if result.get("certified") else "not certified"
        meshes.add_texts(output, {"verdict": [verdict], "reason": [str(result.get("reason", ""))]})
        for sentence in [*result.get("warnings", ())]:
            self._warn(sentence)
        if not result.get("certified"):
            self._warn(f"{verdict}. {result.get('reason', '')}")


@smproxy.filter(name="HoleCurvature", label="Hole Curvature", support_reload=False)
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkMultiBlockDataSet"], composite_data_supported=True)
@smproperty.xml(_PROGRAM)
class HoleCurvature(_KirisurfFilter):
    """The holes of any sheet with their curvature.

    The input has a block for each state of the same tiles: tiles and contracted by name, or the first and the second
    (Group Datasets makes such an input from two files); with a block named target, the target's curvature comes too.
    """

    title = "Hole Curvature"

    def __init__(self) -> None:
        super().__init__(nInputPorts=1, inputType="vtkMultiBlockDataSet", nOutputPorts=1, outputType="vtkPolyData")

    def _work(self, data: Any, output: Any, folder: str) -> None:
        blocks = meshes.named_blocks(data)
        opened, closed = blocks.get("tiles"), blocks.get("contracted")
        if opened is None or closed is None:
            parts = list(blocks.values())
            if len(parts) != 2:
                got = ", ".join(blocks) or "none"
                raise program.ProgramError(
                    f"expected blocks tiles and contracted, or two blocks in this order, got {got}"
                )
            opened, closed = parts
        files = {name: os.path.join(folder, f"{name}.vtp") for name in ("deployed", "contracted", "target", "holes")}
        meshes.write(opened, files["deployed"])
        meshes.write(closed, files["contracted"])
        words = []
        if blocks.get("target") is not None:
            meshes.write(blocks["target"], files["target"])
            words = ["--target", files["target"]]
        answer = self._run("audit", files["deployed"], files["contracted"], *words, "--holes", files["holes"])
        output.ShallowCopy(meshes.read(files["holes"]))
        for sentence in answer.result.get("failures", ()):
            self._warn(sentence)
