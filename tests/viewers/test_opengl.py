"""The probe answers in words, whatever the child process does."""

from __future__ import annotations

import os
import sys

import pytest

from viewers import opengl


@pytest.fixture
def fresh():
    opengl.probe.cache_clear()
    opengl.probe_display.cache_clear()
    yield
    opengl.probe.cache_clear()
    opengl.probe_display.cache_clear()


@pytest.mark.parametrize(
    "code, ending",
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "ended with signal 11"),
        ("raise SystemExit(3)", "ended with code 3"),
        ("print('empty')", "came back empty"),
    ],
)
def test_a_crash_becomes_a_sentence_with_the_line_that_mends_it(fresh, monkeypatch, code, ending):
    monkeypatch.setattr(opengl, "_PROBE", code)
    monkeypatch.setattr(sys, "platform", "linux")
    answer = opengl.probe()
    assert not answer.available
    assert ending in answer.reason
    assert "apt-get install libgl1 libegl1 libopengl0" in answer.reason


def test_the_probe_asks_for_egl_first_and_asks_once(fresh, monkeypatch):
    asked = []
    monkeypatch.setattr(opengl, "_run", lambda kind, code: (asked.append(kind), ("drawn", ""))[1])
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv(opengl.VARIABLE, raising=False)
    assert opengl.probe() == opengl.OpenGL(True, opengl.EGL_WINDOW)
    assert opengl.probe().available
    assert asked == [opengl.EGL_WINDOW]


def test_the_environment_is_restored_and_never_empty(monkeypatch):
    monkeypatch.delenv(opengl.VARIABLE, raising=False)
    with opengl.off_screen_window(opengl.OpenGL(True, opengl.EGL_WINDOW)):
        assert os.environ[opengl.VARIABLE] == opengl.EGL_WINDOW
    assert opengl.VARIABLE not in os.environ
    with opengl.off_screen_window(opengl.OpenGL(True, "")):
        assert opengl.VARIABLE not in os.environ
    monkeypatch.setenv(opengl.VARIABLE, "vtkOSOpenGLRenderWindow")
    with opengl.on_screen_window():
        assert opengl.VARIABLE not in os.environ
    assert os.environ[opengl.VARIABLE] == "vtkOSOpenGLRenderWindow"


def test_no_display_is_seen_without_a_child_process(fresh, monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(opengl, "_run", lambda kind, code: pytest.fail("a child process was started"))
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    answer = opengl.probe_display()
    assert not answer.available and "DISPLAY" in answer.reason


@pytest.mark.parametrize(
    "kind, works", [("kind vtkXOpenGLRenderWindow", True), ("kind vtkEGLRenderWindow", False), ("", False)]
)
def test_a_window_that_nobody_sees_is_no_display(fresh, monkeypatch, kind, works):
    monkeypatch.setenv("DISPLAY", ":12345")
    monkeypatch.setattr(opengl, "_run", lambda *_: (kind, ""))
    assert opengl.probe_display().available is works
