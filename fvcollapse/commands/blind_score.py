"""`blind score`: the scores of answers to sealed cases."""

from argparse import Namespace
from pathlib import Path
from typing import Any

from fvcollapse.commands.arguments import add_force


def add_parser(commands: Any) -> None:
    """Add `blind score` to the commands of `blind`."""
    parser = commands.add_parser("score", help="score answers", description=execute.__doc__)
    parser.add_argument(
        "folder", metavar="FOLDER", type=Path, help="the cases, or their seal alone"
    )
    parser.add_argument("answers", metavar="ANSWERS.json", type=Path, help="answers to the cases")
    parser.add_argument("--labels", metavar="FILE", type=Path, required=True, help="sealed labels")
    parser.add_argument(
        "--against",
        metavar="FILE",
        type=Path,
        action="append",
        default=[],
        help="other answers to the same cases; may be repeated",
    )
    parser.add_argument(
        "--separability", metavar="FILE", type=Path, help="{case: d}, to score what data can tell"
    )
    parser.add_argument("--json", metavar="FILE", type=Path, help="write there, print a table")
    add_force(parser)
    parser.set_defaults(command=execute)


def execute(arguments: Namespace) -> int:
    """Open the seal and score the answers: all scores as JSON, with intervals and baselines."""
    from fvcollapse.files.regular import refuse_unreadable
    from fvcollapse.output.question import claim_file

    claim_file(arguments.json, arguments.force)
    for path in (arguments.labels, arguments.answers, *arguments.against):
        refuse_unreadable(path, "a readable JSON file")
    from fvcollapse.blind.score import score
    from fvcollapse.blind.score_table import scores_text, table, write_scores

    scores = score(
        arguments.folder,
        arguments.answers,
        arguments.labels,
        arguments.against,
        arguments.separability,
    )
    if arguments.json is None:
        print(scores_text(scores), end="")
        return 0
    write_scores(arguments.json, scores)
    print(table(scores))
    return 0
