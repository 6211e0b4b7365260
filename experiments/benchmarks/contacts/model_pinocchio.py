"""Pinocchio (pin) with its collision library coal: rigid contacts, Coulomb's cone by ADMM or Gauss-Seidel.

It has no loop of steps: here v' = v + h M⁻¹ (f + Jᵀ λ), q' = q + h v', with λ such that no gap closes beyond 0 in the
step (its problem of constraints, over its own factorization of the Delassus matrix). ADMM by its defaults, or to 1e-10;
warm. Normals and patches are coal's, within the way of a step. The chain has joint coordinates, without
constraints. Seconds are those of Pinocchio's and coal's calls: the loop and the lists of contacts, in Python, are not
counted.
"""
import math
import time

import coal
import numpy as np
import pinocchio as pin
import scipy.sparse as sparse

from achieved import Contact, Pose
from scenes import G

SETTINGS = {"ADMM": ("ADMM", 1e-6, 1000, False), "ADMM to 1e-10": ("ADMM", 1e-10, 10000, False),
            "ADMM, sparse": ("ADMM", 1e-6, 1000, True), "PGS": ("PGS", 1e-6, 1000, False)}


DAMPING = 1e-10  # [1/kg] of the factorization: contacts are redundant; ADMM replaces it by its own


def axes(n):
    """The normal as the last column of a rotation."""
    x, y, z = n.tolist()
    if abs(x) < 0.7:
        t = np.array([0.0, z, -y]) / math.hypot(y, z)
    else:
        t = np.array([-z, 0.0, x]) / math.hypot(x, z)
    a, b, c = t.tolist()
    return np.column_stack([t, np.array([y * c - z * b, z * a - x * c, x * b - y * a]), n])


KEPT = {}  # data by the number of joints: a process has one scene


def data_of(model):
    if model.njoints not in KEPT:
        KEPT[model.njoints] = model.createData()
    return KEPT[model.njoints]


class Clock:
    """Adds up the processor time of calls."""
    def __init__(self):
        self.seconds = 0.0

    def __call__(self, call, *arguments):
        begin = time.thread_time()
        result = call(*arguments)
        self.seconds += time.thread_time() - begin
        return result


