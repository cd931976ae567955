import json
import subprocess
import sys

import numpy as np
import pytest

TORQUE_CONSTANT = 0.8
RIG = 'name = "x"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\n'


@pytest.fixture
def bench(tmp_path):
    """Runs `bench` in a folder with a rig and a recording: 3 s at 40 rad/s and 2 A, then 1 s at rest."""
    time = 1e-3 * np.arange(4000)
    moves = time < 3.0
    table = np.column_stack([time, 40.0 * moves, 2.0 * moves])
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header="time [s],velocity [rad/s],current [A]", comments="")
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")

    def run(*arguments):
        command = [sys.executable, "-m", "bench", *arguments]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    return run


def test_it_is_on_the_terminal_on_a_page_and_in_json(bench, tmp_path):
    done = bench("duty", "run.csv", "--rig", "rig.toml", "--report", "duty.html", "--json", "duty.json")
    assert (done.returncode, done.stderr) == (0, "")
    assert "It is at rest for 25" in done.stdout
    assert "wrote duty.html" in done.stdout
    assert "It is at rest for 25" in (tmp_path / "duty.html").read_text(encoding="utf-8")
    found = json.loads((tmp_path / "duty.json").read_text(encoding="utf-8"))["duty"]
    assert found == {"at_rest": 0.25, "rms": pytest.approx(2.0 * TORQUE_CONSTANT * 0.75**0.5), "unit": "N*m"}


def test_bad_input_is_one_line_and_no_recording_is_replaced(bench, tmp_path):
    done = bench("duty", "nowhere.csv", "--rig", "rig.toml")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert bench("duty", "run.csv", "--rig", "rig.toml", "--json", "run.csv").returncode == 2
