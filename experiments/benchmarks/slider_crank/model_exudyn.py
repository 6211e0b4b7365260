"""EXUDYN: planar rigid bodies, revolute joints as constraints, the slider's corners small circles on the walls' lines.

Contacts are linear springs with dampers, fitted to the restitution for the mass that is felt at the first impact (it
varies by a few times as the mechanism turns), the stiffer the smaller the step; friction is regularized. Two of its
implicit integrators: generalized-alpha, and the trapezoidal rule on index 2 (velocity-level) constraints.
"""
import math

import exudyn as exu
import exudyn.itemInterface as item

from driver import A, B, DURATION, G, J1, J2, J3, L1, L2, M1, M2, M3, OMEGA1, OMEGA2, WALL, drive

RADIUS, HALF, MASS = 1e-3, 1.0, 0.047  # [m], [m] of a wall's line, [kg] a corner's share at the first impact


def build(solver):
    def start(mu, e, step):
        system = exu.SystemContainer()
        mbs = system.AddSystem()
        ground = mbs.AddObject(item.ObjectGround())

        def body(mass, inertia, x, vy, omega):
            node = mbs.AddNode(item.NodeRigidBody2D(referenceCoordinates=[x, 0, 0], initialVelocities=[0, vy, omega]))
            marker = mbs.AddMarker(item.MarkerNodeRigid(nodeNumber=node))
            mbs.AddLoad(item.Force(markerNumber=marker, loadVector=[0, -mass * G, 0]))
            return mbs.AddObject(item.ObjectRigidBody2D(nodeNumber=node, physicsMass=mass,
                                                        physicsInertia=inertia)), node

        def marker(number, x, y):
            return mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=number, localPosition=[x, y, 0]))

        tip = L1 * OMEGA1
        crank, node = body(M1, J1, L1 / 2, tip / 2, OMEGA1)
        rod, _ = body(M2, J2, L1 + L2 / 2, tip + L2 / 2 * OMEGA2, OMEGA2)
        slider, _ = body(M3, J3, L1 + L2, tip + L2 * OMEGA2, 0)
        pairs = ((marker(ground, 0, 0), marker(crank, -L1 / 2, 0)), (marker(crank, L1 / 2, 0), marker(rod, -L2 / 2, 0)),
                 (marker(rod, L2 / 2, 0), marker(slider, 0, 0)))
        for pair in pairs:
            mbs.AddObject(item.ObjectJointRevolute2D(markerNumbers=list(pair)))

        omega, log = 2 * math.pi / (40 * step), math.log(max(e, 0.01))
        zeta = -log / math.hypot(math.pi, log)
        stiffness, damping = MASS * omega * omega, 2 * zeta * MASS * omega
        for side in (1, -1):
            for x in (-A, A):
                data = mbs.AddNode(item.NodeGenericData(initialCoordinates=[-1, 0, 0], numberOfDataCoordinates=3))
                wall = [[-side * HALF, side * WALL, side * HALF, side * WALL]]  # the outside is on its right
                mbs.AddObject(item.ObjectContactCurveCircles(
                    markerNumbers=[marker(ground, 0, 0), marker(slider, x, side * (B - RADIUS))], nodeNumber=data,
                    circlesRadii=[RADIUS], segmentsData=exu.MatrixContainer(wall), dynamicFriction=mu,
                    frictionProportionalZone=1e-3, contactStiffness=stiffness / (2 * HALF),  # these are per length
                    contactDamping=damping / (2 * HALF)))
        mbs.Assemble()
        settings = exu.SimulationSettings()
        steps = round(DURATION / step)
        settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, DURATION
        settings.timeIntegration.verboseMode = 0
        settings.solutionSettings.writeSolutionToFile = False
        settings.timeIntegration.newton.useModifiedNewton = False

        def run():
            if not mbs.SolveDynamic(settings, solverType=solver, updateInitialValues=False, showHints=False):
                return math.nan, 0
            return mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates)[2], steps
        return run
    return start


if __name__ == "__main__":
    drive({"generalized-alpha": ("step", build(exu.DynamicSolverType.GeneralizedAlpha)),
           "trapezoidal-index-2": ("step", build(exu.DynamicSolverType.TrapezoidalIndex2))})
