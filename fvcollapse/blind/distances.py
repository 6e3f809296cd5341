"""How far each true cause is from its nearest rival: computed after the seal is opened."""

from pathlib import Path

from fvcollapse.blind.evidence_file import read_content
from fvcollapse.blind.labels import read_labels
from fvcollapse.blind.separation import distance


def distances(evidence: str | Path, labels: str | Path) -> dict[str, float]:
    """{case: d} of every case with one effect or two: its distance to the nearest other hypothesis.

    A case that could not be compared is left out; see `separation.distance`.

    Parameters
    ----------
    evidence : str or Path
        Folder of the evidence of the cases.
    labels : str or Path
        Their labels.

    Raises
    ------
    InputError
    """
    table = {}
    for name, entry in sorted(read_labels(labels)["cases"].items()):
        path, effects = Path(evidence) / f"{name}.json", entry["label"]["effects"]
        if effects and path.exists():
            table[name] = distance(read_content(path)["separation"], effects)
    return table
