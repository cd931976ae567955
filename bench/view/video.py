"""A motion as a video: MuJoCo's rendering of the model, with the ghost translucent in front of it."""

from __future__ import annotations

import os
import platform
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.files import whole

if TYPE_CHECKING:  # MuJoCo decides how it renders when it is imported, which is after `prepare`
    import mujoco

    from bench.view.scene import Scene
    from bench.view.side_by_side import SideBySide

#: Frames per second, and their size in pixels.
RATE, WIDTH, HEIGHT = 30, 960, 720
#: Longest video - frames: ten minutes, which take about an hour to render without a graphics card.
MOST = 18_000
#: Quality of H.264, by its constant rate factor: lower is better, 23 is the encoder's own.
QUALITY = "20"


def prepare(path: Path) -> None:
    """Have MuJoCo render without a display where there is none; before it is imported, and unless the user chose.

    Raises:
        InputError: another ending than .mp4, the encoder is not installed, or what MuJoCo is to render with is not.
    """
    if path.suffix.lower() != ".mp4":
        raise InputError(path, f"found the ending '{path.suffix}'", "allowed: .mp4")
    if os.environ.get("MUJOCO_GL") == "off":  # as every command begins
        del os.environ["MUJOCO_GL"]
    if platform.system() == "Linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        os.environ.setdefault("MUJOCO_GL", "egl")
    _encoder()
    try:
        import mujoco  # noqa: F401
    except (ImportError, AttributeError, OSError, RuntimeError) as error:
        raise _unable() from error


def write_video(path: Path, shown: SideBySide, scene: Scene, slowed: float, done: Callable[[float], None]) -> None:
    """Write a video of model and ghost in a scene, so many times slower than the motion; whole or not at all.

    Raises:
        InputError: a video too long, no encoder, no way to render, or a place that cannot be written.
    """
    instants = _instants(shown, slowed)
    ghost, position = (np.interp(instants, shown.time, signal) for signal in (shown.ghost, shown.position))
    av = _encoder()
    with whole(path) as temporary, _renderer(scene.model) as renderer, av.open(str(temporary), "w", "mp4") as container:
        stream = container.add_stream("libx264", rate=RATE, options={"crf": QUALITY})
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        for count, places in enumerate(zip(position, ghost, instants, strict=True)):
            renderer.update_scene(scene.placed(*places), camera=scene.camera)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(renderer.render(), format="rgb24")))
            done((count + 1) / instants.size)
        container.mux(stream.encode())


def _instants(shown: SideBySide, slowed: float) -> Array:
    """Times of the motion that the frames show - s."""
    first, last = float(shown.time[0]), float(shown.time[-1])
    frames = round((last - first) * slowed * RATE, 6)
    if frames >= MOST:
        found = f"found {last - first:g} s of motion, slowed {slowed:g} times: {frames:g} frames"
        raise InputError("--video", found, f"allowed: up to {MOST}; show a part of it with --from and --to")
    return first + np.arange(int(frames) + 1) / (slowed * RATE)


def _encoder() -> Any:  # noqa: ANN401 - an optional library
    try:
        import av
    except ModuleNotFoundError as error:
        found = "videos are encoded by PyAV, which is not installed"
        raise InputError("--video", found, "install it: pip install 'servobench[video]'") from error
    return av


@contextmanager
def _renderer(model: mujoco.MjModel) -> Iterator[mujoco.Renderer]:
    """MuJoCo's renderer of a model; InputError where nothing on this machine renders."""
    import mujoco

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # GLFW warns of what the error reports
            found = mujoco.Renderer(model, HEIGHT, WIDTH)
    except (ImportError, AttributeError, RuntimeError, mujoco.FatalError) as error:
        raise _unable() from error
    with found:
        yield found


def _unable() -> InputError:
    chosen = os.environ.get("MUJOCO_GL", "not set")
    need = "the libraries of EGL (Debian: libegl1, libgl1-mesa-dri)"
    return InputError(
        "--video",
        f"MuJoCo finds nothing to render with (MUJOCO_GL is {chosen})",
        f"allowed: with a display, or with MUJOCO_GL=egl and {need}; the page needs neither",
    )
