"""Unit cells: those of the paper from their formulas, any other from a file; `catalog` knows them by name."""

from kirisurf.unit_cells.catalog import catalog, find_cell
from kirisurf.unit_cells.cell_file import parse_cell, read_cell

__all__ = ["catalog", "find_cell", "parse_cell", "read_cell"]
