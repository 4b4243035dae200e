"""Deployment: how a sheet gets from flat to shape, what it costs, and where it rests."""

from kirisurf.deployment.branch import Branch, BranchEnd, follow_branch
from kirisurf.deployment.deployment import Deployment, deploy, deploy_run
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.ligament import torsion_of_ligament
from kirisurf.deployment.minimum import Minimum
from kirisurf.deployment.path import Path, PathStatus
from kirisurf.deployment.springs import energy_of
from kirisurf.deployment.stability import Barrier
from kirisurf.deployment.verdict import Kind, Verdict

__all__ = [
    "Barrier",
    "Branch",
    "BranchEnd",
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
    "follow_branch",
    "torsion_of_ligament",
]
