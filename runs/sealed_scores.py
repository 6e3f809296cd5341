"""`python -m runs.sealed_scores`: the few numbers of the sealed checks that a report states, for the package.

To be run after `python -m runs.blind.study score` or `next-score`, whose tables it reads.
"""

import json

from fvcollapse.diagnosis.report.sealed import PATH
from fvcollapse.files.atomic import write_atomic
from runs.readme_tables import stored

WAYS = ("alone", "controls")


def sealed_scores():
    """What `sealed_scores.json` holds, from `blind/scores.json` and `blind/next/next_scores.json`."""
    scores, following = stored("blind", "scores.json"), stored("blind", "next", "next_scores.json")
    ahead = following["all"]["ahead"]["entropy"]
    return {way: of_way(scores[way]) for way in WAYS} | {
        "next": {
            "cases": following["all"]["cases"],
            "expected": following["expectation"]["expected_drop_of_entropy"]["value"],
            "gained": following["all"]["gain"]["entropy"]["recommended"]["value"],
            "ahead": [ahead["low"], ahead["high"]],
        }
    }


def of_way(scores):
    """The scores of the answers with controls, or without."""
    return {
        "cases": scores["cases"],
        "first_right": scores["all"]["top_1"]["value"],
        "confident_errors": scores["calibration"]["confident_errors"]["value"],
    }


def main():
    """Write the file of the package."""
    write_atomic(PATH, (json.dumps(sealed_scores(), indent=1) + "\n").encode(), running=False)
    print(PATH)


if __name__ == "__main__":
    main()
