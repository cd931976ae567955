"""What stands around the tasks: operating range and tracking."""

from pathlib import Path

import numpy as np
import pytest

from bench.assets import asset
from bench.course.axis import Sources, lab_rig
from bench.course.methods import RPM
from bench.course.recordings import LabRecordings
from bench.course.tracking import track
from bench.plant.axis_model import AxisParameters
from bench.report.drive import in_range
from bench.rig.rig import load_rig
from tests.course.drawn import curves

#: Inertia of the lab's rotor - kg*m**2.
ROTOR = 0.25e-4


def test_the_courses_axis_differs_from_the_guides_in_friction_and_disk():
    """What both rig files say of why there are two."""
    lab, guides = (load_rig(asset("data", "rigs", f"{name}.toml")) for name in ("lab", "sh30701p"))
    assert (lab.simulated.friction, guides.simulated.friction) == ("drive", "mechanics")
    assert guides.simulated.moment_of_inertia is None  # it is that of rotor and disk
    assert lab.simulated.moment_of_inertia - ROTOR > 1.1 * lab.load.disk_inertia


def deviations(task):
    """RMS of the tracking deviation with J_load = 0, theoretical and identified - deg."""
    return [task[f"RMS deviation, J_load {name}"].value for name in ("= 0", "theoretical", "identified")]


def test_identified_inertia_tracks_best(done):
    """The theory keeps a considerable part of the deviation, as bolts, coupling and hub turn too."""
    none, theory, identified = deviations(done["tracking"])
    print(f"RMS deviation with J_load = 0, theoretical, identified: {none:.4f}, {theory:.4f}, {identified:.4f} deg")
    assert identified < 0.5 * theory
    assert 0.1 * none < theory < 0.25 * none
    assert "deg" in done["tracking"].charts[0].panels[0].y_label


@pytest.mark.parametrize(("viscous", "coulomb", "best"), [(1.1e-3, 0.085, 0.2), (0.0, 0.0, 0.008)])
def test_tracking_moves_the_axis_of_the_recording_and_gives_the_drive_rotor_and_load(viscous, coulomb, best):
    """An axis of 30 kg*cm**2, identified exactly, tracks better than the theory of another disk.

    Without friction an exact feed-forward leaves 0.6 % of the deviation without J_load; less the rotor, 1.0 %.
    """
    axis = AxisParameters(30e-4, viscous, coulomb, motor_inertia=ROTOR)
    task = track(LabRecordings(Path("by hand"), lab_rig(), Sources.of(None)), axis, axis.inertia - ROTOR, known=False)
    none, theory, identified = deviations(task)
    assert identified < 0.2 * theory < 0.2 * none
    assert identified < best * none
    assert "30 kg·cm²" in task.findings[0]
    assert "by construction" in task.findings[0]


def test_operating_range_states_a_reserve_at_both_mains_voltages(done):
    """The motion turns below every corner, so peak torque limits it: one reserve for all voltages and temperatures."""
    task = done["range"]
    (peak,) = [number for number in task.numbers if number.name.startswith("peak reserve")]
    assert peak.name == "peak reserve, 230 V, 400 V, 230 V cold, 400 V cold"
    assert peak.value == pytest.approx(3.5 - np.abs(curves(task)[0].y).max(), abs=1e-9)
    assert task["thermal reserve, 230 V"].value < 0.0
    assert ("overheat" in task.findings[1], task["thermal reserve, 230 V"].unit) == (True, "A")
    assert task["RMS current"].value > 1.05 * task["RMS torque"].value / (1.4 / 1.8)
    low, high = (panel.series for panel in task.charts[0].panels)
    assert {"RMS current at mean speed", "peak braking", "peak, winding at 20 °C"} <= {one.name for one in low}
    assert len({one.colour for one in low}) == len(low) == 7
    assert [one.colour for one in high] == [one.colour for one in low]
    assert not any(one.name for one in high)  # the legend above serves both


def test_a_motion_beyond_the_corner_has_a_reserve_of_its_own_at_each_voltage_and_temperature():
    """At 3000 rpm the datasheet's line gives 3.5*(5000 - 3000)/2900 N*m at 230 V, and all 3.5 N*m at 400 V."""
    speed = np.full(3, 3000.0 / RPM)
    found = in_range(lab_rig(), speed, np.ones(3), "by hand").numbers
    assert found["peak reserve, 230 V"][0] == pytest.approx(3.5 * 2000.0 / 2900.0 - 1.0)
    assert found["peak reserve, 230 V cold"][0] > 1.1 * found["peak reserve, 230 V"][0]
    assert found["peak reserve, 400 V, 400 V cold"][0] == pytest.approx(2.5)
