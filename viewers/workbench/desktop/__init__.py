"""The desktop window of the workbench: Qt (PySide6, LGPL) round a pyvista plotter (pyvistaqt, MIT).

Why these: pyvista draws the other pictures too; PySide6 is Qt's own binding, kept by the Qt company, and the LGPL goes
with a permissive licence, which PyQt's GPL does not; pyvistaqt is the pyvista developers' own bridge.
"""
