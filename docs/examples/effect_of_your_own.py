"""An effect of your own in the torque balance of a recording: magnets that warm.

Offered as an entry point, `simulate` and `diagnose` know it by name: see CONTRIBUTING.md, "Add an effect".
"""

import bench
from bench.assets import asset
from bench.effects.acting import ScalesTorque
from bench.effects.effect import Columns
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from bench.units import Quantity


class MagnetWarming(Columns, ScalesTorque):
    """Torque per ampere falls in proportion to time: M = r*t*M_motor, r - 1/s."""

    name = "magnet_warming"
    summary = "torque per ampere falls in proportion to time"
    copies_torque = True
    quantities = (Quantity("rate", "r", "1/s", lower=0.0, null=0.0),)

    def columns(self, signals, shape):
        """What the rig's constant overstates, per unit of the rate: the motor's torque times time."""
        return [[(signals.time * signals.torque, 0)]]

    def torque_factor(self, values, axis, at):
        """What is left of the torque."""
        return 1.0 - values["rate"] * at.time


rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
run = bench.simulate(rig, "identification").trace
torque, unit = rig.effort(run)
warm = run.without("current").with_signals({"torque": torque / (1.0 - 0.01 * run.time)}, {"torque": unit})
bare = fit(Rows.of(warm, rig), Hypothesis())
found = fit(bare.rows, bare.hypothesis.plus(Term(MagnetWarming(), ())))
print(f"residual over noise {bare.chi:.2f} without, {found.chi:.2f} with a rate of {found.strengths(0)[0]:.4f} 1/s")
