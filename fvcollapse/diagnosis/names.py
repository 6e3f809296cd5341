"""Names of hypotheses that are no effect, of verdicts that name one, and of the models that are compared."""

NONE, UNKNOWN = "none", "unknown"
EFFECT, SEVERAL = "effect", "several"
NAMED = (EFFECT, SEVERAL)


def effects_of(hypothesis: str) -> tuple[str, ...]:
    """Effects of a hypothesis: one, or two that are joined by "+"; () of "none" and "unknown"."""
    return () if hypothesis in (NONE, UNKNOWN) else tuple(hypothesis.split("+"))


# The models that are compared: as given, re-calibrated, with the first and with the second effect.
BASELINE, RECALIBRATED, WINNER, RUNNER_UP = "baseline", "recalibrated", "winner", "runner_up"
RUNGS = {BASELINE: "G0", RECALIBRATED: "G1", WINNER: "G2", RUNNER_UP: "G2'"}
