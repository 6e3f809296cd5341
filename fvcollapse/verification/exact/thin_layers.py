"""Thickness below which a uniform layer on a rough bed stops, by both closures of `thin_layer`."""

import math
from typing import TYPE_CHECKING

from fvcollapse.step.thin_layer import thin_layer_law
from fvcollapse.verification.exact.layer import slope_ratio

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def stopping_thickness(case: "Case") -> float:
    """Thickness h at which mu_stop(h) = tan(slope), m.

    `thickness`: mu_stop = mu_1 + (mu_2 - mu_1)/(1 + h/L), Pouliquen & Forterre (2002). `nonlocal`: the fluidity g of a
    layer about to flow obeys (A d)^2 g'' = (mu_1 - tan(slope)) g with g = 0 on the bed and no flux at the surface, so
    g = sin(pi z/(2 h)) and mu_stop = mu_1 + (pi A d/(2 h))^2, Kamrin & Henann (2015).
    """
    law, rheology, slope = thin_layer_law(case), case.rheology, slope_ratio(case)
    above = slope - rheology.mu_1
    if law.cooperation > 0.0:
        return 0.5 * math.pi * law.cooperation / math.sqrt(above)
    return law.length * (rheology.mu_2 - slope) / above
