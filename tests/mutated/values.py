"""Numbers, words and texts that break readers."""

DEEP = 400  # levels: what a parser takes and a recursive function does not

NUMBERS = [
    *("nan", "-nan", "inf", "-inf", "1e400", "-1e400", "1e300", "-1e300", "1e-320", "0", "-0.0"),
    *("-1", "-0.001", "1000000", "1e-12", "1_000", "0x10", "0o17", "1,5", "1.5.2", "--1", "+"),
    *("9" * 400, "9" * 5000, "0." + "0" * 5000 + "1", "1e", "e5", ".", "", " "),
    *("٣", "３.５", "²", "½", "Ⅷ", "−1", "1\u00a0000", "1\u202f0", "0.2\u200b"),
    *("true", "false", "null", "None", "NaN", "Infinity", "1e5000", "2020-01-01", "12:30:00"),
]
WORDS = [
    *("", " ", "\t", "\\", "'", '"', '"""', "a" * 300, "é", "名前", "\U0001f3d4", "\u202eabc"),
    *("..", "../victim", "/etc/passwd", "a/b", "case_", "case_1/../../x", "con", "None", "\x00"),
    *("\x1b[31m", "a\nb", "a\r\nb", "\ufeff", "{}", "[]", "<b>", "%s%n", "$(id)", "; ls", "\ud800"),
]
TREES = [None, True, False, 0, -1, 3, 1e300, -1e300, 10**30, "", "x", [], {}, [[]], [{}], {"": 0}]
DEEP_LIST = "[" * DEEP + "]" * DEEP
DEEP_TABLE = "{a = " * DEEP + "1" + "}" * DEEP
VERY_DEEP = "[" * 100_000


def pick(rng, choices):
    """One of a sequence, of any type."""
    return choices[int(rng.integers(len(choices)))]
