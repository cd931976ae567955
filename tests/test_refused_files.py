"""A refusal names the recording, whichever command refuses it and for whatever reason."""

import numpy as np
import pytest

from tests.command import bench


@pytest.mark.parametrize("command", ["identify", "diagnose", "servo", "friction"])
@pytest.mark.parametrize("samples", [40, 3000])
def test_refusals_name_the_file(tmp_path, monkeypatch, command, samples):
    monkeypatch.chdir(tmp_path)
    time = np.arange(samples) / 500.0
    rows = [f"{t:g},1,{np.sin(40.0 * t):.6f},0,{np.cos(t):.6f}" for t in time]
    (tmp_path / "log.csv").write_text("\n".join(["t_s,goal_rad,q_rad,v_rad_s,tau_Nm", *rows]) + "\n")
    done = bench(command, "log.csv")
    line = done.err.splitlines()[-1]
    assert done.status in (1, 2) and line.startswith("bench: ") and "log.csv" in line
