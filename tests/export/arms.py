"""Models and robots that a model is put onto."""

from bench.effects.present import Present
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.model_file import Mounting, StoredModel

PARAMETERS = AxisParameters(1e-3, 1.1e-3, 0.08, motor_inertia=1e-4)
ARM = """
<mujoco model="arm">
  <option timestep="0.00025" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="upper arm">
      <joint name="shoulder" axis="0 1 0" damping="0.2"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03" mass="1.2"/>
      <body name="forearm" pos="0 0 -.4">
        <joint name="elbow" axis="0 1 0" armature=".7" damping=".3" frictionloss=".4"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass=".5"/>
        <body name="hand" pos="0 0 -.3">
          <joint name="slide" type="slide" axis="0 0 1"/><geom size=".03" mass=".1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="lift" joint="shoulder"/></actuator>
</mujoco>"""


def stored(*effects, parameters=PARAMETERS, **mounting):
    """A model with effects, as (name, values)."""
    model = AxisModel(parameters, tuple(Present.of(name, values) for name, values in effects))
    return StoredModel("the axis", model, mounting=Mounting(**mounting))
