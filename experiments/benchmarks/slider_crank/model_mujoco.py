"""MuJoCo: a chain of hinges, the slider a box between two planes.

Minimal coordinates: joints do not drift. Contacts are soft: spring and damper in units of acceleration, fitted to the
restitution for every speed, the stiffer the smaller the step, so that the motion can converge; no law of restitution at
several contacts at once, and friction that creeps.
"""
import mujoco

from driver import A, B, DURATION, G, J1, J2, J3, L1, L2, M1, M2, M3, OMEGA1, OMEGA2, WALL, damping_ratio, drive

PERIOD = 40  # steps in a period of the contact's spring: some 15 steps of contact


def model(mu, e, step, integrator):
    omega, depth = 6.283185307179586 / (PERIOD * step), 0.9999
    zeta = damping_ratio(e)
    contact = (f'solref="{-omega * omega * depth * depth} {-2 * zeta * omega * depth}" solimp="{depth} {depth} 0.001" '
               f'friction="{mu} 0 0" condim="{3 if mu > 0 else 1}"')
    body = '<inertial pos="{} 0 0" mass="{}" diaginertia="{} {} {}"/><joint type="hinge" axis="0 0 1"/>'
    return mujoco.MjModel.from_xml_string(f"""
      <mujoco><option timestep="{step}" gravity="0 {-G} 0" integrator="{integrator}" cone="elliptic" tolerance="1e-12"/>
      <worldbody>
        <geom type="plane" size="5 5 1" pos="0 {WALL} 0" zaxis="0 -1 0" {contact}/>
        <geom type="plane" size="5 5 1" pos="0 {-WALL} 0" zaxis="0 1 0" {contact}/>
        <body>{body.format(L1 / 2, M1, J1, J1, J1)}
          <body pos="{L1} 0 0">{body.format(L2 / 2, M2, J2, J2, J2)}
            <body pos="{L2} 0 0">{body.format(0, M3, J3, J3, J3)}
              <geom type="box" size="{A} {B} 0.01" {contact}/>
      </body></body></body></worldbody></mujoco>""")


def build(integrator):
    def start(mu, e, step):
        m = model(mu, e, step, integrator)
        data = mujoco.MjData(m)
        data.qvel[:] = [OMEGA1, OMEGA2 - OMEGA1, -OMEGA2]  # relative
        steps = round(DURATION / step)

        def run():
            mujoco.mj_step(m, data, steps)
            return data.qpos[0], steps
        return run
    return start


if __name__ == "__main__":
    drive({"implicitfast": ("step", build("implicitfast")), "rk4": ("step", build("RK4"))})
