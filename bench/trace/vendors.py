"""Column names of drive vendors with the units of their manuals; suggestions for `[trace.columns]`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class VendorColumn:
    """A column of a vendor.

    Attributes:
        signal: that it holds.
        unit: by the manual; None if it depends on settings.
        note: the source, and what to check.
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

COLUMNS: dict[str, VendorColumn] = {
    "present_position": VendorColumn("position", "turn/4096", _DYNAMIXEL),
    "present_velocity": VendorColumn("velocity", "0.229 rpm", _DYNAMIXEL),
    "present_current": VendorColumn(
        "current", "2.69 mA", _DYNAMIXEL + ": 2.69 mA of XM and XH, 1 mA of XL330 and XC330"
    ),
    "pos_estimate": VendorColumn("position", "turn", _ODRIVE),
    "vel_estimate": VendorColumn("velocity", "turn/s", _ODRIVE),
    "iq_measured": VendorColumn("current", "A", _ODRIVE),
    "torque_estimate": VendorColumn("torque", "N*m", _ODRIVE),
    "input_pos": VendorColumn("position_reference", "turn", _ODRIVE),
    "input_vel": VendorColumn("velocity_reference", "turn/s", _ODRIVE),
    "%time": VendorColumn("time", "ns", "as rostopic echo -p writes it"),
    "position0": VendorColumn("position", "rad", _ROS),
    "velocity0": VendorColumn("velocity", "rad/s", _ROS),
    "effort0": VendorColumn("torque", "N*m", _ROS),
    "ms_today": VendorColumn("time", "ms", _VESC),
    "q_axis_current": VendorColumn("current", "A", _VESC),
    "erpm": VendorColumn("velocity", None, "electrical revolutions: write rpm/P with the motor's P pairs of poles"),
    "r63": VendorColumn("velocity", "rpm", _SINAMICS),
    "r80": VendorColumn("torque", "N*m", _SINAMICS),
    "r78": VendorColumn("current", "Arms", _SINAMICS),
    "0x6064": VendorColumn("position", None, f"{_CIA402}, position actual value; its unit is a setting of the drive"),
    "0x606c": VendorColumn("velocity", None, f"{_CIA402}, velocity actual value; its unit is a setting of the drive"),
    "0x6077": VendorColumn("torque", "permille", f"{_CIA402}, torque actual value in permille of rated_torque"),
}


def vendor_column(name: str) -> VendorColumn | None:
    """The column of this name; None if no known vendor has one."""
    plain = name.strip().lower()
    for key in (plain, plain.rsplit(".", 1)[-1], plain.split("[")[0].split(":")[0].replace("r00", "r")):
        if key in COLUMNS:
            return COLUMNS[key]
    return None
