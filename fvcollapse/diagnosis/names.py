"""Names of the hypotheses that are no effect, and of the verdicts that name one."""

NONE, UNKNOWN = "none", "unknown"
EFFECT, SEVERAL = "effect", "several"
NAMED = (EFFECT, SEVERAL)
