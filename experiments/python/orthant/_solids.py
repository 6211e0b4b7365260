"""Drawings of scenes in space by matplotlib: shaded faces of the bodies, marks of joints."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from . import _orthant

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]

_GROUND = "#5c6670"
_LIGHT = (0.35, -0.55, 0.76)  # direction to it, from the right front above


class SolidSketch:
    """The drawing of a scene in space: faces of bodies moved into a pose."""

    projection = "3d"

    def __init__(self, scene: _orthant._Scene, colours: list[str]) -> None:
        import numpy as np

        drawing = json.loads(scene.drawing)
        self.colours, self.joints, self.bodies = colours, drawing["joints"], len(drawing["bodies"])
        self.solids = [(body, plane, np.array(points), faces, solid["kind"])
                       for (body, plane, points, faces), solid in zip(scene.surfaces, drawing["solids"])]

    @staticmethod
    def place(poses: Array, body: int, points: Any) -> Array:
        """Points (n, 3) of a body in the world."""
        import numpy as np

        own: Array = np.asarray(points, dtype=float)
        if body < 0:
            return own
        x, (w, a, b, c) = poses[7 * body:7 * body + 3], poses[7 * body + 3:7 * body + 7]
        turn = np.array([[1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)],
                         [2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)],
                         [2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)]])
        return np.asarray(x + own @ turn.T)

    def extent(self, poses: Array) -> list[Array]:
        """All points but those of planes, which are wider than all else."""
        points = [self.place(poses, body, [[0, 0, 0]]) for body in range(self.bodies)]
        points += [self.place(poses, body, own) for body, plane, own, _, _ in self.solids if not plane]
        points += [self.place(poses, joint["a"], [joint["point_a"]]) for joint in self.joints]
        return [point for many in points for point in many]

    @staticmethod
    def limits(points: list[Array]) -> tuple[float, ...]:
        import numpy as np

        low, high = np.min(points, axis=0), np.max(points, axis=0)
        widest = max(float(np.max(high - low)), 1e-9)
        wide = np.maximum(high - low, 0.25 * widest) + 0.08 * widest
        middle = (low + high) / 2
        return tuple(float(v) for pair in zip(middle - wide / 2, middle + wide / 2) for v in pair)

    def into(self, axes: Any, poses: Array, limits: tuple[float, ...]) -> None:
        import numpy as np
        from matplotlib.colors import to_rgb
        from matplotlib.ticker import MaxNLocator
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        low, high = np.array(limits[0::2]), np.array(limits[1::2])
        faces, colours, edges = [], [], []
        light = np.array(_LIGHT) / np.linalg.norm(_LIGHT)
        for body, plane, own, own_faces, kind in self.solids:
            if plane:  # no wider than the picture
                middle = own.mean(axis=0)
                share = float(np.linalg.norm(high - low) / np.linalg.norm(own[2] - own[0]))
                own = middle + (own - middle) * min(1.0, share)
            points = self.place(poses, body, own)
            colour = np.array(to_rgb(_GROUND if body < 0 else self.colours[body % len(self.colours)]))
            for face in own_faces:
                corners, middle = points[face], own[face].mean(axis=0)
                normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
                length = float(np.linalg.norm(normal))
                shade = 0.45 + 0.55 * max(0.0, float(normal @ light) / length) if length > 0 else 1.0
                if kind == "sphere" and np.prod(middle - own.mean(axis=0)) > 0:
                    shade *= 0.75  # every second octant, so that turning is seen
                pale = 0.12 if plane else 0.25 if kind == "socket" else 0.95
                faces.append(corners)
                colours.append((*np.clip(shade * colour + 0.1, 0, 1), pale))
                edges.append((*colour * 0.5, 0.6 if kind in ("polytope", "plane") else 0.0))
        axes.add_collection3d(Poly3DCollection(faces, facecolors=colours, edgecolors=edges, linewidths=0.6))
        for joint in self.joints:
            at = self.place(poses, joint["body"], [joint["point"]])[0]
            axes.plot(*([v] for v in at), "o", color="white", mec="#1b1f24", ms=4, zorder=10)
        axes.set(xlim=limits[0:2], ylim=limits[2:4], zlim=limits[4:6], xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        for number, axis in enumerate((axes.xaxis, axes.yaxis, axes.zaxis)):
            axis.set_major_locator(MaxNLocator(3 if high[number] - low[number] < 0.4 * max(high - low) else 5))
        axes.set_box_aspect(high - low)
        axes.view_init(elev=22, azim=-55)
