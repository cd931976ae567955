"""Refine a grown model by simulation error, and keep that only if motion which it has not seen bears it out."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bench.diagnose.chain import Grown
from bench.diagnose.found import NamedEffect
from bench.diagnose.held import VelocityGaps
from bench.diagnose.name import Suspects, named
from bench.diagnose.polish import Numbers, polished
from bench.diagnose.recordings import Recordings
from bench.diagnose.search import REMAINDER
from bench.diagnose.unseen import Unseen
from bench.errors import InputError
from bench.identify.estimate import Parameter
from bench.plant.model_file import StoredModel
from bench.plant.track import measured_velocity
from bench.trace.noise import white_noise

#: Velocity gap of a model that lacks nothing, over the white noise of the recorded speed: at most this on the shared
#: cases (docs/diagnose.md). A change below it shows nothing, and refining a model that is there cannot help.
NULL = 3.5
#: Share by which the gap of unseen motion must fall for a refined model to be kept: what refining wins less is chance.
WON = 0.02


@dataclass(frozen=True)
class Refined:
    """A model and what was named in it.

    Attributes:
        model: None where MuJoCo cannot have it.
        effects, parameters: with the values of the model.
        gap: velocity gap of unseen motion before and after it was refined - rad/s (m/s); None where it was not.
    """

    model: StoredModel | None
    effects: list[NamedEffect]
    parameters: dict[str, Parameter]
    gap: tuple[float, float] | None


def refined(recordings: Recordings, grown: Grown, suspects: Suspects, unseen: Unseen, gaps: VelocityGaps) -> Refined:
    """The quantities of a grown model with their intervals, refined where that can matter and helps.

    It can matter where something was added, nothing is left unexplained that the values would then take up, and the
    gap stands above what a perfect model leaves.
    """
    effects, parameters = named(recordings, grown, suspects)
    plain = Refined(grown.model, effects, parameters, None)
    if grown.model is None or not effects or grown.fitted.chi > REMAINDER:
        return plain
    before = gaps.of(grown, unseen.recorded)
    if not before > NULL * white_noise(measured_velocity(recordings.trace)):
        return plain
    found = refined_model(grown.model, Numbers.of(effects, parameters), unseen, gaps)
    if found is None or not found.gap or not found.gap[1] < (1.0 - WON) * before:
        return plain
    return replace(found, gap=(before, found.gap[1]))


def refined_model(stored: StoredModel, numbers: Numbers, unseen: Unseen, gaps: VelocityGaps) -> Refined | None:
    """The model as simulation of seen motion would have it; None where that cannot be had."""
    values = polished(stored, numbers, unseen.seen, gaps)
    if values is None:
        return None
    try:
        model = numbers.model(stored, values)
    except InputError:
        return None
    after = gaps.of_models([model], [unseen.recorded])[0]
    return Refined(model, *numbers.named(values), gap=(float("nan"), after))
