"""Current filter lag: the reported current is filtered, so that it shows torque later than it acts.

    T*dM_reported/dt + M_reported = M

T - time constant - s; M - torque that acts, M_reported = k_T*I of the reported current - N*m (N). The drive has the
current without the filter, which is the recorder's. In the balance 1 + T*s on the reported torque undoes it exactly.
It is the opposite of a lag of the torque or of the speed, and two such lags at once show as their difference: with
another one it is not sought, and where no position determines a lag of the speed the names denote that difference.
Source: W. Leonhard, Control of Electrical Drives (filtered current feedback).
"""

from bench.effects.effect import Fitted, Lag, Proposal
from bench.effects.signals import Scope


class CurrentFilterLag(Lag):
    name = "current_filter_lag"
    summary = "reported current is filtered: it shows torque later than it acts"
    signal = "current"

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """To first order, a shift of the torque beyond the one that a fit may take for how the drive latches."""
        column = fitted.seen(lambda s: [[(-s.effort, 1)]], of_motion=False) * fitted.determined[:, None]
        gain = float(fitted.gains(column, 1)[0])
        beyond = column[:, 0] - fitted.span @ (fitted.span.T @ column[:, 0])
        late = float(beyond @ fitted.residual)
        return [Proposal((late / float(beyond @ beyond),), gain)] if gain > 0.0 and late > 0.0 else []

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """Lags of torque and speed, of which it may be the greater, unless position determines that of the speed."""
        return () if "position" in scope.signals else ("current_loop_lag", "velocity_filter_lag")


EFFECT = CurrentFilterLag()
