"""Whether this machine can draw: asked once, in a child process, because the answer may be a segfault."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

VARIABLE = "VTK_DEFAULT_OPENGL_WINDOW"
EGL_WINDOW = "vtkEGLRenderWindow"
INSTALL_LINE = "apt-get install libgl1 libegl1 libopengl0"

# A white square must come back as drawn, not only without an error.
_PROBE = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter
renderer = vtkRenderer()
renderer.SetBackground(1, 1, 1)
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(8, 8)
window.AddRenderer(renderer)
window.Render()
picture = vtkWindowToImageFilter()
picture.SetInput(window)
picture.Update()
pixels = picture.GetOutput().GetPointData().GetScalars()
print("drawn" if pixels and pixels.GetRange(0) == (255.0, 255.0) else "empty")
"""
# VTK falls back to windows that nobody sees, without a word: only the kind of window tells.
_WINDOW_PROBE = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow
window = vtkRenderWindow()
window.SetSize(8, 8)
window.SetShowWindow(False)
window.AddRenderer(vtkRenderer())
window.Render()
print("kind", window.GetClassName())
"""
_SEEN = ("vtkXOpenGLRenderWindow", "vtkCocoaRenderWindow", "vtkWin32OpenGLRenderWindow", "vtkWaylandRenderWindow")
_SYSTEM_WINDOWS = ("darwin", "win32", "cygwin")


@dataclass(frozen=True)
class OpenGL:
    """The answer of the probe.

    Attributes
    ----------
    available : bool
    window : str
        Kind of render window to ask VTK for; empty for VTK's own choice.
    reason : str
        One sentence for the user where pictures cannot be drawn, with the line that mends it.
    """

    available: bool
    window: str = ""
    reason: str = ""


@lru_cache(maxsize=1)
def probe() -> OpenGL:
    """Draw eight pixels off-screen in a child process and say whether that worked.

    First with the window that the environment asks for, on Linux then with EGL, which needs no display; where
    nothing is asked for, with VTK's own choice in the end. The answer is kept for
    the life of this process.
    """
    chosen = os.environ.get(VARIABLE, "")
    own = [EGL_WINDOW] if sys.platform.startswith("linux") else []
    # what was chosen comes first, but need not be a window that this VTK knows
    kinds = [chosen, *own] if chosen else [*own, ""]
    ending = ""
    for kind in kinds:
        worked, ending = _draws(kind)
        if worked:
            return OpenGL(True, kind)
    remedy = (
        f"On Debian or Ubuntu this line installs what is missing: {INSTALL_LINE}"
        if sys.platform.startswith("linux")
        else "Update the graphics driver."
    )
    return OpenGL(False, "", f"Pictures cannot be drawn: OpenGL is not usable here ({ending}). {remedy}")


@lru_cache(maxsize=1)
def probe_display() -> OpenGL:
    """Say whether a window can be opened on a display, asked in a child process and kept for this one."""
    if sys.platform not in _SYSTEM_WINDOWS and not any(os.environ.get(v) for v in ("DISPLAY", "WAYLAND_DISPLAY")):
        return OpenGL(False, "", "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)")
    said, ending = _run("", _WINDOW_PROBE)
    kind = said.split("kind ")[-1].strip() if "kind " in said else ""
    if kind in _SEEN:
        return OpenGL(True, kind)
    name = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or "the system's"
    return OpenGL(False, "", f"the display {name} could not be used" + (f" ({ending})" if ending else ""))


@contextmanager
def on_screen_window() -> Iterator[None]:
    """Let VTK choose a window that a person sees, whatever the environment asks for off-screen."""
    before = os.environ.pop(VARIABLE, None)
    try:
        yield
    finally:
        if before is not None:
            os.environ[VARIABLE] = before


@contextmanager
def off_screen_window(answer: OpenGL) -> Iterator[None]:
    """Let VTK make the kind of window that the probe found, and restore the environment after."""
    before = os.environ.get(VARIABLE)
    if answer.window:
        os.environ[VARIABLE] = answer.window
    try:
        yield
    finally:
        if before is not None:
            os.environ[VARIABLE] = before
        elif answer.window:
            # An empty string would end the process at the next render.
            os.environ.pop(VARIABLE, None)


def _draws(kind: str) -> tuple[bool, str]:
    said, ending = _run(kind, _PROBE)
    if not ending and "drawn" not in said:
        ending = "a test picture came back empty"
    return not ending, ending


def _run(kind: str, code: str, seconds: float = 120.0) -> tuple[str, str]:
    """Run code in a child process: what it said, and how it ended if not well."""
    environment = {key: value for key, value in os.environ.items() if key != VARIABLE}
    if kind:
        environment[VARIABLE] = kind
    try:
        child = subprocess.run(
            [sys.executable, "-P", "-c", code],
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "", f"a test picture took more than {seconds:g} s"
    except OSError as problem:
        return "", f"a test process could not be started: {problem}"
    if child.returncode < 0:
        return child.stdout, f"a test picture ended with signal {-child.returncode}"
    if child.returncode:
        return child.stdout, f"a test picture ended with code {child.returncode}"
    return child.stdout, ""
