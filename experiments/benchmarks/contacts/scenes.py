"""The four scenes as plain data, for the model of each program; and as TOML for Orthant.

pile    spheres dropped into a square well (core/scenes/spheres.h), µ = .3
chain   rods of 1 m and 1 kg with ball joints, released from the horizontal, the last one pushed
        (core/scenes/spherical_chain.h)
stack   five cubes of .1 m, one on the other, the top one with 1000 times the mass of the others, µ = .5
tower   Kapla: N layers of N planks 11.74 × 2.348 × .78267 cm on a ring (N = 12: of radius 23.48 cm), alternate layers
        half a pitch on, µ = .3

Stack and tower begin at rest with closed contacts. The exact motion is none.
"""
import math
from dataclasses import dataclass, field

import numpy as np

G = 9.81


@dataclass
class Body:
    shape: tuple  # ("sphere", radius), ("box", x, y, z: edges) or ("rod", radius, length: along x, without contact)
    mass: float
    moments: np.ndarray  # principal [kg m²]
    place: np.ndarray
    turn: float = 0.0  # [rad] about z
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    omega: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def rotation(self):
        c, s = math.cos(self.turn), math.sin(self.turn)
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


@dataclass
class Scene:
    bodies: list
    mu: float
    duration: float  # [s]
    size: float  # [m] errors are relative to it: a sphere's radius, the chain's length, the least edge
    planes: list = field(default_factory=list)  # (point, normal) of half-spaces
    joints: list = field(default_factory=list)  # balls and sockets: (body or −1 the ground, body, point in the world)


def sphere(radius, density, place):
    radius = float(radius)
    mass = float(density) * 4 / 3 * math.pi * radius**3
    return Body(("sphere", radius), mass, np.full(3, 0.4 * mass * radius**2), np.array(place, float))


def box(edges, mass, place, turn=0.0):
    x, y, z = edges
    moments = mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    return Body(("box", x, y, z), mass, moments, np.array(place, float), turn)


FLOOR = (np.zeros(3), np.array([0.0, 0, 1]))


def pile(count, radius=0.05, density=1000.0):
    """Radii and places are those of core/scenes/spheres.cpp."""
    i = np.arange(count)
    pattern = lambda ratio: np.mod(ratio * i, 1.0) - 0.5
    side = next(s for s in range(1, count + 1) if (s + 1)**3 > count)
    apart, shift = 2.2 * radius, 0.15 * radius
    radii = radius * (1 - 0.1 * (pattern((1 + math.sqrt(5)) / 2) + 0.5))
    place = np.stack([(i % side + 0.5) * apart + shift * pattern(math.sqrt(2)),
                      (i // side % side + 0.5) * apart + shift * pattern(math.sqrt(3)),
                      (i // (side * side) + 0.5) * apart], axis=1)
    width = side * apart
    walls = [(np.array(p, float), np.array(n, float)) for p, n in
             (((0, 0, 0), (1, 0, 0)), ((width, 0, 0), (-1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, width, 0), (0, -1, 0)))]
    return Scene([sphere(r, density, p) for r, p in zip(radii, place)], 0.3, 0.4, radius, [FLOOR, *walls])


def chain(links, radius=0.05, push=1.0):
    across = 1 / 12 + radius**2 / 4
    bodies = [Body(("rod", radius, 1.0), 1.0, np.array([radius**2 / 2, across, across]), np.array([i + 0.5, 0, 0]))
              for i in range(links)]
    bodies[-1].velocity, bodies[-1].omega = np.array([0, push / 2, 0]), np.array([0, 0, push])
    joints = [(i - 1, i, np.array([float(i), 0, 0])) for i in range(links)]
    return Scene(bodies, 0.0, 0.5, float(links), joints=joints)


def stack(count, edge=0.1, ratio=1e3):
    masses = [1.0] * (count - 1) + [ratio]
    return Scene([box((edge, edge, edge), m, (0, 0, (i + 0.5) * edge)) for i, m in enumerate(masses)], 0.5, 0.5, edge,
                 [FLOOR])


PLANK, RING, DENSITY = (0.1174, 0.02348, 0.0078267), 0.2348, 650.0  # [m, m, kg/m³]


def tower(count):
    """The ring grows with the planks of a layer: they do not overlap from four on."""
    pitch, mass = 2 * math.pi / count, DENSITY * math.prod(PLANK)
    ring = RING * count / 12
    bodies = []
    for layer in range(count):
        for k in range(count):
            at = (k + layer % 2 / 2) * pitch
            bodies.append(box(PLANK, mass, (ring * math.cos(at), ring * math.sin(at), (layer + 0.5) * PLANK[2]),
                              at + math.pi / 2))
    return Scene(bodies, 0.3, 0.2, PLANK[2], [FLOOR])


SCENES = {"pile": pile, "chain": chain, "stack": stack, "tower": tower}
SIZES = {"pile": 100, "chain": 10, "stack": 5, "tower": 8}
QUICK_SIZES = {"pile": 30, "chain": 5, "stack": 5, "tower": 4}


def toml(scene):
    """As a file for Orthant. 17 digits: the same numbers."""
    vector = lambda v: "[" + ", ".join(repr(float(x)) for x in v) + "]"
    lines = ["dimension = 3", f"gravity = [0, 0, {-G}]", f"duration = {scene.duration}", "step = 0.001"]
    for k, b in enumerate(scene.bodies):
        turn = [math.cos(b.turn / 2), 0, 0, math.sin(b.turn / 2)]
        lines += ["[[body]]", f'name = "b{k}"', f"mass = {b.mass!r}", f"inertia = {vector(b.moments)}",
                  f"position = {vector(b.place)}", f"orientation = {vector(turn)}", f"velocity = {vector(b.velocity)}",
                  f"omega = {vector(b.omega)}"]
    for a, b, point in scene.joints:
        lines += ["[[joint]]", 'type = "spherical"', f'bodies = ["{"ground" if a < 0 else f"b{a}"}", "b{b}"]',
                  f"point_a = {vector(point - (scene.bodies[a].place if a >= 0 else 0))}",
                  f"point_b = {vector(point - scene.bodies[b].place)}"]
    if scene.planes:
        shape = {"sphere": lambda b: f"radius = {b.shape[1]!r}", "box": lambda b: f"size = {vector(b.shape[1:])}"}
        shapes = ",\n  ".join(f'{{body = "b{k}", {shape[b.shape[0]](b)}}}' for k, b in enumerate(scene.bodies))
        walls = ", ".join(f"{{point = {vector(p)}, normal = {vector(n)}}}" for p, n in scene.planes)
        lines += ["[[collision]]", f"mu = {scene.mu}", "e_n = 0", f"walls = [{walls}]", "neighbours = 60",
                  f"shapes = [\n  {shapes},\n]"]
    return "\n".join(lines) + "\n"
