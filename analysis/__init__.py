"""Judging a finished design: the certificate, distances, curvature of the holes, measures and tables.

Nothing here draws, solves or writes files.
"""
