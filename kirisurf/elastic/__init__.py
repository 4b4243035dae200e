"""The sheet as elastic material: its flat cut pattern as shell elements, ready for a finite element program."""
