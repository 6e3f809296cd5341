"""What is left of a gap as parts of the report: its size in practice, and the part that no hypothesis explains."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from fvcollapse.diagnosis.names import UNKNOWN
from fvcollapse.diagnosis.practical import something_unexplained
from fvcollapse.diagnosis.report import schema as form
from fvcollapse.diagnosis.report.regions import region_lines
from fvcollapse.diagnosis.report.unexplained_words import sentence
from fvcollapse.diagnosis.unexplained import unexplained

if TYPE_CHECKING:
    from fvcollapse.diagnosis.analysis import Analysis
    from fvcollapse.diagnosis.gap_map import Region
    from fvcollapse.diagnosis.points import Points
    from fvcollapse.diagnosis.verdict import Verdict


def region_parts(points: "Points", regions: "Sequence[Region]", z: np.ndarray) -> list[form.Region]:
    """Significant regions of a gap as the report has them; z (N,) is the gap in standard uncertainties."""
    return [
        form.Region(
            experiment=region.experiment,
            observable=region.observable,
            t_range=region.t_range,
            x_range=region.x_range,
            gap=region.gap,
            units=region.units,
            significance=float(np.abs(z[region.points]).max()),
            gap_sd=region.uncertainty,
            p_value=region.p_value,
            words=line,
        )
        for region, line in zip(regions, region_lines(points, regions), strict=True)
    ]


def practical_of(analysis: "Analysis") -> dict[str, form.Practical]:
    """{observable: `Practical`} of an analysis."""
    return {
        part.observable: form.Practical(
            gap=part.gap,
            beyond=part.beyond,
            share=part.share,
            uncertainty=part.uncertainty,
            units=part.units,
            controls=part.controls,
            codes=part.codes,
            is_larger=part.is_larger,
        )
        for part in something_unexplained(analysis).practical
    }


def unexplained_of(analysis: "Analysis", verdict: "Verdict") -> form.Unexplained | None:
    """The `Unexplained` part of the gap.

    None where one cause is named, or where several are open and the best of them leaves no significant region.
    """
    if verdict.kind != UNKNOWN and (len(verdict.set) < 2 or not analysis.gap_map.regions):
        return None
    found = unexplained(analysis, verdict.probability)
    if verdict.kind != UNKNOWN and not found.regions:
        return None
    part = form.Unexplained(
        beside=found.beside,
        p_value=found.p_value,
        regions=region_parts(analysis.points, found.regions, found.z),
        shares=[form.PlaceShare(**share._asdict()) for share in found.shares],
        sizes={
            size.observable: form.RemainderSize(size.rms, size.mean, size.deviations, size.units)
            for size in found.sizes
        },
        direction=found.direction,
        experiment=found.experiment,
        t_range=found.t_range,
        span=found.span,
        resembles=[
            form.Likeness(one.effect, one.cosine, one.strength, list(one.worse))
            for one in found.resembles
        ],
    )
    return replace(part, words=sentence(part))