class Model:
    @staticmethod
    def settings(scene):
        return ["joint coordinates"] if scene == "chain" else list(SETTINGS)

    def prepare(self, scene):
        """Its tables take 3 s for 40 free bodies, and grow faster than their square: they are made once."""
        data_of(self.start(scene)[0])

    def start(self, scene):
        """Model, configuration and velocities."""
        return self.chain(scene) if scene.joints else self.free_bodies(scene)

    def run(self, scene, setting, h):
        model, q, v = self.start(scene)
        self.model, self.data, self.clock = model, data_of(model), Clock()
        if not scene.joints:
            self.collisions(scene)
        steps, contacts, before = round(scene.duration / h), None, None
        self.guess = {}
        for k in range(steps):
            if k == steps - 1:
                before = self.pose(scene, q, v)
            if scene.joints:
                free = v + h * self.clock(pin.aba, model, self.data, q, v, np.zeros(model.nv))
            else:
                free, contacts = self.touched(scene, SETTINGS[setting], q, v, h)
            v, q = free, self.clock(pin.integrate, model, q, h * free)
        return {"h": h, "seconds": self.clock.seconds, "steps": steps, "before": before,
                "after": self.pose(scene, q, v), "contacts": contacts}

    @staticmethod
    def free_bodies(scene):
        model, q, v = pin.Model(), [], []
        for k, b in enumerate(scene.bodies):
            joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), f"b{k}")
            model.appendBodyToJoint(joint, pin.Inertia(b.mass, np.zeros(3), np.diag(b.moments)), pin.SE3.Identity())
            q += [*b.place, *pin.Quaternion(b.rotation).coeffs()]
            v += [*(b.rotation.T @ b.velocity), *(b.rotation.T @ b.omega)]
        model.gravity = pin.Motion(np.array([0, 0, -G, 0, 0, 0]))
        return model, np.array(q), np.array(v)

    @staticmethod
    def chain(scene):
        model, joint = pin.Model(), 0
        for k, b in enumerate(scene.bodies):
            at = pin.SE3(np.eye(3), np.array([0.0 if k == 0 else 1.0, 0, 0]))
            joint = model.addJoint(joint, pin.JointModelSpherical(), at, f"b{k}")
            model.appendBodyToJoint(joint, pin.Inertia(b.mass, np.array([0.5, 0, 0]), np.diag(b.moments)),
                                    pin.SE3.Identity())
        model.gravity = pin.Motion(np.array([0, 0, -G, 0, 0, 0]))
        v = np.zeros(model.nv)
        v[-3:] = scene.bodies[-1].omega
        return model, pin.neutral(model), v

    def collisions(self, scene):
        """Body k is geometry k; then the planes."""
        self.geometry = pin.GeometryModel()
        for k, b in enumerate(scene.bodies):
            shape = coal.Sphere(b.shape[1]) if b.shape[0] == "sphere" else coal.Box(*b.shape[1:])
            self.geometry.addGeometryObject(pin.GeometryObject(f"b{k}", k + 1, pin.SE3.Identity(), shape))
        for k, (point, n) in enumerate(scene.planes):
            shape = coal.Halfspace(np.array(n, float), float(n @ point))
            self.geometry.addGeometryObject(pin.GeometryObject(f"plane{k}", 0, pin.SE3.Identity(), shape))
        self.geometry.addAllCollisionPairs()
        self.places = self.geometry.createData()
        self.pairs = [(p.first, p.second) for p in self.geometry.collisionPairs]
        for request in self.places.collisionRequests:
            request.enable_contact, request.num_max_contacts = True, 1  # patches have the others
        self.first = np.array([a for a, _ in self.pairs])
        self.second = np.array([b for _, b in self.pairs])
        size = [np.linalg.norm(b.shape[1:]) / 2 if b.shape[0] == "box" else b.shape[1] for b in scene.bodies]
        self.reach = np.array([*size, *[np.inf] * len(scene.planes)])

    def near(self, q, margin):
        """The pairs whose spheres around them are near each other. Not timed: a stand-in for coal's broad phase, which
        its Python cannot give a margin."""
        bodies = len(self.reach) - np.count_nonzero(np.isinf(self.reach))
        place = np.vstack([q.reshape(-1, 7)[:, :3], np.zeros((len(self.reach) - bodies, 3))])
        apart = np.linalg.norm(place[self.first] - place[self.second], axis=1)
        return np.flatnonzero(apart <= self.reach[self.first] + self.reach[self.second] + margin)

    def touched(self, scene, how, q, v, h):
        """Velocities at the end of the step, and the contacts with their impulses."""
        model, data, clock = self.model, self.data, self.clock
        free = v + h * clock(pin.aba, model, data, q, v, np.zeros(model.nv))
        margin = 1e-6 + h * max(np.max(np.linalg.norm(x.reshape(-1, 6)[:, :3], axis=1)) for x in (v, free))
        clock(pin.updateGeometryPlacements, model, data, self.geometry, self.places, q)
        found = []
        for pair in self.near(q, margin).tolist():
            self.places.collisionRequests[pair].security_margin = margin
            if not clock(pin.computeCollision, self.geometry, self.places, pair):
                continue
            a, b = self.pairs[pair]
            touch = self.places.collisionResults[pair].getContact(0)
            n, gap, middle = touch.normal, touch.penetration_depth, touch.pos
            points = [middle]
            if scene.bodies[0].shape[0] == "box":
                clock(pin.computeContactPatch, self.geometry, self.places, pair)
                patch = self.places.contactPatchResults[pair].getContactPatch(0)
                points = [patch.getPoint(i) for i in range(patch.size())] or points
                n = patch.getNormal()
            found += [(pair, i, a, b, axes(n), gap, x) for i, x in enumerate(points)]
        if not found:
            return free, []
        models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        offset, known, contacts = np.zeros(3 * len(found)), np.zeros(3 * len(found)), []
        for k, (pair, i, a, b, R, gap, x) in enumerate(found):
            at = pin.SE3(R, x)  # z is the normal, from a to b
            joint = lambda body: body + 1 if body < len(scene.bodies) else 0
            contact = pin.PointContactConstraintModel(model, joint(a), data.oMi[joint(a)].actInv(at), joint(b),
                                                      data.oMi[joint(b)].actInv(at))
            contact.setFriction(scene.mu)
            models.append(pin.ConstraintModel(contact))
            datas.append(models[-1].createData())
            offset[3 * k + 2] = max(gap, 0) / h
            known[3 * k:3 * k + 3] = self.guess.get((pair, i), np.zeros(3))
        clock(pin.crba, model, data, q), clock(pin.computeJointJacobians, model, data, q)
        for one, its in zip(models, datas):
            clock(one.calc, model, data, its)
        J = clock(pin.getConstraintsJacobian, model, data, models, datas)
        kind, tolerance, most, sparse_form = how
        if sparse_form:
            rows = sparse.csr_matrix(J)
            delassus = clock(pin.DelassusOperatorSparse, (rows @ self.inverse_masses(scene) @ rows.T).tocsc())
        else:
            factor = pin.ConstraintCholeskyDecomposition(model, data, models, datas)
            clock(factor.compute, model, data, models, datas, DAMPING)
            delassus = factor.getDelassusOperatorCholeskyExpression()
            if kind == "PGS":  # its sweeps take the matrix
                delassus = clock(lambda: pin.DelassusOperatorDense(delassus.matrix()))
        settings, result = getattr(pin, kind + "SolverSettings")(), getattr(pin, kind + "SolverResult")()
        settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = tolerance
        settings.relative_feasibility_tol = settings.relative_complementarity_tol = tolerance
        settings.max_iterations = most
        result.setConstraintImpulseGuess(known)
        solver = getattr(pin, kind + "ConstraintSolver")(len(known))
        clock(solver.solve, delassus, J @ free + offset, models, datas, settings, result)
        impulse = np.array(result.retrieveConstraintImpulses())
        if not np.all(np.isfinite(impulse)):
            raise RuntimeError("its solver's impulses are not finite")
        self.guess = {(f[0], f[1]): impulse[3 * k:3 * k + 3] for k, f in enumerate(found)}
        number = lambda body: body if body < len(scene.bodies) else -1
        for k, (_, _, a, b, R, gap, x) in enumerate(found):
            contacts.append(Contact(number(b), number(a), x, R[:, 2], R @ impulse[3 * k:3 * k + 3], gap))
        return free + clock(self.answered, model, data, q, J, impulse), contacts

    @staticmethod
    def inverse_masses(scene):
        return sparse.diags_array(np.concatenate([[*[1 / b.mass] * 3, *(1 / b.moments)] for b in scene.bodies]))

    @staticmethod
    def answered(model, data, q, J, impulse):
        """M⁻¹ Jᵀ λ, by the factors of M that its decomposition left."""
        pin.cholesky.decompose(model, data)
        return pin.cholesky.solve(model, data, J.T @ impulse)

    def pose(self, scene, q, v):
        data = self.data
        pin.forwardKinematics(self.model, data, q, v)
        at = [np.array([0.5, 0, 0]) if scene.joints else np.zeros(3)] * len(scene.bodies)
        place, rotation, velocity, omega = [], [], [], []
        for k, arm in enumerate(at):
            X, twist = data.oMi[k + 1], data.v[k + 1]
            place.append(X.act(arm)), rotation.append(X.rotation.copy())
            velocity.append(X.rotation @ (twist.linear + np.cross(twist.angular, arm)))
            omega.append(X.rotation @ twist.angular)
        return Pose(*map(np.array, (place, rotation, velocity, omega)))
