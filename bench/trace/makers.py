"""Columns that makers name always alike, and the unit their manuals give; a suggestion for `[trace.columns]`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MakersColumn:
    """A column of a maker.

    Attributes:
        signal: that it holds.
        unit: by the manual; None where it depends on settings.
        says: whose it is, and what to check.
    """

    signal: str
    unit: str | None
    note: str


_DYNAMIXEL = "as Dynamixel's X series has it (control table in Robotis' e-manual); check your model's"
_ODRIVE = "as ODrive has it (docs.odriverobotics.com, API reference)"
_ROS = "as ROS has it (REP 103)"
_VESC = "as VESC Tool logs it"
_SINAMICS = "as SINAMICS has it (list manual)"
_CIA402 = "object of CiA 402"

COLUMNS: dict[str, MakersColumn] = {
    "present_position": MakersColumn("position", "turn/4096", _DYNAMIXEL),
    "present_velocity": MakersColumn("velocity", "0.229 rpm", _DYNAMIXEL),
    "present_current": MakersColumn(
        "current", "2.69 mA", _DYNAMIXEL + ": 2.69 mA of XM and XH, 1 mA of XL330 and XC330"
    ),
    "pos_estimate": MakersColumn("position", "turn", _ODRIVE),
    "vel_estimate": MakersColumn("velocity", "turn/s", _ODRIVE),
    "iq_measured": MakersColumn("current", "A", _ODRIVE),
    "torque_estimate": MakersColumn("torque", "N*m", _ODRIVE),
    "input_pos": MakersColumn("position_reference", "turn", _ODRIVE),
    "input_vel": MakersColumn("velocity_reference", "turn/s", _ODRIVE),
    "%time": MakersColumn("time", "ns", "as rostopic echo -p writes it"),
    "position0": MakersColumn("position", "rad", _ROS),
    "velocity0": MakersColumn("velocity", "rad/s", _ROS),
    "effort0": MakersColumn("torque", "N*m", _ROS),
    "ms_today": MakersColumn("time", "ms", _VESC),
    "q_axis_current": MakersColumn("current", "A", _VESC),
    "erpm": MakersColumn("velocity", None, "electrical revolutions: write rpm/P with the motor's P pairs of poles"),
    "r63": MakersColumn("velocity", "rpm", _SINAMICS),
    "r80": MakersColumn("torque", "N*m", _SINAMICS),
    "r78": MakersColumn("current", "Arms", _SINAMICS),
    "0x6064": MakersColumn("position", None, f"{_CIA402}, position actual value; its unit is a setting of the drive"),
    "0x606c": MakersColumn("velocity", None, f"{_CIA402}, velocity actual value; its unit is a setting of the drive"),
    "0x6077": MakersColumn("torque", "permille", f"{_CIA402}, torque actual value in permille of rated_torque"),
}


def makers_unit(name: str) -> MakersColumn | None:
    """What makers mean by a column of this name; None where none of those known has one."""
    plain = name.strip().lower()
    for key in (plain, plain.rsplit(".", 1)[-1], plain.split("[")[0].split(":")[0].replace("r00", "r")):
        if key in COLUMNS:
            return COLUMNS[key]
    return None
