"""The types that all parts of a report are made of."""

import msgspec

Numbers = list[float | None]
Range = tuple[float, float]


class Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of all parts of a report."""
