"""Asking for a file: to read, or to write."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from kirisurf.formats.source import FORMATS
from kirisurf.outlines.reading import FORMATS as OUTLINE_FORMATS
from viewers.workbench.desktop.qt import qt

SIZE = (860, 560)


def ask_target(window: Any) -> str:
    """Ask for a mesh or an outline; empty where the user would rather not."""
    patterns = " ".join(f"*{suffix}" for suffix in sorted({*FORMATS, *OUTLINE_FORMATS}))
    dialog = _dialog(window, "Open a target: a mesh, or an outline in the plane")
    dialog.setFileMode(qt().widgets.QFileDialog.FileMode.ExistingFile)
    dialog.setOption(qt().widgets.QFileDialog.Option.HideNameFilterDetails)
    dialog.setNameFilters([f"Meshes and outlines ({patterns})", "All files (*)"])
    return _answer(dialog)


def ask_where(window: Any, title: str, name: str, kinds: tuple[str, ...]) -> str:
    """Ask where to write a file; its suffix follows the kind that is chosen.

    Parameters
    ----------
    window : QWidget
    title, name : str
        Of the dialog, and a first name for the file.
    kinds : tuple of str
        As "Pictures (*.png)".
    """
    dialog = _dialog(window, title)
    dialog.setAcceptMode(qt().widgets.QFileDialog.AcceptMode.AcceptSave)
    dialog.setNameFilters(list(kinds))
    dialog.setDefaultSuffix(_suffix(kinds[0]))
    dialog.selectFile(name)

    def exchange(kind: str) -> None:
        dialog.setDefaultSuffix(_suffix(kind))
        line = dialog.findChild(qt().widgets.QLineEdit)
        chosen = with_suffix(Path(line.text()).stem if _is_of(line.text(), kinds) else line.text(), kind)
        line.setText(chosen)

    dialog.filterSelected.connect(exchange)
    return _answer(dialog)


def ask_folder(window: Any, title: str, name: str) -> str:
    """Ask for the name of a folder that is not there yet; one that is there is said, and not entered."""
    widgets, core = qt().widgets, qt().core
    dialog = _dialog(window, title)
    dialog.setAcceptMode(widgets.QFileDialog.AcceptMode.AcceptSave)
    dialog.setOption(widgets.QFileDialog.Option.HideNameFilterDetails)
    dialog.setLabelText(widgets.QFileDialog.DialogLabel.FileName, "New folder:")
    dialog.setLabelText(widgets.QFileDialog.DialogLabel.FileType, "It gets:")
    dialog.setNameFilters(["cut file, both states, certificate, report (*)"])
    dialog.setFilter(core.QDir.Filter.AllDirs | core.QDir.Filter.NoDotAndDotDot)
    dialog.selectFile(free_name(name))
    line = dialog.findChild(widgets.QLineEdit)
    # names of what is there are of no use here
    line.setCompleter(None)

    def is_new(path: str) -> bool:
        # Qt would take the name of a folder for a way to go, and the run would land inside it
        if not Path(path).exists():
            return True
        words = f"{Path(path).name} is there already, and nothing is overwritten. Take another name."
        widgets.QMessageBox.information(dialog, title, words)
        dialog.findChild(widgets.QTreeView).clearSelection()
        line.setText(free_name(path))
        line.setFocus()
        return False

    dialog.allows = is_new
    return _answer(dialog)


def free_name(path: str) -> str:
    """Return a name that nothing has in the folder of a path: its own, or with a number.

    Examples
    --------
    >>> free_name("no-such-folder/hood-run")
    'hood-run'
    """
    wanted = Path(path)
    count, name = 1, wanted.name
    while (wanted.parent / name).exists():
        count += 1
        name = f"{wanted.name}-{count}"
    return name


def with_suffix(name: str, kind: str) -> str:
    """Return a file's name with the suffix of a kind, which stays where the name has it.

    Examples
    --------
    >>> with_suffix("hood-cut", "Drawings for CAD (*.dxf)"), with_suffix("a.DXF", "Drawings for CAD (*.dxf)")
    ('hood-cut.dxf', 'a.DXF')
    """
    return name if _is_of(name, (kind,)) or not name else f"{name}.{_suffix(kind)}"


def _suffix(kind: str) -> str:
    return kind.partition("(*.")[2].rstrip(")")


def _is_of(name: str, kinds: tuple[str, ...]) -> bool:
    return name.lower().endswith(tuple(f".{_suffix(kind)}" for kind in kinds))


def _dialog(window: Any, title: str) -> Any:
    widgets = qt().widgets
    dialog = qt().Asking(window, title)
    # the same everywhere, and its columns wide enough to be read
    dialog.setOption(widgets.QFileDialog.Option.DontUseNativeDialog)
    dialog.resize(*SIZE)
    head = dialog.findChild(widgets.QTreeView).header()
    head.setStretchLastSection(False)
    head.setSectionResizeMode(widgets.QHeaderView.ResizeMode.ResizeToContents)
    head.setSectionResizeMode(0, widgets.QHeaderView.ResizeMode.Stretch)
    head.setSectionHidden(2, True)
    return dialog


def _answer(dialog: Any) -> str:
    accepted = dialog.exec()
    chosen = dialog.selectedFiles()
    dialog.deleteLater()
    return str(chosen[0]) if accepted and chosen else ""
