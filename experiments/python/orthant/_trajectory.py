"""Trajectories: the rows, events and outcome of a run, as arrays, pictures, pages and files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

from . import _orthant
from ._custom import without_functions
from ._orthant import Problem
from ._pictures import draw_pose, in_frame, plot_columns, write_film, write_view
from ._spec import installed, number, path, whole

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import pandas

    from ._derivatives import RunAdjoint, RunGradient, RunTangent


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a simulation. `run` is the Trajectory up to there, with the status 'cancelled'."""

    def __init__(self, run: Trajectory) -> None:
        super().__init__(f"the simulation was interrupted at t = {run.summary['t']:g} s; .run keeps it")
        self.run: Trajectory = run


class Trajectory:
    """A run: `columns` name those of `table` (rows, columns), SI units; trajectory["ball.y"] is one of them.

    summary: status, time reached, worst joint residual, penetration, ...
    unsolved: the Problem that stopped it, else None.
    warnings: what the run warned of, a list of texts; why: in words, why it ended, and those warnings.
    final: the last row by column.

    In space `final` and trajectory["NAME"] have the coordinates of joints too, which are no columns of the table:
    "JOINT.angle" [rad], followed through full turns from row to row, and "JOINT.displacement" [m].
    """

    def __init__(self, scene: _orthant._Scene, columns: list[str], table: npt.NDArray[np.float64],
                 summary: dict[str, Any], unsolved: Optional[Problem], events: tuple[Any, ...], warned: list[str],
                 joints: dict[str, npt.NDArray[np.float64]], pushes: Any = ()) -> None:
        self.columns: list[str] = columns
        self.table: npt.NDArray[np.float64] = table
        self.summary: dict[str, Any] = summary
        self.unsolved: Optional[Problem] = unsolved
        self.warnings: list[str] = warned
        self._scene, self._events, self._joints, self._pushes = scene, events, joints, pushes
        self._place = {name: i for i, name in enumerate(columns)}
        self._how: Optional[dict[str, Any]] = None  # how simulate made it

    def __getstate__(self) -> dict[str, Any]:
        state, scene = dict(self.__dict__), self._scene
        if scene.customs:
            state["_scene"] = _orthant._Scene(scene.text, scene.name, scene.sets, without_functions(scene.customs))
        return state

    @property
    def status(self) -> str:
        """'solved', 'time_limit', 'stalled', ...: statuses in the documentation."""
        return str(self.summary["status"])

    @property
    def solved(self) -> bool:
        """status is 'solved': every step up to the duration was."""
        return self.status == "solved"

    @property
    def why(self) -> str:
        """Why the run ended where it is not solved, then what it warned of; empty: it is solved, without a warning."""
        ended = str(self.summary["why"])
        if not ended and not self.solved:
            ended = f"step {self.summary['steps'] + 1} at t = {self.summary['t']:g} s: {self.status}"
        return "\n".join(([ended] if ended else []) + self.warnings)

    @property
    def events(self) -> npt.NDArray[Any]:
        """The events as a table: a structured array with the columns t [s], kind, contact, impulse_n, impulse_t [N s].

        kind: impact, accumulation, touch, release, stick, slip. "adaptive" and "event-driven" locate events; of
        other integrators the table is empty. run.events["t"] is a column; pandas.DataFrame(run.events) takes the whole.
        """
        import numpy as np

        t, kind, contact, normal, tangent = self._events
        kinds, contacts = np.array(_orthant._event_kinds), np.array(self._scene.contacts or [""])
        table = np.empty(len(t), [("t", float), ("kind", kinds.dtype), ("contact", contacts.dtype),
                                  ("impulse_n", float), ("impulse_t", float)])
        table["t"], table["kind"], table["contact"] = t, kinds[kind], contacts[contact]
        table["impulse_n"], table["impulse_t"] = normal, tangent
        return table

    @property
    def t(self) -> npt.NDArray[np.float64]:
        """(rows,) [s]"""
        return self["t"]

    @property
    def final(self) -> dict[str, float]:
        """The last row by column, in space with the coordinates of joints."""
        row = dict(zip(self.columns, self.table[-1].tolist()))
        row.update((name, float(values[-1])) for name, values in self._joints.items())
        return row

    def __getitem__(self, column: str) -> npt.NDArray[np.float64]:
        if column in self._joints:
            return self._joints[column]
        if column not in self._place:
            raise KeyError(f"{column}: must be one of {', '.join([*self.columns, *self._joints])}")
        return self.table[:, self._place[column]]

    def __len__(self) -> int:
        return len(self.table)

    def gradient(self, of: str, wrt: Union[str, Sequence[str]], *, at: str = "records",
                 mode: str = "auto") -> RunGradient:
        """Derivatives of a column along this run with respect to parameters, as `orthant.gradient`: the run is
        repeated."""
        from ._derivatives import gradient

        return gradient(self._scene, of, wrt, at=at, mode=mode, **self._repeated())

    def jvp(self, of: Union[str, Sequence[str]], change: Mapping[str, float]) -> RunTangent:
        """Derivatives of columns along a change of parameters {name: change}, a row a record: forward mode."""
        from ._derivatives import jvp

        return jvp(self._scene, of, change, **self._repeated())

    def vjp(self, weights: Mapping[str, Any], wrt: Union[str, Sequence[str]]) -> RunAdjoint:
        """Gradient of the sum of weight * value over columns and rows, {column: a number, for the last row, or one a
        row}.

        Reverse mode: the cost does not grow with the parameters. The run is repeated.
        """
        from ._derivatives import vjp

        return vjp(self._scene, weights, wrt, **self._repeated())

    def _repeated(self) -> dict[str, Any]:
        if self._how is None:
            raise ValueError(
                "gradient: must be of a run by simulate in this process, without elements written in Python")
        return self._how

    def frame(self) -> pandas.DataFrame:
        """As a pandas frame, indexed by time."""
        installed("pandas", "to_pandas()")
        import pandas

        return pandas.DataFrame(self.table, columns=self.columns).set_index("t")

    def to_pandas(self) -> pandas.DataFrame:
        """The same as frame()."""
        return self.frame()

    def view(self, file: Union[str, os.PathLike[str], None] = None) -> str:
        """The run as one HTML page, with animation, contact forces, plots of any column and events: `file`, whose path
        is returned. Without a file the page is a temporary one, and a browser opens it."""
        return write_view(self._page(), file)

    def _page(self) -> str:
        note = f"{self.status}, {len(self)} rows" + (f"; {self.why}" if self.why else "")
        name = os.path.splitext(os.path.basename(self._scene.name))[0]
        return _orthant._view_page(name, note, self._scene, self.columns, self.table, self._events, self._pushes)

    def _repr_html_(self) -> str:
        """In a notebook: the page of view() in a frame."""
        return in_frame(self._page(), repr(self))

    def plot(self, *columns: str, file: Union[str, os.PathLike[str], None] = None, axes: Any = None) -> Any:
        """Columns over time, by matplotlib; default: the energy. axes: drawn into these, else a figure of their own.
        file: also written there, .png, .svg or .pdf. Returns the axes."""
        return plot_columns(self, columns or ("energy",), file, axes)

    def draw(self, t: Optional[float] = None, *, file: Union[str, os.PathLike[str], None] = None,
             axes: Any = None) -> Any:
        """The mechanism at the recorded time next to t [s], default the last one, by matplotlib; file, axes as in
        plot()."""
        import numpy as np

        row = len(self) - 1
        if t is not None:
            if not self.t[0] <= number("t", t) <= self.t[-1]:
                raise ValueError(f"t = {t:g}: must be in [{self.t[0]:g}, {self.t[-1]:g}] [s]")
            row = int(np.argmin(np.abs(self.t - t)))
        return draw_pose(self._scene, self._poses(row), file, axes)

    def _poses(self, row: int) -> npt.NDArray[np.float64]:
        import numpy as np

        parts = ("x", "y", "theta") if self._scene.dimension == 2 else ("x", "y", "z", "qw", "qx", "qy", "qz")
        places = [self._place[f"{body}.{part}"] for body in self._scene.bodies for part in parts]
        return np.asarray(self.table[row, places])

    def film(self, file: Union[str, os.PathLike[str]], *, speed: float = 1.0, fps: int = 25) -> None:
        """The motion as a film by matplotlib: .mp4 or .gif (the first needs ffmpeg), or a folder, which gets a PNG
        picture a frame. speed: 1 is real time, 0.1 ten times slower. fps: frames a second."""
        write_film(self, path("file", file), number("speed", speed), whole("fps", fps, 1, 1000))

    def write(self, file: Union[str, os.PathLike[str]]) -> None:
        """As a file, by its name's end: .csv, .h5 (HDF5, a data set a column), .pvd (VTK of the outlines or surfaces,
        for ParaView).
        Events go into NAME.events.csv next to it, or into the HDF5 file's group "events"."""
        _orthant._write_trajectory(path("file", file), self._scene, self.columns, self.table, self._events)

    def __repr__(self) -> str:
        return f"Trajectory(status='{self.status}', rows={len(self)}, t={self.summary['t']:g})"
