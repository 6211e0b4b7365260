"""Pictures: pages of runs, plots and drawings by matplotlib, films by ffmpeg."""

from __future__ import annotations

import html
import io
import json
import math
import os
import shutil
import tempfile
from typing import TYPE_CHECKING, Any, Callable, Sequence, Union

from . import _orthant
from ._solids import SolidSketch
from ._spec import installed, path

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._trajectory import Trajectory

    File = Union[str, os.PathLike[str], None]
    Poses = npt.NDArray[np.float64]

_UNITS = {
    "x": "m", "y": "m", "z": "m", "gap": "m", "theta": "rad", "angle": "rad", "displacement": "m", "vx": "m/s",
    "vy": "m/s", "vz": "m/s", "omega": "rad/s", "wx": "rad/s", "wy": "rad/s", "wz": "rad/s", "impulse_n": "N s",
    "impulse_t": "N s", "impulse_t1": "N s", "impulse_t2": "N s", "impulse": "N s", "energy": "J", "penetration": "m",
    "joint_residual": "m"
}
_COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56a0d3", "#6b4fa0", "#8a4b2a", "#444c55"]
_MOST_PICTURES = 100_000  # of a film: more than an hour at 25 a second
_LARGEST_FRAME = 8 << 20  # [bytes] of a page inside a notebook


def write_view(page: str, file: File) -> str:
    if file is None:
        import webbrowser

        handle, name = tempfile.mkstemp(prefix="orthant_", suffix=".html")
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(page)
        webbrowser.open("file://" + name)
        return name
    name = path("file", file)
    with open(name, "w", encoding="utf-8") as stream:
        stream.write(page)
    return name


def in_frame(page: str, words: str) -> str:
    """A page inside a page; of a very large one only words."""
    if len(page) > _LARGEST_FRAME:
        return f"<p>{html.escape(words)}: too large to show here, .view('run.html') writes it</p>"
    return (f'<iframe srcdoc="{html.escape(page)}" sandbox="allow-scripts allow-downloads" width="100%" height="900" '
            f'style="border: 0" title="{html.escape(words)}"></iframe>')


def _axes(axes: Any, projection: Any = None, **size: Any) -> Any:
    if axes is not None:
        return axes
    installed("matplotlib", "a picture")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(**size)  # of no window: nothing stays open
    FigureCanvasAgg(figure)
    return figure.add_subplot(projection=projection)


def _saved(axes: Any, file: File) -> Any:
    if file is not None:
        room = 0.3 if axes.name == "3d" else 0.1  # [inches] matplotlib forgets the label of z
        name = path("file", file)
        known = axes.figure.canvas.get_supported_filetypes()
        if (end := os.path.splitext(name)[1][1:].lower()) not in known:
            raise ValueError(f"{name}: must end in one of {', '.join('.' + one for one in sorted(known))}")
        axes.figure.savefig(name, bbox_inches="tight", pad_inches=room, dpi=150)
    return axes


def svg_of(draw: Callable[[], Any]) -> str:
    stream = io.StringIO()
    draw().figure.savefig(stream, format="svg", bbox_inches="tight")
    return stream.getvalue()[stream.getvalue().index("<svg"):]


def plot_columns(run: Trajectory, columns: Sequence[str], file: File, axes: Any) -> Any:
    values = [run[column] for column in columns]
    axes = _axes(axes, figsize=(7, 3.2), layout="constrained")
    for i, (column, value) in enumerate(zip(columns, values)):
        axes.plot(run.t, value, color=_COLOURS[i % len(_COLOURS)], lw=1.3, label=column)
    units = list(dict.fromkeys(unit for column in columns if (unit := _UNITS.get(column.rsplit(".", 1)[-1], ""))))
    axes.set_xlabel("t [s]")
    axes.set_ylabel(f"[{', '.join(units)}]" if units else "")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)
    return _saved(axes, file)


