"""Series of three slopes whose common cause is withheld, each diagnosed as one question with the two controls."""

from fvcollapse import diagnose
from fvcollapse.blind.answers import answer_of_report

ANSWERS = "series_answers.json"


def series_folders(data):
    """{name: folders of its experiments} of all series below a folder of data."""
    return {
        place.name: sorted(path for path in place.iterdir() if path.is_dir())
        for place in sorted((data / "series").iterdir())
        if place.is_dir()
    }


def series(arguments, baseline, controls):
    """{series: answer} of the series; a series that has a report below --out is not diagnosed again.

    Parameters
    ----------
    arguments : argparse.Namespace
        Options of the study.
    baseline : Path
        What is believed.
    controls : sequence of Experiment
    """
    answers = {}
    for name, folders in series_folders(arguments.data).items():
        page = arguments.out / "series" / name
        report = diagnose(
            folders,
            baseline,
            workers=arguments.workers,
            folder=page,
            cell_size=arguments.cell_size,
            controls=controls,
            cache=arguments.cache,
            quiet=False,
        )
        answers[name] = answer_of_series(report)
        best = list(answers[name]["probability"].items())[:3]
        words = ", ".join(f"{cause} {chance:.2f}" for cause, chance in best)
        print(f"{name}: {answers[name]['verdict']} ({words})", flush=True)
    return answers


def answer_of_series(report):
    """Verdict, probabilities, set, parameters with intervals, and the predicted closing of the gap of a report."""
    answer = answer_of_report(report)
    closing = answer.pop("reduction", {})
    return answer | {"predicted_closing": closing.get("predicted")}
