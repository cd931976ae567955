"""Units that recorders write into the names of columns, and names in which the same letters are no unit."""

import pytest

from bench.trace.signals import signal_of, unit_in_name

NAMES = {
    "s": "time_s Time(s) t/s",
    "sec": "time_sec",
    "ms": "time_ms timeMs t_ms|Zeit in ms|Time, ms|Zeit / ms",
    "us": "t_us|Time (us)",
    "ns": "timestamp_ns",
    "deg": "pos_deg posDeg phi_deg|pos (deg)|Winkel in deg",
    "Grad": "Winkel_Grad|Lage (Grad)",
    "rad": "position_rad q_rad frame_pos_rad joint_1_pos_rad",
    "mm": "x_mm Position_mm|Weg / mm",
    "m": "pos_m x_m",
    "rad/s": "velocity_rad_s vel_radps vel_rads velocity_rad_per_s|Velocity (rad/s)",
    "rad/S": "velocityRadS",
    "deg/s": "vel_deg_s vel_degs vel_degps ActVel_deg_per_s",
    "m/s": "speed_ms speed_mps speed_m_s|v / (m/s)",
    "mm/s": "vel_mm_s vel_mmps vel_mms",
    "rpm": "vel_rpm rpm motor_rpm n_rpm|Speed, rpm|Speed - rpm|VL.FB (rpm)|Speed rpm",
    "1/min": "drehzahl_1_min|Drehzahl in 1/min|n (1/min)",
    "rad/s2": "acc_rad_s2 acc_rads2",
    "m/s2": "acc_m_s2 acc_mps2",
    "A": "current_A iq_A|Strom in A|Motor Current A",
    "mA": "current_ma current_mA i_ma|cur (mA)",
    "Nm": "torque_nm torqueNm tau_Nm|Moment (Nm)",
    "mNm": "torque_mnm torque_mNm",
    "N*m": "tau_n_m",
    "V": "voltage_V|velocity (V)",
    "mV": "voltage_mv",
    "N": "force_n force_N",
    "C": "temp_c temp_C",
    "counts": "pos_counts|position (counts)",
    None: "omega_m theta_m q_m phase_a position_link pos_hand pos_in pos_r vel_ref position_raw time position q_0 dq_1 "
    "q[0] ans(:,1) ans(2,:) VL.FB Axis1.ActVel ms_today speed_actual torque_1 pos_max|Current (d-axis)|Position (x)|"
    "/joint_states/elbow/position|Torque actual value|position/left",
}


@pytest.mark.parametrize(("unit", "names"), NAMES.items())
def test_the_unit_in_a_name(unit, names):
    words, *phrases = names.split("|")
    for name in (*(words.split() if " " in words or not phrases else [words]), *phrases):
        assert unit_in_name(name)[1] == unit, name


@pytest.mark.parametrize(
    "name", ["velocity_rad_s", "Velocity (rad/s)", "speed_rpm", "velocity in rpm", "Axis1.ActVel_mm_s"]
)
def test_a_name_with_its_unit_is_the_signals(name):
    assert signal_of(name) == "velocity"
