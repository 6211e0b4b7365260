"""What a program achieved: measures that are the same for all, from states and impulses that it reports.

moved         stack, tower: the largest way of a corner from where it began, over the least edge; exactly 0
error         chain: the end of the last rod against a reference, over the chain's length
overlap       pile: the largest overlap of two spheres or a wall, over the radius
law           what the impulses of the last step miss of Signorini's and Coulomb's laws, as the natural map of
              K* ∋ û ⊥ r ∈ K: u = q + W r are the velocities at the contacts that follow from these impulses, with
              (gap)⁺/h in the normal direction, û = u + µ ‖u_T‖ n. Contact by contact scaled by d = (tr W_aa/3)^−½, over
              ‖q'‖: neither units nor masses matter
unexplained   the part of the velocities' change that these impulses and the weight do not explain, in the metric of the
              masses, over the step's weight: large means that impulses were read wrongly, or are not all
joints        chain: the largest distance of two points that a joint should keep together, over the chain's length
energy        chain: the change of the energy, over the energy that the fall has turned into motion
"""
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from scenes import G


@dataclass
class Contact:
    """Between bodies a and b (−1: the ground); the normal points to a."""
    a: int
    b: int
    point: np.ndarray  # on a
    normal: np.ndarray
    impulse: np.ndarray  # on a [N s], in the world
    gap: float
    other: np.ndarray = None  # the point on b, if it is another one


@dataclass
class Pose:
    place: np.ndarray  # (n, 3)
    rotation: np.ndarray  # (n, 3, 3)
    velocity: np.ndarray  # (n, 3)
    omega: np.ndarray  # (n, 3), in the world


def moved(scene, pose):
    most = 0.0
    for k, b in enumerate(scene.bodies):
        half = np.array(b.shape[1:]) / 2
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
        now, start = corners @ pose.rotation[k].T + pose.place[k], corners @ b.rotation.T + b.place
        most = max(most, np.max(np.linalg.norm(now - start, axis=1)))
    return most / scene.size


def overlap(scene, pose):
    radius, x = np.array([b.shape[1] for b in scene.bodies]), pose.place
    gaps = [np.min((x - p) @ n - radius) for p, n in scene.planes]
    gaps += [np.min(np.linalg.norm(x[i + 1:] - x[i], axis=1) - radius[i + 1:] - radius[i]) for i in range(len(x) - 1)]
    return max(0.0, -min(gaps)) / scene.size


def tip(pose):
    return pose.place[-1] + pose.rotation[-1] @ np.array([0.5, 0, 0])


def joint_gaps(scene, pose):
    """The largest, over the size."""
    at = lambda k, point: point if k < 0 else pose.place[k] + pose.rotation[k] @ (point - scene.bodies[k].place)
    return max(np.linalg.norm(at(a, p) - at(b, p)) for a, b, p in scene.joints) / scene.size


def energies(scene, pose):
    """Of motion, and of height."""
    motion = height = 0.0
    for k, b in enumerate(scene.bodies):
        w = pose.rotation[k].T @ pose.omega[k]
        motion += 0.5 * b.mass * pose.velocity[k] @ pose.velocity[k] + 0.5 * w @ (b.moments * w)
        height += b.mass * G * pose.place[k][2]
    return motion, height


def start(scene):
    return Pose(np.array([b.place for b in scene.bodies]), np.array([b.rotation for b in scene.bodies]),
                np.array([b.velocity for b in scene.bodies]), np.array([b.omega for b in scene.bodies]))


def energy_change(scene, pose):
    now, was = energies(scene, pose), energies(scene, start(scene))
    return abs(sum(now) - sum(was)) / max(abs(now[1] - was[1]), 1e-300)


def frame(n):
    t = np.cross(n, [1.0, 0, 0] if abs(n[0]) < 0.7 else [0, 1.0, 0])
    t /= np.linalg.norm(t)
    return np.array([n, t, np.cross(n, t)])


def natural_map(x, mu):
    """Projections of the rows of x = (normal, tangents) onto the cones ‖t‖ ≤ µ n."""
    size = np.linalg.norm(x[:, 1:], axis=1)
    a = np.maximum((x[:, 0] + mu * size) / (1 + mu * mu), 0)
    to = np.column_stack([a, x[:, 1:] * (mu * a / np.where(size > 0, size, 1))[:, None]])
    return np.where((size <= mu * x[:, 0])[:, None], x, to)


def law(scene, before, after, contacts, h):
    """The law's residual and the unexplained part: see above. Nothing if there are no contacts."""
    contacts = [c for c in contacts if c.a >= 0 or c.b >= 0]  # some programs list floor and walls
    if not contacts:
        return None, None
    n, c = len(scene.bodies), len(contacts)
    rows, columns, values = [], [], []
    r, gap = np.empty((c, 3)), np.array([contact.gap for contact in contacts])
    for k, contact in enumerate(contacts):
        F = frame(contact.normal)
        r[k] = F @ contact.impulse
        other = contact.point if contact.other is None else contact.other
        for body, sign, point in ((contact.a, 1.0, contact.point), (contact.b, -1.0, other)):
            if body < 0:
                continue
            arm = point - before.place[body]
            block = sign * np.hstack([F, np.cross(arm, F)])
            rows += [3 * k + i for i in range(3) for _ in range(6)]
            columns += [6 * body + j for _ in range(3) for j in range(6)]
            values += list(block.ravel())
    J = sparse.csr_matrix((values, (rows, columns)), (3 * c, 6 * n))
    inverse, metric, free = [], [], np.empty(6 * n)
    for k, b in enumerate(scene.bodies):
        R = before.rotation[k]
        inertia, turn = R @ np.diag(b.moments) @ R.T, R @ np.diag(1 / b.moments) @ R.T
        inverse += [np.eye(3) / b.mass, turn]
        metric += [np.eye(3) * b.mass, inertia]
        w = before.omega[k]
        free[6 * k:6 * k + 3] = before.velocity[k] + [0, 0, -G * h]
        free[6 * k + 3:6 * k + 6] = w - h * turn @ np.cross(w, inertia @ w)
    to_motion, metric = sparse.block_diag(inverse).tocsr() @ J.T, sparse.block_diag(metric).tocsr()
    push = to_motion @ r.ravel()
    missed = np.column_stack([after.velocity, after.omega]).ravel() - free - push
    weight = np.sqrt(sum(b.mass for b in scene.bodies)) * G * h
    q = (J @ free).reshape(c, 3)
    q[:, 0] += np.maximum(gap, 0) / h
    u = q + (J @ push).reshape(c, 3)
    own = np.asarray(J.multiply(to_motion.T).sum(axis=1)).ravel().reshape(c, 3).mean(axis=1)  # tr W_aa / 3
    d = 1 / np.sqrt(own)[:, None]
    q, u, r = q * d, u * d, r / d
    u[:, 0] += scene.mu * np.linalg.norm(u[:, 1:], axis=1)
    return float(np.linalg.norm(r - natural_map(r - u, scene.mu)) / np.linalg.norm(q)), float(
        np.sqrt(missed @ (metric @ missed)) / weight)
