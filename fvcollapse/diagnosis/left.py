"""What of a gap asks for an explanation, as the verdict sees it."""

from typing import NamedTuple


class Left(NamedTuple):
    """What asks for an explanation, see `practical.Remainder`.

    Attributes
    ----------
    regions : int
        Significant regions of the gap map.
    practical : float
        Largest size of what no re-calibration explains, over an honest error of the model.
    gain : float
        Fraction of the re-calibrated gap that the best hypothesis closes.
    """

    regions: int
    practical: float
    gain: float
