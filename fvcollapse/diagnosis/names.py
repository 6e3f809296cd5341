"""Names of the hypotheses that are no effect, and of the verdicts that name one."""

NONE, UNKNOWN = "none", "unknown"
EFFECT, SEVERAL = "effect", "several"
NAMED = (EFFECT, SEVERAL)


def effects_of(hypothesis):
    """Effects of a hypothesis: one, or two that are joined by "+"; () of "none" and "unknown"."""
    return () if hypothesis in (NONE, UNKNOWN) else tuple(hypothesis.split("+"))
