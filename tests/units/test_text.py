"""Units as drives, scopes and loggers write them, and where they are seen: the right factor, or a refusal that asks."""

import math

import pytest

from bench.units.text import UnitError, scale_of
from bench.units.usual import USUAL_UNITS

TURN, RPM, DEG = 2 * math.pi, math.pi / 30, math.pi / 180
OUNCE, POUND, GRAVITY = 0.028349523125, 0.45359237, 9.80665  # NIST SP 811, appendix B
INCH, FOOT = 0.0254, 0.3048
ASKS = None

SPEED, ANGLE, ANGULAR_ACCELERATION = ("rad/s", "m/s"), ("rad", "m"), ("rad/s**2", "m/s**2")
TORQUE, AMPERE, TIME, VOLTAGE, FORCE, WARMTH = ("N*m", "dimensionless"), ("A",), ("s",), ("V",), ("N",), ("K",)

#: Where it is seen -> quantity, and unit texts with their factors to SI; ASKS: refused with what to write.
TEXTS = {
    "SI brochure, and canonical traces": [
        (
            SPEED,
            {
                "rad/s": 1.0,
                "rad s-1": 1.0,
                "rad·s⁻¹": 1.0,
                "rad.s-1": 1.0,
                "rad*s**-1": 1.0,
                "m/s": 1.0,
                "mm/s": 1e-3,
                "m·s^-1": 1.0,
            },
        ),
        (ANGLE, {"rad": 1.0, "mrad": 1e-3, "m": 1.0, "mm": 1e-3, "µm": 1e-6, "μm": 1e-6, "um": 1e-6, "nm": 1e-9}),
        (ANGULAR_ACCELERATION, {"rad/s**2": 1.0, "rad/s²": 1.0, "rad/s^2": 1.0, "m/s²": 1.0, "rad s-2": 1.0}),
        (TORQUE, {"N*m": 1.0, "N·m": 1.0, "N m": 1.0, "Nm": 1.0, "mN*m": 1e-3}),
        (TIME, {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9, "min": 60.0}),
    ],
    "SINAMICS list manual, S7 trace, Lenze, SEW": [
        (
            SPEED,
            {
                "1/min": RPM,
                "U/min": RPM,
                "Umdr/min": RPM,
                "min-1": RPM,
                "min^-1": RPM,
                "min⁻¹": RPM,
                "1 / min": RPM,
                "rpm": RPM,
                "Upm": RPM,
                "Umdr./min": RPM,
                "°/s": DEG,
                "Grad/s": DEG,
            },
        ),
        (ANGLE, {"°": DEG, "Grad": DEG, "U": TURN, "Umdr": TURN, "mGrad": ASKS, "LU": ASKS, "Inkremente": ASKS}),
        (
            AMPERE,
            {
                "A": 1.0,
                "Aeff": math.sqrt(2),
                "A eff": math.sqrt(2),
                "Arms": math.sqrt(2),
                "A_rms": math.sqrt(2),
                "A(rms)": math.sqrt(2),
                "A (eff)": math.sqrt(2),
                "%": ASKS,
            },
        ),
        (TORQUE, {"Nm": 1.0, "kNm": 1e3, "Ncm": 1e-2, "%": 1e-2, "‰": 1e-3, "0.1 %": 1e-3, "0,1 %": 1e-3}),
        (WARMTH, {"°C": 1.0, "C": 1.0, "degC": 1.0, "℃": 1.0, "K": 1.0}),
    ],
    "Schneider, Festo, Bosch Rexroth: French, Italian, Polish, Russian menus": [
        (
            SPEED,
            {
                "tr/min": RPM,
                "giri/min": RPM,
                "obr/min": RPM,
                "об/мин": RPM,
                "r/min": RPM,
                "rev/min": RPM,
                "RPM": RPM,
                "r.p.m.": RPM,
                "tr/s": TURN,
            },
        ),
        (ANGLE, {"tr": TURN, "tour": TURN, "giri": TURN}),
    ],
    "B&R ACOPOS, Beckhoff TwinCAT, CODESYS": [
        (
            SPEED,
            {
                "rev/s": TURN,
                "1/s": ASKS,
                "s-1": ASKS,
                "Hz": ASKS,
                "kHz": ASKS,
                "deg/s": DEG,
                "U/s": TURN,
                "r/s": TURN,
                "mm/min": 1e-3 / 60,
                "m/min": 1 / 60,
            },
        ),
        (
            AMPERE,
            {
                "sqrt(2) A": math.sqrt(2),
                "√2 A": math.sqrt(2),
                "mA": 1e-3,
                "A peak": 1.0,
                "Apk": 1.0,
                "A_pk": 1.0,
                "App": ASKS,
            },
        ),
        (
            ANGULAR_ACCELERATION,
            {"rev/s²": TURN, "1/s²": ASKS, "deg/s2": DEG, "rpm/s": RPM, "1/min/s": RPM, "mm/s^2": 1e-3},
        ),
        (TIME, {"62.5 us": 62.5e-6, "100 µs": 1e-4, "100ns": 1e-7}),
    ],
    "CiA 402 objects, EPOS, Elmo, Kollmorgen, Copley: counts and parts of ratings": [
        (
            SPEED,
            {
                "turn/4096/s": TURN / 4096,
                "turn/131072/s": TURN / 131072,
                "cnt/s": ASKS,
                "cnt/sec": ASKS,
                "counts/s": ASKS,
                "inc/s": ASKS,
                "cps": ASKS,
                "0.1 rpm": 0.1 * RPM,
                "mrpm": 1e-3 * RPM,
                "0.1 counts/s": ASKS,
                "krpm": 1e3 * RPM,
            },
        ),
        (
            ANGLE,
            {
                "turn/1048576": TURN / 2**20,
                "turn/2^17": TURN / 2**17,
                "inc": ASKS,
                "qc": ASKS,
                "cnt": ASKS,
                "counts": ASKS,
                "PUU": ASKS,
                "pulse": ASKS,
                "360 deg/65536": TURN / 65536,
                "1/100 deg": DEG / 100,
            },
        ),
        (
            TORQUE,
            {"permille": 1e-3, "1/1000": 1e-3, "promille": 1e-3, "mNm": 1e-3, "uNm": 1e-6, "% rated": ASKS, "pu": ASKS},
        ),
        (
            AMPERE,
            {
                "mArms": math.sqrt(2) * 1e-3,
                "Arms ": math.sqrt(2),
                "A RMS": math.sqrt(2),
                "ARMS": math.sqrt(2),
                "0.01 A": 0.01,
                "10 mA": 0.01,
            },
        ),
    ],
    "Robotis e-manual, Feetech, T-motor CAN, ODrive, moteus, VESC, SimpleFOC": [
        (
            SPEED,
            {
                "0.229 rpm": 0.229 * RPM,
                "0.111rpm": 0.111 * RPM,
                "turn/s": TURN,
                "turns/s": TURN,
                "rps": TURN,
                "dps": DEG,
                "rpm/7": RPM / 7,
                "erpm": ASKS,
                "ERPM": ASKS,
                "step/s": ASKS,
                "0.732 rpm": 0.732 * RPM,
            },
        ),
        (
            ANGLE,
            {
                "turn/4096": TURN / 4096,
                "0.088 deg": 0.088 * DEG,
                "turn": TURN,
                "turns": TURN,
                "rev": TURN,
                "revolutions": TURN,
                "tick": ASKS,
            },
        ),
        (
            AMPERE,
            {
                "2.69 mA": 2.69e-3,
                "3.36mA": 3.36e-3,
                "1.0 mA": 1e-3,
                "6.5 mA": 6.5e-3,
                "amps": 1.0,
                "Amps": 1.0,
                "LSB": ASKS,
                "raw": ASKS,
            },
        ),
        (VOLTAGE, {"0.1 V": 0.1, "V": 1.0, "Vdc": 1.0, "mV": 1e-3, "Volt": 1.0, "Vrms": ASKS}),
        (TIME, {"msec": 1e-3, "usec": 1e-6, "sec": 1.0, "seconds": 1.0, "tick": ASKS, "micros": 1e-6, "millis": 1e-3}),
    ],
    "Datasheets of hobby and American motors": [
        (
            TORQUE,
            {
                "oz-in": OUNCE * GRAVITY * INCH,
                "ozf*in": OUNCE * GRAVITY * INCH,
                "oz.in": OUNCE * GRAVITY * INCH,
                "in-oz": OUNCE * GRAVITY * INCH,
                "ozin": OUNCE * GRAVITY * INCH,
                "lb-in": POUND * GRAVITY * INCH,
                "lbf*in": POUND * GRAVITY * INCH,
                "in-lbs": POUND * GRAVITY * INCH,
                "ft-lb": POUND * GRAVITY * FOOT,
                "lbf.ft": POUND * GRAVITY * FOOT,
                "kgf*cm": GRAVITY * 0.01,
                "kgf.cm": GRAVITY * 0.01,
                "kg.cm": GRAVITY * 0.01,
                "kg-cm": GRAVITY * 0.01,
                "kgcm": GRAVITY * 0.01,
                "gf*cm": GRAVITY * 1e-5,
                "g.cm": GRAVITY * 1e-5,
                "N-m": 1.0,
                "N.m": 1.0,
                "cNm": 1e-2,
            },
        ),
        (
            FORCE,
            {
                "lbf": POUND * GRAVITY,
                "kgf": GRAVITY,
                "kg": GRAVITY,
                "kp": GRAVITY,
                "N": 1.0,
                "kN": 1e3,
                "mN": 1e-3,
                "ozf": OUNCE * GRAVITY,
            },
        ),
        (
            SPEED,
            {"in/s": INCH, "ips": INCH, "ft/min": FOOT / 60, "deg/sec": DEG, "degrees/second": DEG, "rad/sec": 1.0},
        ),
        (
            ANGLE,
            {
                "in": INCH,
                "inch": INCH,
                "degrees": DEG,
                "arcsec": DEG / 3600,
                "arcmin": DEG / 60,
                "gon": math.pi / 200,
                "grad": ASKS,
            },
        ),
    ],
    "Spreadsheets and scripts, written by hand": [
        (
            SPEED,
            {
                "(rpm)": RPM,
                "rpm (filtered)": RPM,
                "RPM ": RPM,
                "x 0.1 rpm": 0.1 * RPM,
                "rpm x 10": 10 * RPM,
                "rpm*10": 10 * RPM,
                "1e-3 rpm": 1e-3 * RPM,
                "10^-3 rpm": 1e-3 * RPM,
                "rad/s (el)": ASKS,
                "units/s": ASKS,
                "furlong/x": ASKS,
            },
        ),
        (ANGLE, {"1": ASKS, "-": ASKS, "": ASKS, "deg/10": DEG / 10, "%": ASKS, "V": ASKS}),
        (TIME, {"[s]": ASKS, "Sek.": 1.0, "S": 1.0, "MS": 1e-3, "h": 3600.0, "m": ASKS}),
        (AMPERE, {"Ampere": 1.0, "kA": 1e3, "A (eff. value)": ASKS, "V": ASKS, "A/1000": 1e-3}),
    ],
}
CASES = [
    (seen, wanted, text, factor)
    for seen, groups in TEXTS.items()
    for wanted, texts in groups
    for text, factor in texts.items()
]


def test_there_are_many():
    assert len({(wanted, text) for _, wanted, text, _ in CASES}) >= 150


@pytest.mark.parametrize(("wanted", "text", "factor"), [case[1:] for case in CASES])
def test_a_unit_text_is_read_or_asked_about(wanted, text, factor):
    if factor is ASKS:
        with pytest.raises(UnitError) as refused:
            scale_of(text, wanted)
        assert refused.value.allowed.startswith("allowed: ")
    else:
        assert scale_of(text, wanted).factor == pytest.approx(factor, rel=1e-9)


@pytest.mark.parametrize("unit", USUAL_UNITS)
def test_a_unit_that_pint_reads_keeps_its_meaning(unit):
    usual = USUAL_UNITS[unit]
    same = [si for si, row in USUAL_UNITS.items() if row.factor == 1.0 and row.dimensionality == usual.dimensionality]
    fitting = [
        si for si in same if ("rad" in si) == bool({"radian", "degree", "turn", "rpm"} & set(usual.base_units.split()))
    ]
    for si in fitting:
        assert scale_of(unit, (si,)).factor == pytest.approx(usual.factor, rel=1e-15)
    assert fitting


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
