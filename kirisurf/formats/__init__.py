"""Reading and writing surfaces and polygons: every file passes through here, none unchecked."""

from kirisurf.formats.polydata import surface_from_polydata, to_polydata
from kirisurf.formats.reading import read_fields, read_polygons, read_surface, read_surface_with_notes
from kirisurf.formats.source import FORMATS
from kirisurf.formats.writing import write_obj, write_vtp

__all__ = [
    "FORMATS",
    "read_fields",
    "read_polygons",
    "read_surface",
    "read_surface_with_notes",
    "surface_from_polydata",
    "to_polydata",
    "write_obj",
    "write_vtp",
]
