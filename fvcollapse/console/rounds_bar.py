"""One progress bar over the runs of a command that asks for them round after round."""

import shutil
import sys
from collections.abc import Mapping, Sequence

from fvcollapse.console.bars import is_shown, tqdm

LAYOUT = "{desc} {percentage:3.0f}% |{bar}| [{elapsed}<{remaining}]"


class RoundsBar:
    """A bar on stderr over all runs of several rounds, which names the round; none where stderr is no terminal.

    The time that is left follows from what the runs cost, not from their number: the costly ones come first. Rounds
    that have not begun count with what is expected of them, in the share in which runs were missing so far.

    Parameters
    ----------
    expected : dict
        Round -> costs of the runs that it will ask for, about, in any unit.
    quiet : bool
        No bar.
    """

    def __init__(self, expected: Mapping[str, Sequence[float]], quiet: bool) -> None:
        self.expected, self.missing, self.asked = dict(expected), 0.0, 0.0
        self.runs, self.ended, self.cost, self.gone, self.round = 0, 0, 0.0, 0.0, ""
        self.bar: tqdm | None = None
        self.off, self.hidden = quiet, not is_shown(quiet)  # nothing is said; no bar is drawn

    def begin(self, name: str, missing: Sequence[float], asked: float) -> None:
        """Begin a round.

        Parameters
        ----------
        name : str
        missing : sequence of float
            Costs of the runs that are to be made.
        asked : float
            Cost of these and of those that are at hand.
        """
        self.expected.pop(name, None)
        self.round, self.runs = name, self.runs + len(missing)
        self.missing, self.asked = self.missing + sum(missing), self.asked + asked
        self.cost += sum(missing)
        self.show()

    def end_run(self, cost: float) -> None:
        """Count a run that has ended, of this cost."""
        self.gone, self.ended = self.gone + cost, self.ended + 1
        self.show()

    def close(self) -> None:
        """Leave the bar as it is."""
        if self.bar is not None:
            self.bar.close()

    @property
    def later(self) -> tuple[int, float]:
        """(number of runs, their cost) that are expected of the rounds to come."""
        share = self.missing / self.asked if self.asked else 0.0
        costs = [cost for round_costs in self.expected.values() for cost in round_costs]
        return round(share * len(costs)), share * sum(costs)

    def show(self) -> None:
        """Draw the bar as it is now; nothing before the first run that is missing."""
        if self.hidden or not self.runs:
            return
        runs, cost = self.later
        about = "about " if runs else ""
        text = f"{self.round}, {self.ended} of {about}{self.runs + runs} runs:"
        if self.bar is None:
            terminal = shutil.get_terminal_size()
            self.bar = tqdm(
                desc=text,
                file=sys.stderr,
                bar_format=LAYOUT,
                ncols=terminal.columns,
                nrows=terminal.lines,
                smoothing=0.0,
                total=1,
            )
        self.bar.total, self.bar.n = self.cost + cost, self.gone
        self.bar.set_description_str(text)
