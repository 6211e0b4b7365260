"""Newton on Warp, on the CPU and in single precision: XPBD, by its defaults (2 iterations) or with 50; Kamino.

Kamino is its solver of rigid mechanisms by proximal ADMM. Impulses are not read. Kernels are compiled in the first
step, which is not timed.
"""
import math
import time

import newton
import numpy as np
import warp as wp

from achieved import Pose
from scenes import G

wp.config.quiet = True


class Model:
    @staticmethod
    def settings(scene):
        return ["XPBD", "XPBD, 50 iterations", "Kamino"]

    def run(self, scene, setting, h):
        wp.init()
        wp.set_device("cpu")
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -G))
        surface = newton.ModelBuilder.ShapeConfig(density=0.0, mu=scene.mu, mu_torsional=0.0, mu_rolling=0.0)
        for b in scene.bodies:
            turn = wp.quat(0.0, 0.0, math.sin(b.turn / 2), math.cos(b.turn / 2))
            at = wp.transform(wp.vec3(*map(float, b.place)), turn)
            inertia, mass = wp.mat33(*map(float, np.diag(b.moments).ravel())), float(b.mass)
            body = (builder.add_link if scene.joints else builder.add_body)(xform=at, inertia=inertia, mass=mass,
                                                                            lock_inertia=True)
            if b.shape[0] == "sphere":
                builder.add_shape_sphere(body, radius=float(b.shape[1]), cfg=surface)
            elif b.shape[0] == "box":
                x, y, z = (float(edge) / 2 for edge in b.shape[1:])
                builder.add_shape_box(body, hx=x, hy=y, hz=z, cfg=surface)
        joints = []
        for a, b, point in scene.joints:
            arm = lambda k: wp.transform(wp.vec3(*map(float, point - (scene.bodies[k].place if k >= 0 else 0))),
                                         wp.quat_identity())
            joints.append(builder.add_joint_ball(a, b, parent_xform=arm(a), child_xform=arm(b)))
        if joints:
            builder.add_articulation(joints)
        for point, n in scene.planes:
            builder.add_shape_plane(plane=(*map(float, n), float(-n @ point)), width=0.0, length=0.0, cfg=surface)
        model = builder.finalize(device="cpu")
        solver = (newton.solvers.SolverKamino(model) if setting == "Kamino" else newton.solvers.SolverXPBD(
            model, iterations=50 if setting.endswith("iterations") else 2))
        one, other, control = model.state(), model.state(), model.control()
        twist = one.body_qd.numpy()
        for k, b in enumerate(scene.bodies):
            twist[k] = [*b.velocity, *b.omega]
        seconds, steps = 0.0, round(scene.duration / h)
        for warm in (True, False):  # the first run compiles
            one, other = model.state(), model.state()
            one.body_qd.assign(twist)
            begin = time.process_time()
            for _ in range(1 if warm else steps):
                one.clear_forces()
                contacts = model.collide(one) if scene.planes else None
                solver.step(one, other, control, contacts, h)
                one, other = other, one
            seconds = time.process_time() - begin
        q, v = one.body_q.numpy(), one.body_qd.numpy()
        turned = np.array([np.array(wp.quat_to_matrix(wp.quat(*map(float, x[3:7])))).reshape(3, 3) for x in q])
        after = Pose(q[:, :3].astype(float), turned, v[:, :3].astype(float), v[:, 3:].astype(float))
        return {"h": h, "seconds": seconds, "steps": steps, "before": after, "after": after}
