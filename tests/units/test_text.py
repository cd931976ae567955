"""Units as drives, scopes and loggers write them, and where they are seen: the right factor, or a refusal that asks."""

import math

import pytest

from bench.units.conversion import UnitScale, scale_of
from bench.units.grammar import UnitError

TURN, RPM, DEG = 2 * math.pi, math.pi / 30, math.pi / 180
OUNCE, POUND, GRAVITY = 0.028349523125, 0.45359237, 9.80665  # NIST SP 811, appendix B
INCH, FOOT = 0.0254, 0.3048
ASKS = None

SPEED, ANGLE, ANGULAR_ACCELERATION = ("rad/s", "m/s"), ("rad", "m"), ("rad/s**2", "m/s**2")
TORQUE, AMPERE, TIME, VOLTAGE, FORCE, WARMTH = ("N*m", "dimensionless"), ("A",), ("s",), ("V",), ("N",), ("K",)

#: Where it is seen -> quantity, factor to SI, and unit texts between bars; ASKS: refused with what to write.
TEXTS = {
    "SI brochure, and canonical traces": [
        (SPEED, 1.0, "rad/s|rad s-1|rad·s⁻¹|rad.s-1|rad*s**-1|m/s|m·s^-1"),
        (SPEED, 1e-3, "mm/s"),
        (ANGLE, 1.0, "rad|m"),
        (ANGLE, 1e-3, "mrad|mm"),
        (ANGLE, 1e-6, "µm|μm|um"),
        (ANGLE, 1e-9, "nm"),
        (ANGULAR_ACCELERATION, 1.0, "rad/s**2|rad/s²|rad/s^2|m/s²|rad s-2"),
        (TORQUE, 1.0, "N*m|N·m|N m|Nm"),
        (TORQUE, 1e-3, "mN*m"),
        (TIME, 1.0, "s"),
        (TIME, 1e-3, "ms"),
        (TIME, 1e-6, "us|µs|μs"),
        (TIME, 1e-9, "ns"),
        (TIME, 60.0, "min"),
    ],
    "SINAMICS list manual, S7 trace, Lenze, SEW": [
        (SPEED, RPM, "1/min|U/min|Umdr/min|min-1|min^-1|min⁻¹|1 / min|rpm|Upm|Umdr./min"),
        (SPEED, DEG, "°/s|Grad/s"),
        (ANGLE, DEG, "°|Grad"),
        (ANGLE, TURN, "U|Umdr"),
        (ANGLE, ASKS, "mGrad|LU|Inkremente"),
        (AMPERE, 1.0, "A"),
        (AMPERE, math.sqrt(2), "Aeff|A eff|Arms|A_rms|A(rms)|A (eff)"),
        (AMPERE, ASKS, "%"),
        (TORQUE, 1.0, "Nm"),
        (TORQUE, 1e3, "kNm"),
        (TORQUE, 1e-2, "Ncm|%"),
        (TORQUE, 1e-3, "‰|0.1 %|0,1 %"),
        (WARMTH, 1.0, "°C|C|degC|℃|K"),
    ],
    "Schneider, Festo, Bosch Rexroth: French, Italian, Polish, Russian menus": [
        (SPEED, RPM, "tr/min|giri/min|obr/min|об/мин|r/min|rev/min|RPM|r.p.m."),
        (SPEED, TURN, "tr/s"),
        (ANGLE, TURN, "tr|tour|giri"),
    ],
    "B&R ACOPOS, Beckhoff TwinCAT, CODESYS": [
        (SPEED, TURN, "rev/s|U/s|r/s"),
        (SPEED, ASKS, "1/s|s-1|Hz|kHz"),
        (SPEED, DEG, "deg/s"),
        (SPEED, 1e-3 / 60, "mm/min"),
        (SPEED, 1 / 60, "m/min"),
        (AMPERE, math.sqrt(2), "sqrt(2) A|√2 A"),
        (AMPERE, 1e-3, "mA"),
        (AMPERE, 1.0, "A peak|Apk|A_pk"),
        (AMPERE, ASKS, "App"),
        (ANGULAR_ACCELERATION, TURN, "rev/s²"),
        (ANGULAR_ACCELERATION, ASKS, "1/s²"),
        (ANGULAR_ACCELERATION, DEG, "deg/s2"),
        (ANGULAR_ACCELERATION, RPM, "rpm/s|1/min/s"),
        (ANGULAR_ACCELERATION, 1e-3, "mm/s^2"),
        (TIME, 62.5e-6, "62.5 us"),
        (TIME, 1e-4, "100 µs"),
        (TIME, 1e-7, "100ns"),
    ],
    "CiA 402 objects, EPOS, Elmo, Kollmorgen, Copley: counts and parts of ratings": [
        (SPEED, TURN / 4096, "turn/4096/s"),
        (SPEED, TURN / 131072, "turn/131072/s"),
        (SPEED, ASKS, "cnt/s|cnt/sec|counts/s|inc/s|cps|0.1 counts/s"),
        (SPEED, 0.1 * RPM, "0.1 rpm"),
        (SPEED, 1e-3 * RPM, "mrpm"),
        (SPEED, 1e3 * RPM, "krpm"),
        (ANGLE, TURN / 2**20, "turn/1048576"),
        (ANGLE, TURN / 2**17, "turn/2^17"),
        (ANGLE, ASKS, "inc|qc|cnt|counts|PUU|pulse"),
        (ANGLE, TURN / 65536, "360 deg/65536"),
        (ANGLE, DEG / 100, "1/100 deg"),
        (TORQUE, 1e-3, "permille|1/1000|promille|mNm"),
        (TORQUE, 1e-6, "uNm"),
        (TORQUE, ASKS, "% rated|pu"),
        (AMPERE, math.sqrt(2) * 1e-3, "mArms"),
        (AMPERE, math.sqrt(2), "Arms |A RMS|ARMS"),
        (AMPERE, 0.01, "0.01 A|10 mA"),
    ],
    "Robotis e-manual, Feetech, T-motor CAN, ODrive, moteus, VESC, SimpleFOC": [
        (SPEED, 0.229 * RPM, "0.229 rpm"),
        (SPEED, 0.111 * RPM, "0.111rpm"),
        (SPEED, TURN, "turn/s|turns/s|rps"),
        (SPEED, DEG, "dps"),
        (SPEED, RPM / 7, "rpm/7"),
        (SPEED, ASKS, "erpm|ERPM|step/s"),
        (SPEED, 0.732 * RPM, "0.732 rpm"),
        (ANGLE, TURN / 4096, "turn/4096"),
        (ANGLE, 0.088 * DEG, "0.088 deg"),
        (ANGLE, TURN, "turn|turns|rev|revolutions"),
        (ANGLE, ASKS, "tick"),
        (AMPERE, 2.69e-3, "2.69 mA"),
        (AMPERE, 3.36e-3, "3.36mA"),
        (AMPERE, 1e-3, "1.0 mA"),
        (AMPERE, 6.5e-3, "6.5 mA"),
        (AMPERE, 1.0, "amps|Amps"),
        (AMPERE, ASKS, "LSB|raw"),
        (VOLTAGE, 0.1, "0.1 V"),
        (VOLTAGE, 1.0, "V|Vdc|Volt"),
        (VOLTAGE, 1e-3, "mV"),
        (VOLTAGE, ASKS, "Vrms"),
        (TIME, 1e-3, "msec|millis"),
        (TIME, 1e-6, "usec|micros"),
        (TIME, 1.0, "sec|seconds"),
        (TIME, ASKS, "tick"),
    ],
    "Datasheets of hobby and American motors": [
        (TORQUE, OUNCE * GRAVITY * INCH, "oz-in|ozf*in|oz.in|in-oz|ozin"),
        (TORQUE, POUND * GRAVITY * INCH, "lb-in|lbf*in|in-lbs"),
        (TORQUE, POUND * GRAVITY * FOOT, "ft-lb|lbf.ft"),
        (TORQUE, GRAVITY * 0.01, "kgf*cm|kgf.cm|kg.cm|kg-cm|kgcm"),
        (TORQUE, GRAVITY * 1e-5, "gf*cm|g.cm"),
        (TORQUE, 1.0, "N-m|N.m"),
        (TORQUE, 1e-2, "cNm"),
        (FORCE, POUND * GRAVITY, "lbf"),
        (FORCE, GRAVITY, "kgf|kg|kp"),
        (FORCE, 1.0, "N"),
        (FORCE, 1e3, "kN"),
        (FORCE, 1e-3, "mN"),
        (FORCE, OUNCE * GRAVITY, "ozf"),
        (SPEED, INCH, "in/s|ips"),
        (SPEED, FOOT / 60, "ft/min"),
        (SPEED, DEG, "deg/sec|degrees/second"),
        (SPEED, 1.0, "rad/sec"),
        (ANGLE, INCH, "in|inch"),
        (ANGLE, DEG, "degrees"),
        (ANGLE, DEG / 3600, "arcsec"),
        (ANGLE, DEG / 60, "arcmin"),
        (ANGLE, math.pi / 200, "gon"),
        (ANGLE, ASKS, "grad"),
    ],
    "Spreadsheets and scripts, written by hand": [
        (SPEED, RPM, "(rpm)|rpm (filtered)|RPM "),
        (SPEED, 0.1 * RPM, "x 0.1 rpm"),
        (SPEED, 10 * RPM, "rpm x 10|rpm*10"),
        (SPEED, 1e-3 * RPM, "1e-3 rpm|10^-3 rpm"),
        (SPEED, ASKS, "rad/s (el)|units/s|furlong/x"),
        (ANGLE, ASKS, "1|-||%|V"),
        (ANGLE, DEG / 10, "deg/10"),
        (TIME, ASKS, "[s]|m"),
        (TIME, 1.0, "Sek.|S"),
        (TIME, 1e-3, "MS"),
        (TIME, 3600.0, "h"),
        (AMPERE, 1.0, "Ampere"),
        (AMPERE, 1e3, "kA"),
        (AMPERE, ASKS, "A (eff. value)|V"),
        (AMPERE, 1e-3, "A/1000"),
    ],
}
CASES = [
    (wanted, text, factor) for rows in TEXTS.values() for wanted, factor, texts in rows for text in texts.split("|")
]


