"""Bullet (pybullet): sequential impulses on rigid bodies with all coordinates, a linearized cone of two directions.

By its defaults (50 iterations), or with a thousand of them and no early end; "stiff" corrects all of an overlap in a
step instead of a fifth. The chain by balls and sockets between rigid bodies, or by joint coordinates (Featherstone).
"""
import math
import time

import numpy as np
import pybullet as p

from achieved import Contact, Pose
from scenes import G

ITERATIONS = {"defaults": {}, "500 iterations": {"numSolverIterations": 500, "solverResidualThreshold": 0.0},
              "stiff": {"numSolverIterations": 500, "solverResidualThreshold": 0.0, "erp": 0.9, "contactERP": 0.9}}


class Model:
    @staticmethod
    def settings(scene):
        return [*ITERATIONS, "joint coordinates"] if scene == "chain" else list(ITERATIONS)

    def run(self, scene, setting, h):
        p.connect(p.DIRECT)
        p.setGravity(0, 0, -G)
        p.setPhysicsEngineParameter(fixedTimeStep=h, numSubSteps=0, deterministicOverlappingPairs=1,
                                    **ITERATIONS.get(setting, {}))
        if setting == "joint coordinates":
            body = self.chain(scene)
            read = lambda: self.links(scene, body)
        else:
            bodies = self.bodies(scene)
            read = lambda: self.poses(bodies)
        steps = round(scene.duration / h)
        begin = time.thread_time()
        for _ in range(steps - 1):
            p.stepSimulation()
        seconds = time.thread_time() - begin
        before = read()
        begin = time.thread_time()
        p.stepSimulation()
        seconds += time.thread_time() - begin
        run = {"h": h, "seconds": seconds, "steps": steps, "before": before, "after": read(),
               "contacts": self.contacts(len(scene.bodies), h) if scene.planes else None}
        p.disconnect()  # the next run is in another world
        return run

    @staticmethod
    def shape(body):
        if body.shape[0] == "sphere":
            return p.createCollisionShape(p.GEOM_SPHERE, radius=body.shape[1])
        if body.shape[0] == "box":
            return p.createCollisionShape(p.GEOM_BOX, halfExtents=[x / 2 for x in body.shape[1:]])
        return -1

    def bodies(self, scene):
        """Bodies first, so that their numbers are those of the scene; then the planes."""
        made, each = [], math.sqrt(scene.mu)  # the coefficient of a pair is the product
        for b in scene.bodies:
            one = p.createMultiBody(b.mass, self.shape(b), basePosition=list(b.place),
                                    baseOrientation=[0, 0, math.sin(b.turn / 2), math.cos(b.turn / 2)])
            p.changeDynamics(one, -1, lateralFriction=each, restitution=0, linearDamping=0, angularDamping=0,
                             localInertiaDiagonal=list(b.moments), activationState=p.ACTIVATION_STATE_DISABLE_SLEEPING)
            p.resetBaseVelocity(one, list(b.velocity), list(b.omega))
            made.append(one)
        for at, normal in scene.planes:
            plane = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE, planeNormal=list(normal)),
                                      basePosition=list(at))
            p.changeDynamics(plane, -1, lateralFriction=each, restitution=0)
        for a, b, at in scene.joints:
            arm = lambda k: list(at - scene.bodies[k].place) if k >= 0 else list(at)
            parent, child = (made[b], -1) if a < 0 else (made[a], made[b])
            p.createConstraint(parent, -1, child, -1, p.JOINT_POINT2POINT, [0, 0, 0], arm(b if a < 0 else a),
                               arm(a if a < 0 else b))
        return made

    @staticmethod
    def poses(bodies):
        at = [p.getBasePositionAndOrientation(b) for b in bodies]
        twist = [p.getBaseVelocity(b) for b in bodies]
        return Pose(np.array([x for x, _ in at]),
                    np.array([np.reshape(p.getMatrixFromQuaternion(q), (3, 3)) for _, q in at]),
                    np.array([v for v, _ in twist]), np.array([w for _, w in twist]))

    @staticmethod
    def chain(scene):
        n, none = len(scene.bodies), [0, 0, 0, 1]
        made = p.createMultiBody(
            0, -1, linkMasses=[b.mass for b in scene.bodies], linkCollisionShapeIndices=[-1] * n,
            linkVisualShapeIndices=[-1] * n, linkPositions=[[0 if i == 0 else 1, 0, 0] for i in range(n)],
            linkOrientations=[none] * n, linkInertialFramePositions=[[0.5, 0, 0]] * n,
            linkInertialFrameOrientations=[none] * n, linkParentIndices=list(range(n)),
            linkJointTypes=[p.JOINT_SPHERICAL] * n, linkJointAxis=[[0, 0, 1]] * n)
        for i, b in enumerate(scene.bodies):
            p.changeDynamics(made, i, localInertiaDiagonal=list(b.moments), linearDamping=0, angularDamping=0,
                             jointDamping=0)
            p.setJointMotorControlMultiDof(made, i, p.POSITION_CONTROL, [0, 0, 0, 1], positionGain=0, velocityGain=0,
                                           force=[0, 0, 0])
        p.resetJointStateMultiDof(made, n - 1, none, list(scene.bodies[-1].omega))
        return made

    @staticmethod
    def links(scene, body):
        links = [p.getLinkState(body, i, 1, 1) for i in range(len(scene.bodies))]
        return Pose(np.array([x[0] for x in links]),
                    np.array([np.reshape(p.getMatrixFromQuaternion(x[1]), (3, 3)) for x in links]),
                    np.array([x[6] for x in links]), np.array([x[7] for x in links]))

    @staticmethod
    def contacts(bodies, h):
        number = lambda k: k if k < bodies else -1
        return [Contact(number(c[1]), number(c[2]), np.array(c[5]), np.array(c[7]),
                        h * (c[9] * np.array(c[7]) + c[10] * np.array(c[11]) + c[12] * np.array(c[13])), c[8],
                        np.array(c[6]))
                for c in p.getContactPoints()]
