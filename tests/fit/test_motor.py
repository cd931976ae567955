"""Constants of motors from voltage, current and motion, stepped by the midpoint rule, with inductance."""

import json
import math
from functools import cache

import numpy as np
import pytest

import bench
from tests.command import bench as command

#: A thousandth of the time constants at most, and stable under the friction's slope at rest - s.
STEP = 5e-5
NOISE = {"position": 1e-4, "velocity": 0.05, "current": 0.01}


@cache
def driven(voltage, resistance, emf, inertia, viscous, coulomb, inductance=0.0, weight=0.0):
    """Time, position, speed, current and voltage of a motor, sampled before its voltage changes.

    `voltage(time)` is held for `voltage.period`, up to `voltage.duration`; `weight` - N*m - pulls at a quarter turn.
    """
    position = speed = current = 0.0
    inner, rows = math.ceil(voltage.period / min(STEP, inductance / resistance / 100.0 or STEP)), []
    step = voltage.period / inner
    for k in range(round(voltage.duration / voltage.period)):
        volts = voltage(k * voltage.period)
        current = current if inductance else (volts - emf * speed) / resistance
        rows.append((k * voltage.period, position, speed, current, volts))
        for _ in range(inner):
            begun = speed
            for part in (0.5, 1.0):  # the midpoint rule
                if inductance and part == 1.0:
                    current += step * (volts - resistance * current - emf * speed) / inductance
                elif not inductance:
                    current = (volts - emf * speed) / resistance
                load = viscous * speed + coulomb * math.tanh(speed / 0.02) + weight * math.sin(position)
                speed = begun + part * step * (emf * current - load) / inertia
            position += 0.5 * step * (begun + speed)
    return dict(zip(("time", "position", "velocity", "current", "voltage"), np.array(rows).T, strict=True))


class Waves:
    """Sines of some amplitudes - V - and frequencies - Hz."""

    def __init__(self, period, duration, *parts):
        self.period, self.duration, self.parts = period, duration, parts

    def __call__(self, time):
        return sum(size * math.sin(2.0 * math.pi * hertz * time + k) for k, (size, hertz) in enumerate(self.parts))


class Routine:
    """Ramps of the voltage both ways, and steps both ways: SysId's quasistatic and dynamic tests."""

    period, duration = 0.02, 24.0

    def __call__(self, time):
        part, into = divmod(time, 6.0)
        sign = 1.0 if part % 2 == 0 else -1.0
        if into > 4.5:
            return 0.0
        return sign * (2.0 * into if part < 2 else 7.0)


def noisy(columns, seed=0):
    rng = np.random.default_rng(seed)
    return {name: one + NOISE.get(name, 0.0) * rng.standard_normal(one.size) for name, one in columns.items()}


def covers(found, true, within):
    low, high = found.ci95
    slack = 1e-4 * true  # by which a voltage that is held for 1 ms is weaker at 7.1 Hz: (w*h)**2/24
    assert low - slack <= true <= high + slack, f"{found} is not {true}"
    assert high - low < 2.0 * within * true


MOTOR = {"resistance": 1.2, "emf": 0.05, "inertia": 2e-4, "viscous": 1e-4, "coulomb": 8e-3}
FEEDFORWARD = {"kS": 8e-3 * 1.2 / 0.05, "kV": 0.05 + 1e-4 * 1.2 / 0.05, "kA": 2e-4 * 1.2 / 0.05}
WAVES = Waves(1e-3, 6.0, (6.0, 0.7), (4.0, 2.3), (3.0, 7.1))


@pytest.fixture(scope="module", params=[0.0, 6e-4], ids=["no inductance", "L/R of half a sample"])
def run(request):
    return driven(WAVES, **MOTOR, inductance=request.param)


@pytest.mark.parametrize("dropped", ["position", "velocity"])
def test_winding_and_feedforward_from_voltage_and_current(run, dropped):
    found = bench.identify(noisy({name: one for name, one in run.items() if name != dropped})).motor
    for name, true in {"resistance": 1.2, "back_emf_constant": 0.05, "speed_constant": 20.0, **FEEDFORWARD}.items():
        covers(found.parameters[name], true, 0.03)
    assert "as the back-EMF constant" in found.refused["torque_constant"]


def test_feedforward_needs_no_current_and_no_rig(run):
    found = bench.identify(noisy({name: run[name] for name in ("time", "voltage", "position")})).motor
    assert {*found.parameters} == {"kS", "kV", "kA"} and not found.refused
    for name, true in FEEDFORWARD.items():
        covers(found.parameters[name], true, 0.03)


