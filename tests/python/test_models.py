"""Models in URDF and MJCF: simulated as they are, or imported as scenes."""

import numpy as np
import orthant
import pytest

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="rod">
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.01"/></inertial>
    <visual/>
  </link>
  <joint name="pin" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
</robot>"""


def test_a_model_runs_as_it_is_and_as_the_scene_that_it_becomes(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(ARM)
    with pytest.warns(orthant.OrthantWarning, match="not taken: <visual> of <link>"):
        run = orthant.simulate(orthant.Scene.load(file, **{"model.at.pin": 0.7}), duration=0.5)
    with pytest.warns(orthant.OrthantWarning):
        assert orthant.simulate(file, duration=0.01).solved
    assert run.solved and abs(run["pin.angle"][0] - 0.7) < 1e-14
    energy = 0.5 * (0.2 + 2 * 0.25) * run["rod.wy"] ** 2 + 2 * 9.81 * run["rod.z"]
    assert np.max(np.abs(energy - energy[0])) < 1e-4
    model = orthant.import_model(file, **{"at.pin": 0.7})
    assert model.notes == ["not taken: <visual> of <link> (line 6)"]
    again = orthant.simulate(orthant.Scene.parse(model.toml), duration=0.5)
    assert np.array_equal(run["rod.x"], again["rod.x"])
    assert '"floor"' not in model.toml  # it has no shapes


def test_wrong_models_say_why(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.replace("continuous", "hinge"))
    with pytest.raises(ValueError, match=r'arm.urdf:8: <joint name="pin">: type = \'hinge\': must be one of revolute'):
        orthant.import_model(file)
    with pytest.raises(ValueError, match="unknown option model.weight"):
        orthant.import_model(file, weight=3)
    file.write_text(ARM)
    with pytest.raises(ValueError, match="<link name=\"base\">: has no mass, but moves"):
        orthant.import_model(file, base="free")
