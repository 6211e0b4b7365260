"""MuJoCo: free bodies or joint angles, contacts and the closed loop soft.

By its defaults, or "stiff": with a time constant of two steps. For the ball that bounces "fitted": a spring and damper
that return the given part of the speed at every speed, stiffer as the step shrinks, and friction with a time constant
of two steps (only a pair of geometries takes one of its own); its defaults do not bounce.
"""
import mujoco
import numpy as np

from motions import (AXIS, DROP, DURATION, END, G, MASS, MU, OMEGA, PIN, RADIUS, SQUARE, TURN, V, damping_ratio,
                     stiff_rate, timed)

mujoco.set_mju_user_warning(lambda text: None)  # it would write a file here; failures are rows


class Mujoco:
    settings = {"masse": {"defaults": "step", "stiff": "step"}, "slider_crank": {"defaults": "step", "stiff": "step"},
                "bounces": {"defaults": "step", "fitted": "step"}}

    @staticmethod
    def soft(method, h):
        return f'solref="{2 * h} 1" solimp="0.9999 0.9999 0.001"' if method == "stiff" else ""

    @staticmethod
    def run(text, velocity, duration, h, value):
        model = mujoco.MjModel.from_xml_string(text)
        steps = round(duration / h)

        def once():
            data = mujoco.MjData(model)
            data.qvel[:] = velocity
            mujoco.mj_forward(model, data)
            for _ in range(steps):
                mujoco.mj_step(model, data)
            if not np.all(np.isfinite(data.qpos)) or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
                raise RuntimeError("the motion is unstable")
            return value(data)
        return timed(once)

    def ball(self, contact, h, duration, height, radius, mass, v, omega, pair=""):
        inertia = 0.4 * mass * radius**2
        text = (
            f'<mujoco><option timestep="{h}" gravity="0 0 {-G}" cone="elliptic" iterations="200" tolerance="1e-12"/>'
            f'{pair}<worldbody><geom name="table" type="plane" size="50 50 1" {contact}/>'
            f'<body pos="0 0 {radius + height}"><freejoint/>'
            f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>'
            f'<geom name="ball" type="sphere" size="{radius}" {contact}/></body></worldbody></mujoco>')
        return self.run(text, [*v, *omega], duration, h, lambda data: data.qpos[:3].copy())

    def masse(self, method, h):
        contact = f'{self.soft(method, h)} friction="{MU} 0 0" condim="3"'
        end, seconds = self.ball(contact, h, DURATION["masse"], 0, RADIUS, MASS, V, OMEGA)
        return end[:2], seconds

    def bounces(self, method, h):
        contact, pair = f'friction="{DROP["mu"]} 0 0" condim="3"', ""
        if method == "fitted":  # friction stops the slip sooner than the spring ends the impact
            rate, depth = stiff_rate(h, True), 0.9999
            damping = 2 * damping_ratio(DROP["e"]) * rate
            pair = (f'<contact><pair geom1="table" geom2="ball" condim="3" friction="{DROP["mu"]} {DROP["mu"]} 0 0 0" '
                    f'solref="{-(rate * depth)**2} {-damping * depth}" solimp="{depth} {depth} 0.001" '
                    f'solreffriction="{2 * h} 1"/></contact>')
        return self.ball(contact, h, DURATION["bounces"], DROP["height"], DROP["radius"], DROP["mass"], DROP["v"],
                         DROP["omega"], pair)

    def slider_crank(self, method, h):
        # slider, universal joint (x of the slider, y of the rod), rod; the crank by itself; a loop closed at its pin
        third = np.cross(AXIS, SQUARE)
        axis = " ".join(map(repr, (float(x) for x in SQUARE)))
        frame = " ".join(repr(float(x)) for x in (*AXIS, *SQUARE))
        start = (PIN - END) / 2
        rates = np.linalg.lstsq(np.stack([[1, 0, 0], SQUARE], axis=1), TURN, rcond=None)[0]
        assert abs(third @ SQUARE) < 1e-12
        text = (
            f'<mujoco><option timestep="{h}" gravity="0 0 -9.81" integrator="implicitfast" iterations="200" '
            f'tolerance="1e-14"/><worldbody>'
            f'<body name="crank" pos="0 0.1 0.12"><joint type="hinge" axis="1 0 0"/>'
            f'<inertial pos="0 0 0.04" mass="0.12" diaginertia="1e-4 1e-4 1e-5"/></body>'
            f'<body name="slider" pos="0.2 0 0"><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="2" '
            f'diaginertia="1e-4 1e-4 1e-4"/><body name="rod"><joint type="hinge" axis="1 0 0"/>'
            f'<joint type="hinge" axis="{axis}"/><inertial pos="{start[0]} {start[1]} {start[2]}" mass="0.5" '
            f'diaginertia="4e-4 4e-3 4e-3" xyaxes="{frame}"/></body></body></worldbody>'
            f'<equality><connect body1="crank" body2="rod" anchor="0 0 0.08" {self.soft(method, h)}/></equality>'
            '</mujoco>')
        return self.run(text, [6, 0.24, *rates], DURATION["slider_crank"], h, lambda data: 0.2 + data.qpos[1:2].copy())
