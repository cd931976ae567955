"""Task 8: alpha_filt, and the samples that are left without |omega| < 20 rad/s, drawn over the originals."""

from course import graph, show
from fast_samples import M, M_sync, alpha, alpha_filt, fast, omega, omega_sync, t, t_sync

show("samples remaining", fast.sum(), "1")
show("samples removed", t.size - fast.sum(), "1")
graph(
    "task08.png",
    ("speed / (rad/s)", (t, omega, "-", "original"), (t_sync[fast], omega_sync[fast], ".", "remaining")),
    (
        "acceleration / (rad/s^2)",
        (t, alpha, "-", "original"),
        (t_sync[fast], alpha_filt[fast], ".", "alpha_filt, remaining"),
    ),
    ("torque / (N*m)", (t, M, "-", "original"), (t_sync[fast], M_sync[fast], ".", "remaining")),
    x="t_sync / s",
)
