"""ParaView: filters that run the kirisurf program beside it, and a script that shows a run."""
