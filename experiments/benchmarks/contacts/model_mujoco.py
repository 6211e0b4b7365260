"""MuJoCo: soft contacts with regularized complementarity; joint angles for the chain.

By its defaults (pyramidal cone), or "stiff": elliptic cone and a time constant of two steps; "noslip" adds its ten
sweeps against slip. The tolerance of its solver is 1e-10 except by default.
"""
import time

import mujoco
import numpy as np

from achieved import Contact, Pose
from scenes import G

mujoco.set_mju_user_warning(lambda text: None)  # it would write a file here; failures are rows

OPTIONS = {"defaults": "", "elliptic": 'cone="elliptic" iterations="200" tolerance="1e-10"',
           "stiff": 'cone="elliptic" iterations="200" tolerance="1e-10"',
           "stiff, noslip": 'cone="elliptic" iterations="200" tolerance="1e-10" noslip_iterations="10"'}
CHAIN = {"defaults": "", "implicitfast": 'integrator="implicitfast"', "RK4": 'integrator="RK4"'}


class Model:
    @staticmethod
    def settings(scene):
        return list(CHAIN if scene == "chain" else OPTIONS)

    @staticmethod
    def free_bodies(scene, setting, h):
        soft = f'solref="{2 * h} 1" solimp="0.9999 0.9999 0.001"' if setting.startswith("stiff") else ""
        contact = f'friction="{scene.mu} 0 0" condim="3" {soft}'
        text = lambda v: " ".join(repr(float(x)) for x in v)
        parts = [f'<geom type="plane" size="50 50 1" pos="{text(p)}" zaxis="{text(n)}" {contact}/>'
                 for p, n in scene.planes]
        for b in scene.bodies:
            kind, *size = b.shape
            size = size if kind == "sphere" else np.array(size) / 2
            parts.append(
                f'<body pos="{text(b.place)}" euler="0 0 {b.turn!r}"><freejoint/>'
                f'<inertial pos="0 0 0" mass="{b.mass!r}" diaginertia="{text(b.moments)}"/>'
                f'<geom type="{kind}" size="{text(size)}" {contact}/></body>')
        return OPTIONS[setting], "".join(parts)

    @staticmethod
    def chain(scene, setting):
        nested = ""
        for i, b in reversed(list(enumerate(scene.bodies))):
            moments = " ".join(map(repr, map(float, b.moments)))
            nested = (f'<body pos="{0 if i == 0 else 1} 0 0"><joint type="ball"/><inertial pos="0.5 0 0" '
                      f'mass="{b.mass}" diaginertia="{moments}"/>{nested}</body>')
        return CHAIN[setting], nested

    def run(self, scene, setting, h):
        option, bodies = self.chain(scene, setting) if scene.joints else self.free_bodies(scene, setting, h)
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><compiler angle="radian"/><option timestep="{h}" gravity="0 0 {-G}" {option}/><size memory="1G"/>'
            f'<worldbody>{bodies}</worldbody></mujoco>')
        data = mujoco.MjData(model)
        if scene.joints:
            data.qvel[-3:] = scene.bodies[-1].omega
        steps = round(scene.duration / h)
        begin = time.thread_time()
        mujoco.mj_step(model, data, nstep=steps - 1)
        seconds = time.thread_time() - begin
        before = self.pose(model, data)
        begin = time.thread_time()
        mujoco.mj_step(model, data)
        seconds += time.thread_time() - begin
        contacts = self.contacts(model, data, h)
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            raise RuntimeError("the motion is unstable")
        return {"h": h, "seconds": seconds, "steps": steps, "before": before, "after": self.pose(model, data),
                "contacts": contacts}

    @staticmethod
    def pose(model, data):
        """In a copy: no forward kinematics of the run's own."""
        now = mujoco.MjData(model)
        now.qpos[:], now.qvel[:] = data.qpos, data.qvel
        mujoco.mj_forward(model, now)
        n, twist = model.nbody - 1, np.zeros(6)
        velocity, omega = np.empty((n, 3)), np.empty((n, 3))
        for k in range(n):
            mujoco.mj_objectVelocity(model, now, mujoco.mjtObj.mjOBJ_BODY, k + 1, twist, 0)
            omega[k], velocity[k] = twist[:3], twist[3:]  # of the centre of mass
        return Pose(now.xipos[1:].copy(), now.xmat[1:].reshape(n, 3, 3).copy(), velocity, omega)

    @staticmethod
    def contacts(model, data, h):
        """Of the last step. Its normals go from the first geometry to the second."""
        all_, force = [], np.zeros(6)
        for i in range(data.ncon):
            c = data.contact[i]
            mujoco.mj_contactForce(model, data, i, force)
            F = c.frame.reshape(3, 3)
            first, second = (int(model.geom_bodyid[g]) - 1 for g in c.geom)
            all_.append(Contact(second, first, c.pos.copy(), F[0].copy(), h * (F.T @ force[:3]), float(c.dist)))
        return all_
