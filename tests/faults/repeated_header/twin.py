"""A German export with thousands marked by points, whose header comes again after 2 s."""

import numpy as np

from tests.faults.drive import drive

HEADER = "Zeit [ms];Drehzahl [U/min];Strom [A];Lage [Grad]"


def german(number):
    return f"{number:,.3f}".replace(",", "#").replace(".", ",").replace("#", ".")


def write(folder):
    time, position, velocity, current = drive(1.5e-3, 8e-4, 0.06, 0.8)
    table = np.column_stack([1e3 * time, 30.0 / np.pi * velocity, current, np.degrees(position)])
    rows = [";".join(map(german, row)) for row in table]
    rows.insert(1000, HEADER)
    (folder / "log.csv").write_text("\n".join(["\ufeff" + HEADER, *rows, ";;;", ""]), encoding="utf-8")
