"""Units of the lab's PLC variables. CODESYS and Machine Expert traces carry none: these are a reported assumption."""

LAB_UNITS: dict[str, str] = {
    "position": "deg",
    "velocity": "deg/s",
    "current": "mA",
    "position_reference": "deg",
    "velocity_reference": "deg/s",
}
