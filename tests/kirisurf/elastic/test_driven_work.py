"""Tables of the solver are read, and the work on the driven nodes is the integral of force by displacement."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.elastic.driven_work import read_driven_work
from kirisurf.errors import UnreadableError


def table(kind: str, name: str, time: float, rows: np.ndarray) -> str:
    letters = "vx,vy,vz" if kind == "displacements" else "fx,fy,fz"
    lines = [f" {kind} ({letters}) for set {name} and time  {time: .7E}", ""]
    lines += [f"{k + 1:10d}" + "".join(f" {x: .6E}" for x in row) for k, row in enumerate(rows)]
    return "\n" + "\n".join(lines) + "\n"


def spring(path, stiffness: float, steps: int) -> None:
    """Two nodes, the second pulled along x by a spring that hardens: force k (u + u^3)."""
    text = ""
    for k in range(1, steps + 1):
        u = k / steps
        shift = np.array([[0.0, 0, 0], [u, 0, 0]])
        force = stiffness * (shift + shift**3)
        text += table("displacements", "DRIVEN", u, shift) + table("forces", "DRIVEN", u, force - force[::-1])
        text += table("displacements", "VERTICES", u, u * np.arange(9.0).reshape(3, 3))
    path.write_text(text)


def test_work_converges_to_the_energy_with_order_two(tmp_path):
    errors = []
    for steps in (8, 16, 32):
        spring(tmp_path / "m.dat", 3.0, steps)
        errors.append(read_driven_work(tmp_path / "m.dat").work[-1] - 3.0 * (1 / 2 + 1 / 4))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.05)


def test_tables_are_read(tmp_path):
    spring(tmp_path / "m.dat", 1.0, 4)
    found = read_driven_work(tmp_path / "m.dat")
    assert found.times == pytest.approx([0.25, 0.5, 0.75, 1.0])
    assert found.shifts.shape == found.forces.shape == (4, 2, 3)
    # at the end of the step, and not of every increment
    assert found.vertices.tolist() == [np.arange(9.0).reshape(3, 3).tolist()]
    assert found.at(0.0) == 0.0
    assert found.at(0.5) == pytest.approx(found.work[1])


@pytest.mark.parametrize(
    "content", [None, "", "something else\n", " forces (fx,fy,fz) for set DRIVEN and time 1.0\n x y\n"]
)
def test_files_without_tables_are_refused(tmp_path, content):
    if content is not None:
        (tmp_path / "m.dat").write_text(content)
    with pytest.raises(UnreadableError, match="expected"):
        read_driven_work(tmp_path / "m.dat")
