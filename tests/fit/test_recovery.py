"""Truth comes back from the MuJoCo plant and from the independent integrator: J 0.1 %, viscous 1.5 %, Coulomb 0.5 %."""

import numpy as np
import pytest

from bench.fit.identify import identify
from bench.plant.simulate import simulate
from bench.rig.rig import Rig, load_rig
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import Axis, write_rig
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import simulate as integrate
from tests.kept import kept
from tests.recorded import PLAIN, STEP

LIMITS = np.array([1e-3, 1.5e-2, 5e-3])


def compare(name, found, truth):
    """Prints and returns errors, deviations in standard errors, and which intervals hold the truth."""
    parameters = list(found.parameters.values())[:3]
    values = np.array([parameter.value for parameter in parameters])
    errors = values / truth - 1.0
    deviations = (values - truth) / [parameter.std_error for parameter in parameters]
    inside = [low <= true <= high for (low, high), true in zip((p.ci95 for p in parameters), truth, strict=True)]
    print(f"\n{name}: errors {errors * 100} %, {deviations} standard errors, inside {inside}", end="")
    return errors, deviations, inside


def rig(inertia, viscous, coulomb, friction="mechanics", kt="0.8 N*m/A", peak="6 A", gain=0.4, **more):
    table = {
        "name": f"rig of {inertia}",
        "kind": "rotary",
        "motor": {"torque_constant": kt, "peak_current": peak, "rotor_inertia": "0.2 kg*cm**2"},
        "drive": {
            "position_gain": "40 1/s",
            "velocity_gain": f"{gain} N*m*s/rad",
            "integral_gain": f"{20 * gain} N*m/rad",
            "inertia_feedforward": inertia,
            "control_period": "250 us",
        },
        "simulation": {
            "moment_of_inertia": inertia,
            "viscous_friction_coefficient": viscous,
            "coulomb_friction": coulomb,
            "friction": friction,
            "encoder_resolution": "2e-5 rad",
            "velocity_noise": "1.5 deg/s",
            "current_noise": "8 mA",
        },
        **more,
    }
    return Rig.of(table)


RIGS = {
    "light": rig("4 kg*cm**2", "0.6 mN*m*s/rad", "60 mN*m", gain=0.1),
    "heavy": rig("60 kg*cm**2", "2 mN*m*s/rad", "90 mN*m", gain=1.0),
    "friction by the drive": rig("20 kg*cm**2", "1 mN*m*s/rad", "80 mN*m", friction="drive"),
    "gearbox": rig("15 kg*cm**2", "0.8 mN*m*s/rad", "70 mN*m", load={"gear_ratio": 5.0, "gear_inertia": "1 kg*cm**2"}),
    "small motor": rig("1 kg*cm**2", "0.1 mN*m*s/rad", "12 mN*m", kt="0.15 N*m/A", peak="5 A", gain=0.03),
}


@pytest.mark.parametrize("name", RIGS)
def test_a_rig_simulated_by_the_plant_gives_its_truth(name):
    simulated = simulate(RIGS[name], seed=1)
    axis = simulated.truth.parameters
    truth = np.array([axis.inertia, axis.viscous_friction_coefficient, axis.coulomb_friction])
    errors, deviations, _ = compare(name, identify(simulated.trace, RIGS[name]), truth)
    assert (np.abs(errors) < LIMITS).all()
    assert (np.abs(deviations) < 3.0).all()


AXES = (
    PLAIN.axis,
    Axis("b", 4e-3, 2e-3, 0.12, 1e-3, 0.9, 8.0, velocity_gain=0.4, integral_gain=6.0, inertia_feedforward=4.2e-3),
    Axis("c", 6e-4, 5e-4, 0.05, 2e-4, 0.5, 4.0, velocity_gain=0.06, integral_gain=1.0, inertia_feedforward=6e-4),
)


def test_traces_of_the_independent_integrator_give_their_truth(tmp_path):
    noise = {"velocity": Noise(white=0.03), "current": Noise(white=8e-3)}
    sensors = Sensors(**noise, encoder_resolution=2e-5, sample_period=1e-3)
    motions = [random_motion(axis, np.random.default_rng(k), 4.0) for k, axis in enumerate(AXES)]

    def integrated():
        return integrate(AXES, motions, [()] * len(AXES), [sensors] * len(AXES), seed=2, longest_step=STEP)

    inside = []
    for axis, run in zip(AXES, kept(integrated, __file__), strict=True):
        write_rig(axis, tmp_path / "rig.toml")
        found = identify(run.trace, load_rig(tmp_path / "rig.toml"))
        truth = np.array([axis.inertia, axis.viscous, axis.coulomb])
        errors, deviations, held = compare(f"axis {axis.name}", found, truth)
        assert (np.abs(errors) < LIMITS).all()
        assert (np.abs(deviations) < 3.0).all()
        inside += held
    assert np.mean(inside) >= 0.7
