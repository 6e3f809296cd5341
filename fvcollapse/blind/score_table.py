"""Scores as a file of JSON, and the main scores as plain text."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fvcollapse.blind.plain_values import Average
from fvcollapse.files.atomic import write_atomic


def write_scores(path: str | Path, table: Mapping[str, Any]) -> None:
    """Write the scores as JSON."""
    write_atomic(path, scores_text(table).encode(), running=False)


def scores_text(table: Mapping[str, Any]) -> str:
    """The scores as JSON text."""
    return json.dumps(table, indent=1) + "\n"


def table(scores: Mapping[str, Any]) -> str:
    """The main scores as plain text."""
    single = scores["by_class"].get("single", {})
    apart = scores.get("by_separability", {})
    separable, pairs = apart.get("separable", {}), apart.get("separable_pairs", {})
    alarms, calibration = scores["alarms"], scores["calibration"]
    rows = [
        ("first name right", scores["all"]["top_1"]),
        ("among the first two", scores["all"]["top_2"]),
        ("first name right, single effects", single.get("top_1")),
        ("the same where the data can tell", separable.get("top_1")),
        ("two effects, both visible", pairs.get("top_1")),
        ("truth in the set", scores["all"]["set_holds_truth"]),
        ("mean size of the set", scores["all"]["mean_set_size"]),
        ("false alarms where there is nothing", alarms["false_alarm_on_none"]),
        ("unknown found", alarms["unknown"]["found"]),
        *((f"  {kind}", fate["found"]) for kind, fate in alarms["unknown_by_kind"].items()),
        ("unknown wrongly named", alarms["unknown"]["wrongly_named"]),
        ("confident errors", calibration["confident_errors"]),
        ("Brier score", scores["sharpness"]["brier"]),
        ("skill of the Brier score", scores["sharpness"]["brier_skill"]),
        ("reduction predicted within 0.15", scores["reduction"]["within_tolerance"]),
        ("winner beats runner-up", scores["reduction"]["winner_beats_runner_up"]),
        ("90 % intervals hold the parameter", scores["parameters"]["interval_90_covers"]),
    ]
    lines = [line(name, share) for name, share in rows if share and share["value"] is not None]
    ece = calibration["ece_5_bins"]
    lines.append(
        f"{'calibration error, 5 bins':40s}{ece['value']:6.3f}  (perfect: up to {ece['perfect_95']:.3f})"
    )
    for name, baseline in scores["baselines"].items():
        lines.append(line(f"first name right, {name}", baseline["top_1"]))
    return "\n".join(lines)


def line(name: str, share: Average) -> str:
    """One row of the table."""
    return (
        f"{name:40s}{share['value']:6.3f}  "
        f"[{share['low']:.3f}, {share['high']:.3f}]  n = {share['n']}"
    )