class _Sketch:
    """The drawing of a planar scene: points of bodies moved into a pose."""

    projection = None

    def __init__(self, scene: _orthant._Scene) -> None:
        drawing = json.loads(scene.drawing)
        self.outlines, self.pins = drawing["outlines"], drawing["pins"]
        self.bodies = len(drawing["bodies"])
        self.drawn = {outline["body"] for outline in self.outlines}

    @staticmethod
    def place(poses: Poses, body: int, point: Sequence[float]) -> tuple[float, float]:
        if body < 0:
            return point[0], point[1]
        x, y, angle = (float(q) for q in poses[3 * body:3 * body + 3])
        c, s = math.cos(angle), math.sin(angle)
        return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]

    def extent(self, poses: Poses) -> list[tuple[float, float]]:
        """All points but the walls', which are longer than all else."""
        points = [self.place(poses, body, (0, 0)) for body in range(self.bodies)]
        for outline in self.outlines:
            if not outline["wall"]:
                points += [self.place(poses, outline["body"], point) for point in outline["points"]]
        return points + [self.place(poses, pin["a"], pin["point_a"]) for pin in self.pins]

    def into(self, axes: Any, poses: Poses, limits: tuple[float, float, float, float]) -> None:
        axes.set_aspect("equal")
        for outline in self.outlines:
            body = outline["body"]
            xs, ys = zip(*(self.place(poses, body, point) for point in outline["points"]))
            colour = "#5c6670" if body < 0 else _COLOURS[body % len(_COLOURS)]
            if outline["closed"]:
                axes.fill(xs, ys, facecolor=colour + "2e", edgecolor=colour, lw=1.5)
            else:
                axes.plot(xs, ys, color=colour, lw=1.5 if outline["wall"] else 2.5, solid_capstyle="round")
        for body in set(range(self.bodies)) - self.drawn:
            axes.plot(*self.place(poses, body, (0, 0)), "o", color=_COLOURS[body % len(_COLOURS)], ms=5)
        for pin in self.pins:
            axes.plot(*self.place(poses, pin["body"], pin["point"]), "o", color="white", mec="#1b1f24", ms=5, zorder=5)
        axes.set(xlim=limits[:2], ylim=limits[2:], xlabel="x [m]", ylabel="y [m]")

    @staticmethod
    def limits(points: list[tuple[float, float]]) -> tuple[float, float, float, float]:
        return _limits(points)


def _sketch(scene: _orthant._Scene) -> Any:
    return _Sketch(scene) if scene.dimension == 2 else SolidSketch(scene, _COLOURS)


def _limits(points: list[tuple[float, float]]) -> tuple[float, float, float, float]:
    xs, ys = zip(*points)
    margin = 0.08 * max(max(xs) - min(xs), max(ys) - min(ys), 1e-9)
    wide = max((max(ys) - min(ys) - max(xs) + min(xs)) / 4, 0.0)
    tall = max((max(xs) - min(xs) - max(ys) + min(ys)) / 4, 0.0)
    return min(xs) - margin - wide, max(xs) + margin + wide, min(ys) - margin - tall, max(ys) + margin + tall


def draw_pose(scene: _orthant._Scene, poses: Poses, file: File, axes: Any) -> Any:
    sketch = _sketch(scene)
    axes = _axes(axes, sketch.projection, figsize=(6.4, 4.4), layout="constrained")
    sketch.into(axes, poses, sketch.limits(sketch.extent(poses)))
    return _saved(axes, file)


def write_film(run: Trajectory, file: str, speed: float, fps: int) -> None:
    if not speed > 0:
        raise ValueError(f"speed = {speed:g}: must be > 0")
    end = os.path.splitext(file)[1]
    if end not in (".mp4", ".gif", ""):
        raise ValueError(f"{file}: must end in .mp4 or .gif, or be a folder for pictures")
    if end == ".mp4" and shutil.which("ffmpeg") is None:
        raise RuntimeError(f"{file}: needs the program ffmpeg; a .gif or a folder of pictures needs none")
    import numpy as np
    installed("matplotlib", "a film")
    from matplotlib.animation import FFMpegWriter, PillowWriter

    t = run.t
    wanted = (t[-1] - t[0]) / speed * fps
    if wanted > _MOST_PICTURES:
        raise ValueError(f"speed = {speed:g}: gives {wanted:g} pictures: must be at most {_MOST_PICTURES}")
    count = max(2, int(wanted) + 1)
    rows = np.searchsorted(t, np.linspace(t[0], t[-1], count), side="right") - 1
    sketch = _sketch(run._scene)
    corners = [point for row in rows[:: max(1, count // 100)] for point in sketch.extent(run._poses(int(row)))]
    limits = sketch.limits(corners)
    axes = _axes(None, sketch.projection, figsize=(6.4, 4.8), layout="constrained")

    def show(row: int) -> None:
        axes.clear()
        sketch.into(axes, run._poses(row), limits)
        axes.set_title(f"t = {t[row]:.4g} s", loc="left", fontsize=10)

    if end == "":
        os.makedirs(file, exist_ok=True)
        for number, row in enumerate(rows):
            show(int(row))
            axes.figure.savefig(os.path.join(file, f"frame_{number + 1:05}.png"), dpi=100)
        return
    writer: Any = FFMpegWriter(fps=fps) if end == ".mp4" else PillowWriter(fps=fps)
    with writer.saving(axes.figure, file, 100):
        for row in rows:
            show(int(row))
            writer.grab_frame()