def test_the_torque_constant_of_a_known_inertia(run):
    rig = {"motor": {"rotor_inertia": 0.5e-4}, "load": {"moment_of_inertia": 1.5e-4}}
    covers(bench.identify(noisy(run), rig).motor.parameters["torque_constant"], 0.05, 0.02)


def test_the_torque_constant_of_a_known_weight():
    weight = {"eccentric_mass": 0.1, "eccentric_radius": 0.05}
    moment = 0.1 * 9.80665 * 0.05
    columns = driven(Waves(1e-3, 8.0, (1.5, 0.4), (1.0, 1.3)), **MOTOR, weight=moment)
    rig = {"motor": {"torque_constant": 0.05}, "load": weight}
    found = bench.identify(noisy(columns), rig).motor
    covers(found.parameters["torque_constant"], 0.05, 0.03)
    assert "known load" in found.refused["kS, kV, kA"]


def test_current_of_the_supply_is_no_current_of_the_motor(run):
    columns = noisy(run)
    columns["current"] = -columns["current"]
    found = bench.identify({**columns, "torque": 0.05 * run["current"]}).motor
    assert "a sign is wrong" in found.refused["resistance, back_emf_constant"]


def test_a_duty_of_an_unknown_supply_leaves_the_result_of_the_current(run):
    columns = noisy(run)
    columns["duty"] = columns.pop("voltage") / 24.0
    found = bench.identify(columns)
    assert found.residual.unit == "A" and "motor.supply_voltage" in found.motor.refused["kS, kV, kA"]


def test_constants_are_stored(run, tmp_path):
    found = bench.identify(noisy(run))
    found.save(tmp_path / "found.json")
    assert bench.Estimate.load(tmp_path / "found.json").motor == found.motor


def test_a_recording_without_voltage_has_no_motor(run):
    assert bench.identify(noisy({name: run[name] for name in ("time", "current", "velocity")})).motor is None


KNOWN = {"torque_constant": 0.05, "back_emf_constant": 0.05, "resistance": 1.2}
SUPPLY = 24.0


@pytest.fixture(scope="module")
def held():
    """Columns of a motor whose voltage is held for 2 ms and whose encoder has 12 bit."""
    columns = noisy(driven(Waves(2e-3, 10.0, (6.0, 0.7), (4.0, 2.3), (2.0, 6.1)), **MOTOR))
    bit = 2.0 * math.pi / 4096
    return columns | {"position": bit * np.round(columns["position"] / bit)}


def axis(columns, units=None, **motor):
    return bench.identify(columns, {"motor": {**KNOWN, **motor}}, units=units)


@pytest.mark.parametrize("signal", ["position", "velocity"])
def test_inertia_and_friction_from_volts_and(held, signal):
    found = axis({name: held[name] for name in ("time", "voltage", signal)})
    assert found["moment_of_inertia"].value == pytest.approx(MOTOR["inertia"], rel=1e-3)
    assert found["coulomb_friction_torque"].value == pytest.approx(MOTOR["coulomb"], rel=5e-3)
    low, high = found["viscous_friction_coefficient"].ci95
    assert low <= MOTOR["viscous"] <= high


def test_a_duty_cycle_is_a_share_of_the_supply_whose_sag_is_measured(held):
    time, volts, position = (held[name] for name in ("time", "voltage", "position"))
    sag = SUPPLY - 0.05 * np.abs(volts)
    columns = {"time": time, "duty": volts / sag, "supply_voltage": sag, "position": position}
    share = {"time": time, "duty": volts / SUPPLY, "position": position}
    percent = share | {"duty": 100.0 * share["duty"]}
    for found in (
        axis(columns, {"time": "s", "supply_voltage": "V", "position": "rad"}),
        axis(share, supply_voltage=SUPPLY),
        axis(percent, {"time": "s", "duty": "%", "position": "rad"}, supply_voltage=SUPPLY),
    ):
        assert found["moment_of_inertia"].value == pytest.approx(MOTOR["inertia"], rel=1e-3)
    with pytest.raises(bench.InputError, match=r"duty cycle; allowed: .*motor.supply_voltage"):
        axis(share)
    with pytest.raises(bench.InputError, match=r"voltage left out: .* exceeds 1"):
        axis(percent, supply_voltage=SUPPLY)


def answered(folder, columns, units, *options):
    """What `bench identify` prints of a CSV with these columns, and its motor in the JSON."""
    headings = [f"{name} [{units[name]}]" if units[name] else name for name in columns]
    log = folder / "log.csv"
    np.savetxt(log, np.column_stack([*columns.values()]), "%.9g", ",", header=",".join(headings), comments="")
    done = command("identify", log, *options, "--json", folder / "found.json")
    assert done.status == 0, done.err
    return done.out.replace("\N{NO-BREAK SPACE}", " "), json.loads((folder / "found.json").read_text())["motor"]


