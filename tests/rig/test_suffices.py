import tomllib

import pytest

from bench.assets import asset
from bench.cli import app
from bench.errors import InputError
from bench.rig.given import draft
from bench.rig.rig import Rig, lacking, load_rig, require
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording

BARE = {"name": "axis", "kind": "rotary"}


def test_all_that_a_bare_rig_lacks_is_named_at_once():
    with pytest.raises(InputError) as refused:
        require(Rig.of(BARE), "simulate")
    for word in ("drive", "simulation", "torque_constant", "peak_current", "bench simulate needs all"):
        assert word in str(refused.value)
    assert lacking(Rig.of(BARE))["identify"] == ()


@pytest.mark.parametrize("name", ["sh30701p", "lab"])
def test_shipped_rigs_suffice_for_every_command(name):
    assert not any(lacking(load_rig(asset("data", "rigs", f"{name}.toml"))).values())


def test_rigs_are_listed_and_copied(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    app(["rigs"], standalone_mode=False)
    assert "sh30701p" in capsys.readouterr().out
    app(["rigs", "sh30701p", "--out", "rig.toml"], standalone_mode=False)
    assert load_rig("rig.toml").name == "SH30701P with load disk"
    assert "bench simulate: suffices" in capsys.readouterr().out
    with pytest.raises(InputError, match="did you mean 'sh30701p'"):
        app(["rigs", "sh30701"], standalone_mode=False)


def test_an_effective_current_and_its_constant_are_converted():
    def motors(**values):
        return [Rig.of({**BARE, "motor": {**values, "current": current}}).motor for current in ("peak", "effective")]

    peak, effective = motors(torque_constant="1.2 N*m/A", peak_current="5 A")
    assert peak.torque_constant == pytest.approx(2**0.5 * effective.torque_constant)
    assert effective.peak_current == pytest.approx(2**0.5 * 5.0)
    stall = {"continuous_stall_torque": "2 N*m", "continuous_stall_current": "2 A", "peak_torque": "6 N*m"}
    peak, effective = (motor.torque_per_ampere for motor in motors(**stall, peak_current="7 A"))
    assert effective.torque(7.0 * 2**0.5) == pytest.approx(6.0) == peak.torque(7.0)


def test_an_effective_unit_in_a_rig_is_asked_about(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text('name = "a"\nkind = "rotary"\n[motor]\ntorque_constant = "1 N*m/Arms"\n')
    with pytest.raises(InputError, match=r'an effective current; allowed: A; set current = "effective"'):
        load_rig(path)


def drafted(folder, head, **more):
    cells = ",".join(["{}"] * (head.count(",") + 1))
    rows = (cells.format(k, k % 50, k % 7) for k in range(300))
    (folder / "run.csv").write_text("\n".join([head, *rows]))
    return draft(inspect_recording(read_recording(folder / "run.csv"), GivenOptions()), **more)


@pytest.mark.parametrize(
    ("head", "mapped"),
    [("t [ms],n_ist [1/min],Strom Achse [A]", {"velocity", "current"}), ("Zeit [s],Winkel [°],M [Nm]", {"position"})],
)
def test_a_draft_is_a_rig_that_works_as_far_as_the_file_tells(tmp_path, head, mapped):
    text = drafted(tmp_path, head, motor="SH30701P")
    (tmp_path / "rig.toml").write_text(text)
    assert mapped <= set(load_rig(tmp_path / "rig.toml").trace.columns)
    assert tomllib.loads(text)["motor"] == {"model": "SH30701P"}


@pytest.mark.parametrize(("head", "asked"), [("Zeit [s],Winkel [°],M [Nm]", False), ("Winkel [°],M [Nm]", True)])
def test_a_draft_asks_for_the_sample_period_of_what_holds_no_time_alone(tmp_path, head, asked):
    assert ("sample_period" in drafted(tmp_path, head)) == asked


def test_a_folder_of_a_shipped_rigs_name_hides_no_rig(tmp_path, monkeypatch):
    (tmp_path / "emps").mkdir()
    monkeypatch.chdir(tmp_path)
    assert load_rig("emps").name == "EMPS"
