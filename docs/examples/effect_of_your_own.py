"""An effect of your own in the torque balance of a recording: magnets that warm.

Offered as an entry point, `simulate` and `diagnose` know it by name: see CONTRIBUTING.md, "Add an effect".
"""

import bench
from bench.assets import asset
from bench.effects.effect import Stage
from bench.effects.torque import Torque
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from bench.units import Quantity


class MagnetWarming(Torque):
    """Torque per ampere falls in proportion to time: M = r*t*M_motor, r - 1/s."""

    name = "magnet_warming"
    summary = "torque per ampere falls in proportion to time"
    stage = Stage.TORQUE_CONSTANT
    copies_torque = True
    quantities = (Quantity("rate", "r", "1/s", lower=0.0, null=0.0),)

    def torque(self, values, axis, at):
        """What is lost of the motor's torque, of which the column is that at a rate of one."""
        return values["rate"] * at.time * at.effort


rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
run = bench.simulate(rig, "identification").trace
torque, unit = rig.effort(run)
warm = run.without("current").with_signals({"torque": torque / (1.0 - 0.01 * run.time)}, {"torque": unit})
bare = fit(Rows.of(warm, rig), Hypothesis())
found = fit(bare.rows, bare.hypothesis.plus(Term(MagnetWarming(), ())))
print(f"residual over noise {bare.chi:.2f} without, {found.chi:.2f} with a rate of {found.strengths(0)[0]:.4f} 1/s")
