"""Numbers in text, as instruments and spreadsheets write them.

Python reads more than these: `1_000`, digits of every script, `nan` and `inf`. In a table of
measurements they are mistakes.
"""

import re
from collections.abc import Sequence
from math import isfinite

WHOLE = re.compile(r"[+-]?[0-9]+")
DECIMAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
DIGITS_MAX = 4000  # Python refuses to read longer whole numbers


def decimal_number(text: str) -> float:
    """The number in a text of ASCII digits, blanks around it allowed.

    The result is infinite where the text names a number beyond 1.8e308.

    Raises
    ------
    ValueError
        The text is anything else.
    """
    if not DECIMAL.fullmatch(text.strip()):
        raise ValueError(f"no number: {text!r}")
    return float(text)


def finite_numbers(texts: Sequence[str]) -> list[float] | None:
    """The numbers in texts without blanks around them; None where one is no finite number. Of many at once."""
    if not all(map(DECIMAL.fullmatch, texts)):
        return None
    numbers = list(map(float, texts))
    return numbers if all(map(isfinite, numbers)) else None


def whole_number(text: str) -> int:
    """The whole number in a text of ASCII digits, blanks around it allowed.

    Raises
    ------
    ValueError
        The text is anything else.
    """
    if not WHOLE.fullmatch(text.strip()) or len(text) > DIGITS_MAX:
        raise ValueError(f"no whole number: {text!r}")
    return int(text)
