"""What a diagnosis assumed of each experiment because `experiment.toml` does not state it."""

from typing import TYPE_CHECKING

from fvcollapse.case.case import describe_keys
from fvcollapse.case.grammar import as_table
from fvcollapse.diagnosis.report.schema_origin import Assumption
from fvcollapse.measure.experiment_keys import CASE_KEYS
from fvcollapse.output.question import flat

if TYPE_CHECKING:
    from fvcollapse.case.case import Case
    from fvcollapse.diagnosis.question import Question
    from fvcollapse.measure.experiment import Experiment

BELIEVED, ABSENT, DEFAULT = "the case file", "absent means so", "default of the program"


def assumptions(question: "Question") -> list[Assumption]:
    """The `Assumption` list of a `Question`, experiment after experiment.

    A key that is stated by the experiment is none, whatever the case says.
    """
    keys = {info.name: info for info in describe_keys()}
    believed = {} if question.believed is None else flat(as_table(question.believed))
    cases = question.cases | question.held_out_cases
    return [
        Assumption(
            experiment=experiment.name,
            key=key,
            value=f"{value:g}",
            units=keys[key].unit,
            meaning=keys[key].description,
            source=source_of(
                experiment, question.believed, own, absent is not None, key in believed
            ),
        )
        for experiment in (*question.experiments, *question.held_out)
        for own, (key, absent) in CASE_KEYS.items()
        if experiment.stated(own) is None
        and (value := flat(as_table(cases[experiment.name])).get(key)) is not None
    ]


def source_of(
    experiment: "Experiment", believed: "Case | None", own: str, absent: bool, in_case: bool
) -> str:
    """Where the value of a key comes from that an experiment does not state."""
    assumed = experiment.assumed(believed).get(own)
    if assumed is not None:
        return assumed.reason
    return ABSENT if absent else BELIEVED if in_case else DEFAULT
