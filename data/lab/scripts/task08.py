"""Task 8: alpha_filt, and the samples that are left without |omega| < 20 rad/s, drawn over those of task 7."""

from course import four_signals, graph, show
from methods import fast_samples

graphs = four_signals("JLoadAndFriction")
fast = fast_samples(graphs[0][2])

show("samples remaining", fast.sum(), "1")
show("samples removed", (~fast).sum(), "1")
panels = [
    (label, (t, values, "-", "original"), (t[fast[at]], values[fast[at]], ".", "remaining"))
    for label, t, values, at in graphs
]
graph("task08.png", *panels, x="t_sync / s")