def right(motor, **truths):
    for name, (true, within) in truths.items():
        low, high = motor["parameters"][name]["ci95"]
        assert low <= true <= high and high - low < 2.0 * within * true, f"{name} {low} to {high}, true {true}"


def test_a_robot_drive_as_wpilib_sysid_tests_it(tmp_path):
    """Ramps and steps of the voltage at 50 Hz, in rotations: kS, kV, kA of wpilibsuite/sysid#319, with R and Ke."""
    robot = {"resistance": 0.03, "emf": 0.0185, "inertia": 1.5e-3, "viscous": 2e-5, "coulomb": 0.05}
    columns = noisy(driven(Routine(), **robot))
    turn = 2.0 * math.pi
    columns = {**columns, "position": columns["position"] / turn, "velocity": columns["velocity"] / turn}
    units = {"time": "s", "position": "turn", "velocity": "turn/s", "current": "A", "voltage": "V"}
    out, motor = answered(tmp_path, columns, units)
    share = 0.03 / 0.0185
    right(motor, kS=(0.05 * share, 0.3), kV=(0.0185 + 2e-5 * share, 0.01), kA=(1.5e-3 * share, 0.3))
    right(motor, resistance=(0.03, 0.3), back_emf_constant=(0.0185, 0.01))
    assert "kS" in out and "kV" in out and "kA" in out and "torque constant" in out


def test_a_pendulum_s_motor_from_duty_and_encoder(tmp_path):
    """Armandpl/furuta#68: duty cycle and counts of an encoder at 100 Hz, no current, supply of 12 V."""
    motor = {"resistance": 3.0, "emf": 0.25, "inertia": 1.5e-3, "viscous": 2e-3, "coulomb": 0.02}
    columns = driven(Waves(0.01, 20.0, (4.0, 0.4), (3.0, 1.1), (2.0, 2.3)), **motor)
    counts = np.round(columns["position"] * 1200 / (2.0 * math.pi))
    (tmp_path / "rig.toml").write_text(
        'name = "furuta"\nkind = "rotary"\n[motor]\nsupply_voltage = "12 V"\n'
        '[trace.columns]\nposition = "counts [turn/1200]"\n'
    )
    columns = {"time": columns["time"], "duty": columns["voltage"] / 12.0, "counts": counts}
    out, found = answered(tmp_path, columns, dict.fromkeys(columns, "") | {"time": "s"}, "--rig", tmp_path / "rig.toml")
    share = 3.0 / 0.25
    right(found, kS=(0.02 * share, 0.1), kV=(0.25 + 2e-3 * share, 0.01), kA=(1.5e-3 * share, 0.2))
    assert "kV" in out


def test_kv_of_a_motor_from_a_speed_controller_s_log(tmp_path):
    """vedderb/vesc_tool#322: ERPM of 7 pole pairs, duty, a battery that sags, motor current: KV in rpm per volt."""
    motor = {"resistance": 0.06, "emf": 60.0 / (2.0 * math.pi * 190.0), "inertia": 1e-2, "viscous": 1e-4}
    columns = noisy(
        driven(Waves(0.01, 20.0, (12.0, 0.2), (6.0, 0.9), (3.0, 2.1)), **motor, coulomb=0.04, inductance=1e-4)
    )
    sag = 42.0 - 0.02 * np.abs(columns["current"])
    log = {
        "time": columns["time"],
        "duty": columns["voltage"] / sag,
        "input_voltage": sag,
        "erpm": columns["velocity"] * 7.0 * 30.0 / math.pi,
        "motor_current": columns["current"],
    }
    (tmp_path / "rig.toml").write_text(
        'name = "board"\nkind = "rotary"\n[motor]\nrotor_inertia = "2 kg*cm**2"\n'
        '[load]\nmoment_of_inertia = "98 kg*cm**2"\n'
        '[trace.columns]\nvelocity = "erpm [rpm/7]"\ncurrent = "motor_current [A]"\n'
        'supply_voltage = "input_voltage [V]"\n'
    )
    out, found = answered(tmp_path, log, dict.fromkeys(log, "") | {"time": "s"}, "--rig", tmp_path / "rig.toml")
    right(
        found,
        speed_constant=(190.0 * 2.0 * math.pi / 60.0, 0.02),
        resistance=(0.06, 0.3),
        torque_constant=(motor["emf"], 0.1),
    )
    assert "190 rpm/V" in out and found["supply"][0] < 41.0 < found["supply"][1]
