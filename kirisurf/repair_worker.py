"""Script of the child process that runs MeshLab's filters (see `repair`).

    repair_worker.py INPUT.npz OUTPUT.npz FILTERS.json MEMORY_MB

FILTERS is a list of [name, parameters]; a parameter {"length": x} is an absolute length. Prints {} and
writes the arrays, or prints {"error": sentence}. Imports nothing of kirisurf: pymeshlab is GPL-3 and
stays in a program of its own; it also changes the Qt environment of the process that imports it.
"""

from __future__ import annotations

import json
import sys


def main(source: str, target: str, steps: str, memory_mb: str) -> dict:
    """Apply the filters to one surface."""
    try:
        import resource

        limit = int(float(memory_mb) * 1e6)
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except (ImportError, ValueError, OSError):
        pass  # a system without such limits: the wall-clock limit of the parent remains
    import numpy as np
    import pymeshlab

    with np.load(source, allow_pickle=False) as arrays:
        vertices, faces = arrays["vertices"], arrays["faces"].astype(np.int32)
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=vertices, face_matrix=faces))
    with open(steps, encoding="utf-8") as file:
        filters = json.load(file)
    for name, parameters in filters:
        given = {
            key: pymeshlab.PureValue(value["length"]) if isinstance(value, dict) else value
            for key, value in parameters.items()
        }
        try:
            meshes.apply_filter(name, **given)
        except pymeshlab.PyMeshLabException as problem:
            return {"error": f"{name}: {problem}"[:300]}
    mesh = meshes.current_mesh()
    np.savez(target, vertices=mesh.vertex_matrix(), faces=mesh.face_matrix().astype(np.int64))
    return {"done": True}


if __name__ == "__main__":
    try:
        answer = main(*sys.argv[1:])
    except MemoryError:
        answer = {"error": "more memory than the limit for it"}
    print(json.dumps(answer))  # noqa: T201 - standard output is how the child answers
