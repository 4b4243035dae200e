"""Deployment: how a sheet gets from flat to shape, what it costs, and where it rests."""

from kirisurf.deployment.deployment import Deployment, deploy, deploy_run
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.ligament import torsion_of_ligament
from kirisurf.deployment.path import Path, PathStatus
from kirisurf.deployment.springs import energy_of
from kirisurf.deployment.stability import Barrier, Minimum
from kirisurf.deployment.verdict import Kind, Verdict

__all__ = [
    "Barrier",
    "Deployment",
    "Energy",
    "Kind",
    "Minimum",
    "Path",
    "PathStatus",
    "Verdict",
    "deploy",
    "deploy_run",
    "energy_of",
    "torsion_of_ligament",
]
