"""Pictures of a workbench as files: a scene as PNG, several as the frames of a GIF; drawn off-screen."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from kirisurf.errors import ParameterError
from kirisurf.formats.atomic import write_bytes
from viewers import theme
from viewers.framing import fit_frame
from viewers.snapshot import draw, render, render_overview
from viewers.workbench.events import Draw


def draw_pictures(request: Draw) -> Path:
    """Write the scenes of a request: by the suffix of its path a picture (.png) or an animation (.gif).

    Several scenes as PNG stand side by side at one scale.

    Raises
    ------
    ParameterError
        Where there is no scene, or the suffix is another one.
    NoOpenGLError
        Where nothing can be drawn here.
    OutputError
        Where the file cannot be written.
    """
    path = Path(request.path)
    suffix = path.suffix.lower()
    if suffix not in (".png", ".gif") or not request.scenes:
        raise ParameterError(
            f"picture: expected scenes and a .png or .gif, got {len(request.scenes)} scenes and {path.name!r}"
        )
    if suffix == ".gif":
        return _animation(request, path)
    if len(request.scenes) == 1:
        return render(request.scenes[0], path, request.size)
    return render_overview(request.scenes, path, columns=len(request.scenes), panel=request.size)


def _animation(request: Draw, path: Path) -> Path:
    """All frames at one scale, so that nothing grows or shrinks but the sheet."""
    from PIL import Image, ImageDraw, ImageFont

    width, height = request.size
    frames = [fit_frame(scene.view, scene.frame, width / height) for scene in request.scenes]
    widest = max(frames, key=lambda frame: frame.half_height)
    font = ImageFont.load_default(17)
    pictures = []
    for scene in request.scenes:
        picture = Image.fromarray(np.asarray(draw(scene, request.size, widest)))
        words = "; ".join(part for part in (scene.title, scene.note) if part)
        ImageDraw.Draw(picture).text((14, height - 30), words, fill=theme.MUTED, font=font)
        pictures.append(picture.quantize(128, dither=Image.Dither.NONE))
    buffer = io.BytesIO()
    milliseconds = max(20, round(1000 * request.seconds))
    pictures[0].save(buffer, "GIF", save_all=True, append_images=pictures[1:], duration=milliseconds, loop=0)
    write_bytes(path, buffer.getvalue())
    return path
