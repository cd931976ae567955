"""Task 8: alpha_filt, and the samples that are left without |omega| < 20 rad/s, drawn over those of task 7."""

from course import graph, show
from fast_samples import M, M_sync, alpha, alpha_filt, fast, omega, omega_sync, sync, t, t_sync

show("samples remaining", fast.sum(), "1")
show("samples removed", t.size - fast.sum(), "1")
originals = (("speed / (rad/s)", t, omega), ("acceleration / (rad/s^2)", t, alpha))
originals += (("alpha_filt / (rad/s^2)", t_sync, alpha_filt), ("torque / (N*m)", t, M))
remaining = (omega_sync, alpha[sync], alpha_filt, M_sync)
panels = [
    (label, (x, y, "-", "original"), (t_sync[fast], kept[fast], ".", "remaining"))
    for (label, x, y), kept in zip(originals, remaining, strict=True)
]
graph("task08.png", *panels, x="t_sync / s")
