"""The laws of every block, written once: slopes of Taylor remainders, symmetry, invariance, stencils."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from kirisurf.block import Block
from kirisurf.pattern import quad_pattern
from kirisurf.tessellation import Tessellation


def bumpy_sheet(seed: int = 0, noise: float = 0.08) -> tuple[Tessellation, np.ndarray]:
    """A 2x2-cell pattern in units of its tile edge, with every vertex displaced."""
    tessellation = quad_pattern(2, 2, 0.6)
    flat = np.column_stack([2 * tessellation.deployed, np.zeros(tessellation.n_vertices)])
    return tessellation, flat + noise * np.random.default_rng(seed).standard_normal(flat.shape)


def taylor_slopes(block: Block, points: np.ndarray, seed: int = 1) -> tuple[float, float]:
    """Orders of the remainders after the first and after the second derivative (infinite where they vanish)."""
    rng = np.random.default_rng(seed)
    direction = rng.standard_normal(points.shape)
    base = block.residual(points)
    multipliers = rng.standard_normal(base.shape)
    along = np.einsum("grp,gp->gr", block.jacobian(points), direction[block.stencil].reshape(len(block.stencil), -1))
    local = direction[block.curvature_stencil].reshape(-1, 3 * block.curvature_stencil.shape[1])
    second = float(np.einsum("ci,cij,cj->", local, block.curvature(points, multipliers), local))
    sizes = np.array([2e-3, 2e-4])
    first = np.array(
        [float((multipliers * (block.residual(points + h * direction) - base - h * along)).sum()) for h in sizes]
    )
    rest = first - 0.5 * sizes**2 * second
    return _order(first, sizes), _order(rest, sizes)


def _order(remainders: np.ndarray, sizes: np.ndarray) -> float:
    if np.abs(remainders).max() < 1e-12:
        return np.inf
    return float(np.log(abs(remainders[0] / remainders[1])) / np.log(sizes[0] / sizes[1]))


def check_block(block: Block, points: np.ndarray, invariant: bool = True) -> None:
    """Assert every law on one block at one point."""
    first, second = taylor_slopes(block, points)
    assert first >= 1.95, f"the first derivative of {block.name} has remainder order {first:.3f}, not 2"
    assert second >= 2.9, f"the second derivative of {block.name} has remainder order {second:.3f}, not 3"
    rows = block.residual(points)
    assert rows.shape == (len(block.stencil), block.n_rows)
    curvature = block.curvature(points, np.ones_like(rows))
    np.testing.assert_allclose(curvature, np.swapaxes(curvature, 1, 2), atol=1e-12)
    if invariant:
        turn = Rotation.random(random_state=5).as_matrix()
        np.testing.assert_allclose(block.residual(points @ turn.T + [3.0, -2.0, 5.0]), rows, atol=1e-11)
    # a vertex outside of a stencil does not move the row
    group = int(np.argmax(np.abs(rows).sum(axis=1)))
    others = np.setdiff1d(np.arange(len(points)), block.stencil[group])
    moved = points.copy()
    moved[others] += 0.1 * np.random.default_rng(9).standard_normal((len(others), 3))
    np.testing.assert_array_equal(block.residual(moved)[group], rows[group])
