"""DART (dartpy): rigid contacts, velocities by a boxed LCP (friction of two directions) or by solvers of the cone.

By its defaults (Dantzig's method; boxes as meshes), with DART's own collisions of boxes ("native"), and with these by
its matrix-free sweeps ("sweeps"), by Gauss-Seidel on the cone ("nsgs"), or by forward-backward splitting ("fbf").
Without sleeping. The chain has joint coordinates.
"""
import time

import dartpy as dart
import numpy as np

from achieved import Contact, Pose
from scenes import G

SOLVERS = {"defaults": None, "native": None, "native, sweeps": None, "native, nsgs": "NsgsFrictionSolver",
           "native, fbf": "FbfFrictionSolver"}


class Model:
    @staticmethod
    def settings(scene):
        return ["defaults"] if scene == "chain" else list(SOLVERS)

    def run(self, scene, setting, h):
        world = dart.simulation.World()
        world.setGravity([0, 0, -G])
        world.setTimeStep(h)
        idle = world.getDeactivationOptions()
        idle.mEnabled = False
        world.setDeactivationOptions(idle)
        if setting.startswith("native"):
            world.setCollisionDetector(dart.collision.DARTCollisionDetector())
        if SOLVERS[setting]:
            world.getConstraintSolver().setBoxedLcpSolver(getattr(dart.constraint, SOLVERS[setting])())
        if setting.endswith("sweeps"):
            sweeps = world.getConstraintSolver().getMatrixFreeContactSolverOptions()
            sweeps.mEnabled, sweeps.mMinRows, sweeps.mMaxIterations = True, 0, 500
            world.getConstraintSolver().setMatrixFreeContactSolverOptions(sweeps)
        bodies = self.chain(scene, world) if scene.joints else self.free_bodies(scene, world)
        option = world.getConstraintSolver().getCollisionOption()
        option.maxNumContacts = 100 * len(bodies)
        steps = round(scene.duration / h)
        begin = time.thread_time()
        for _ in range(steps - 1):
            world.step()
        seconds = time.thread_time() - begin
        before = self.pose(bodies)
        begin = time.thread_time()
        world.step()
        seconds += time.thread_time() - begin
        return {"h": h, "seconds": seconds, "steps": steps, "before": before, "after": self.pose(bodies),
                "contacts": self.contacts(world, h) if scene.planes else None}

    @staticmethod
    def weigh(body, b, at=(0, 0, 0)):
        inertia = dart.dynamics.Inertia()
        inertia.setMass(b.mass)
        inertia.setMoment(np.diag(b.moments))
        inertia.setLocalCOM(list(at))
        body.setInertia(inertia)

    @staticmethod
    def show(body, shape, mu):
        node = body.createShapeNode(shape)
        node.createCollisionAspect()
        surface = node.createDynamicsAspect()
        surface.setFrictionCoeff(mu)
        surface.setRestitutionCoeff(0)

    @staticmethod
    def transform(place, rotation=np.eye(3)):
        at = dart.math.Isometry3()
        at.set_translation(np.array(place, float))
        at.set_rotation(rotation)
        return at

    def free_bodies(self, scene, world):
        made = []
        for k, b in enumerate(scene.bodies):
            skeleton = dart.dynamics.Skeleton(f"b{k}")
            joint, body = skeleton.createFreeJointAndBodyNodePair()
            body.setName(f"b{k}")
            self.weigh(body, b)
            kind, *size = b.shape
            self.show(body, dart.dynamics.SphereShape(*size) if kind == "sphere" else dart.dynamics.BoxShape(size),
                      scene.mu)
            joint.setTransform(self.transform(b.place, b.rotation))
            world.addSkeleton(skeleton)
            made.append(body)
        for k, (point, normal) in enumerate(scene.planes):  # as thick boxes: planes are not in all its detectors
            skeleton = dart.dynamics.Skeleton(f"ground{k}")
            _, body = skeleton.createWeldJointAndBodyNodePair()
            body.setName(f"ground{k}")
            self.show(body, dart.dynamics.BoxShape([10.0, 10, 10]), scene.mu)
            skeleton.getJoint(0).setTransformFromParentBodyNode(self.transform(point - 5 * normal))
            world.addSkeleton(skeleton)
        return made

    def chain(self, scene, world):
        skeleton, body, made = dart.dynamics.Skeleton("chain"), None, []
        for k, b in enumerate(scene.bodies):
            joint, body = (skeleton.createBallJointAndBodyNodePair(body) if body is not None else
                           skeleton.createBallJointAndBodyNodePair())
            if k > 0:
                joint.setTransformFromParentBodyNode(self.transform([1, 0, 0]))
            self.weigh(body, b, (0.5, 0, 0))
            made.append(body)
        skeleton.getJoint(len(made) - 1).setVelocities(scene.bodies[-1].omega)
        world.addSkeleton(skeleton)
        return made

    @staticmethod
    def pose(bodies):
        return Pose(np.array([b.getCOM() for b in bodies]),
                    np.array([b.getWorldTransform().rotation() for b in bodies]),
                    np.array([b.getCOMLinearVelocity() for b in bodies]),
                    np.array([b.getAngularVelocity() for b in bodies]))

    @staticmethod
    def contacts(world, h):
        def number(thing):
            frame = thing.getShapeFrame()
            node = frame if hasattr(frame, "getBodyNodePtr") else frame.asShapeNode()
            name = node.getBodyNodePtr().getName()
            return int(name[1:]) if name.startswith("b") else -1
        return [Contact(number(c.collisionObject1), number(c.collisionObject2), np.array(c.point), np.array(c.normal),
                        h * np.array(c.force), -c.penetrationDepth)
                for c in world.getLastCollisionResult().getContacts()]