def test_there_are_many():
    assert len({(wanted, text) for wanted, text, _ in CASES}) >= 150


@pytest.mark.parametrize(("wanted", "text", "factor"), CASES)
def test_a_unit_text_is_read_or_asked_about(wanted, text, factor):
    if factor is ASKS:
        with pytest.raises(UnitError) as refused:
            scale_of(text, wanted)
        assert refused.value.allowed.startswith("allowed: ")
    else:
        assert scale_of(text, wanted).factor == pytest.approx(factor, rel=1e-9)


@pytest.mark.parametrize(
    ("unit", "si"),
    [
        *((unit, unit) for unit in ("s", "m", "rad", "A", "V", "K", "N", "N*m", "kg", "kg*m**2", "kg/m**3", "1/s")),
        *((unit, unit) for unit in ("ohm", "H", "rad/s", "m/s", "rad/s**2", "m/s**2", "V*s/rad", "N*m/A", "N/A")),
        *((unit, unit) for unit in ("N*m*s/rad", "N*s/m", "N*m/rad", "N/m", "N*m*s**2/rad**2", "N/V")),
    ],
)
def test_a_unit_in_si_is_itself(unit, si):
    assert scale_of(unit, (si,)) == UnitScale(si, 1.0)


@pytest.mark.parametrize("text", ["1/s", "Hz", "s-1"])
def test_a_speed_of_two_meanings_names_both(text):
    with pytest.raises(UnitError, match="may mean rad/s or rev/s"):
        scale_of(text, SPEED)


@pytest.mark.parametrize(
    "text", ["a" * 10_000, "(" * 50, "s^99999999", "10^99999999 s", "1e999 s", "s**s**s", "0 s", "\0", "s\n"]
)
def test_no_text_is_too_odd(text):
    try:
        assert scale_of(text, TIME).factor > 0.0
    except UnitError as error:
        assert len(str(error)) < 300
