"""What no measurement of an experiment shows of the origin of X is said."""

from experiment_folder import write_experiment

from fvcollapse import load_experiment
from fvcollapse.diagnosis.oddities import oddities_of
from fvcollapse.diagnosis.report.limits import unseen_origins


def test_a_runout_alone_does_not_show_its_origin(tmp_path):
    nothing = dict.fromkeys(("front", "profiles", "volume", "interface"))
    alone = load_experiment(write_experiment(tmp_path / "alone", **nothing))
    beside = load_experiment(write_experiment(tmp_path / "beside"))
    (sentence,) = unseen_origins([alone, beside])
    assert "run-out of alone stands alone" in sentence
    assert "from the gate" in sentence
    assert unseen_origins([beside]) == []
    stop = "name,value\ntime_stop,1.4\n"
    stop = load_experiment(write_experiment(tmp_path / "stop", **nothing | {"scalars": stop}))
    assert unseen_origins([stop]) == []


def test_oddities_carry_the_name_of_their_experiment(tmp_path):
    plain = load_experiment(write_experiment(tmp_path / "plain"))
    runout = load_experiment(write_experiment(tmp_path / "far", scalars="name,value\nrunout,20\n"))
    (found,) = oddities_of([plain, runout])
    assert (found.experiment, found.file, found.key) == ("far", "scalars.csv", "runout")
    assert found.line().startswith("far/scalars.csv: runout: found 20 m; expected: <= ")
