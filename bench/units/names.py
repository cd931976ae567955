"""The one table of names of units that recorders write and SI does not have, or pint reads as something else."""

from __future__ import annotations

import math
from collections.abc import Mapping

#: Signs replaced before anything is read, in this order.
TRANSLATED = {
    "µ": "u",
    "μ": "u",
    "º": "°",
    "˚": "°",
    "℃": "degC",
    "° C": "degC",
    "°C": "degC",
    "°F": "degF",
    "°K": "K",
    "°": " deg ",
    "‰": " permille ",
    "\u2126": "ohm",
    "\u03a9": "ohm",
    "Ohm": "ohm",
    "·": "*",
    "⋅": "*",
    "∙": "*",
    "•": "*",
    "×": "*",
    "−": "-",
    "–": "-",
    "\u00a0": " ",
    "\u202f": " ",
    "√2": "sqrt(2) ",
    "r.p.m": "rpm",
    "об/мин": "rpm",
    "об/с": "turn/s",
}

#: Whole texts that are no product, by their meaning; in lower case without blanks.
_WHOLE = {
    "rad/s^2": "rad/ss",
    "deg/s^2": "deg/ss",
    "mm/s^2": "mm/ss",
    "m/s^2": "m/ss",
    "permille": "1/1000 permil permill promille perthousand partsperthousand",
    "percent": "percent prozent",
}

#: Other names of a unit, in the languages of drives; a name of several letters also in capitals or with the first one.
_ALIASES = {
    "turn": "rev revs revolution revolutions r R U u umdr umdrehung umdrehungen tr tour tours turns turn rot rotation "
    "rotations giri giro obr ot varv omw upr",
    "rpm": "rpm RPM upm tpm",
    "deg": "deg degs degree degrees Grad ° grados gradi",
    "grade": "gon gradian gradians",
    "rad": "rad rads radian radians",
    "s": "s S sec secs second seconds sek sekunde sekunden seg",
    "ms": "ms mS msec msecs millisec millisecond milliseconds millis",
    "us": "us uS usec usecs microsec microsecond microseconds micros",
    "ns": "ns nsec nanosec nanosecond nanoseconds nanos",
    "min": "min mins minute minutes minuten",
    "hour": "h hr hrs std",
    "A": "A a amp amps ampere amperes",
    "V": "V v volt volts vdc",
    "percent": "% percent prozent pct",
    "permille": "permille promille",
    "degC": "C degC celsius",
    "degF": "F degF fahrenheit",
    "m": "metre metres meter meters",
    "um": "micron microns",
    "inch": "in inch inches zoll",
    "foot": "ft foot feet",
    "pound": "lb lbs",
    "ounce": "oz",
    "pound_force": "lbf",
    "ounce_force": "ozf",
    "kilogram_force": "kgf kp",
    "gram_force": "gf p",
    "N": "newton newtons",
}

#: Names of what has a factor, or is made of several units.
_COMPOUNDS: dict[str, tuple[float, Mapping[str, float]]] = {
    "krpm kRPM": (1e3, {"rpm": 1}),
    "rps": (1.0, {"turn": 1, "s": -1}),
    "dps": (1.0, {"deg": 1, "s": -1}),
    "ips": (1.0, {"inch": 1, "s": -1}),
    "Arms": (math.sqrt(2.0), {"A": 1}),
    "mArms": (math.sqrt(2.0), {"mA": 1}),
    "uArms": (math.sqrt(2.0), {"uA": 1}),
    "kArms": (math.sqrt(2.0), {"kA": 1}),
    "gfcm gcm": (1.0, {"gram_force": 1, "cm": 1}),
    "kgfcm kgcm": (1.0, {"kilogram_force": 1, "cm": 1}),
    "kgfm kgm": (1.0, {"kilogram_force": 1, "m": 1}),
    "ozin inoz ozfin": (1.0, {"ounce_force": 1, "inch": 1}),
    "lbin inlb lbfin inlbf inlbs": (1.0, {"pound_force": 1, "inch": 1}),
    "lbft ftlb lbfft ftlbf ftlbs": (1.0, {"pound_force": 1, "foot": 1}),
    "NM newtonmeter newtonmetre": (1.0, {"N": 1, "m": 1}),
}

#: What a drive counts or scales by settings of its own; one of them is worth what only the user knows.
_COUNTS = (
    "inc incs incr increment increments ink inkr inkremente cnt cnts ct cts count counts pulse pulses pls ppr tick "
    "ticks lsb digit digits raw bit bits step steps usteps microsteps qc quadcounts uu puu unit units lu cps pps "
    "pulsos impulse imp pu adc"
)
#: Of the electrical angle, whose turns are the rotor's times its pairs of poles.
_ELECTRICAL = "erpm eradians erad edeg el elec electrical elektrisch"

WHOLE = {name: meaning for meaning, names in _WHOLE.items() for name in names.split()}
ALIASES = {name: meaning for meaning, names in _ALIASES.items() for name in names.split()}
COMPOUNDS = {name: meaning for names, meaning in _COMPOUNDS.items() for name in names.split()}
COUNTS, ELECTRICAL = frozenset(_COUNTS.split()), frozenset(_ELECTRICAL.split())
