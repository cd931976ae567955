"""The independent truth: axes integrated without MuJoCo and without anything of bench.plant.

Friction sticks and slips exactly (`plant.move`), everything else is second order at steps of 62.5 us or less. A
test that identifies or diagnoses takes its truth from here, so that a model never confirms itself.
"""
