"""The words of the rule for results that are already there; `question` does what they say."""

RULE = (
    "Results are never overwritten without --force. The same question asked again continues: it finds "
    "its own results, finishes what is missing and renews its tables and pictures. A folder or file "
    "with anything else in it is refused before anything is computed."
)
FORCE = "replace results of another question that are in the way"  # help of the option
ELSEWHERE = "another place, or --force"  # what a refusal allows
