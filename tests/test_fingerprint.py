"""The digest of the solver: what changes numbers changes it, and nothing else does."""

from pathlib import Path

import pytest

import fvcollapse
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.output.fingerprint import ROOTS, solver_code, solver_digest, solver_version

# a solver in small, with the roots of the true one
FILES = {
    "errors.py": "class NumericalError(Exception):\n    pass\n",
    "grammar.py": (
        "class Section:\n    pass\n\ndef key(unit, description, **limits):\n    return unit\n"
    ),
    "case.py": """
from .grammar import Section, key
from .sections import Cohesion

class Geometry(Section):
    '''The column.'''
    height: Annotated[float, key("m", "height of the column", gt=0)] = 0.14

    @property
    def area(self):
        return self.height * self.length

class Case(Section):
    geometry: Geometry = Geometry()
    cohesion: Cohesion | None = None

    def to_toml(self):
        return "case"
""",
    "sections.py": """
from .grammar import Section, key

class Cohesion(Section):
    kappa_0: Annotated[float, key("Pa", "cohesion", ge=0)] = 0.0
""",
    "effects.py": """
CATALOGUE = {"cohesion": Effect(PHYSICAL, {"kappa_0": Prior("uniform", 0, 1, "C", "a guess")})}

def with_effects(case):
    for apply in KEY_CHANGES:
        case = apply(case)
    return case

def change_cohesion(case):
    return stronger(case, 1.0)

def stronger(case, factor):
    return case

KEY_CHANGES = (change_cohesion,)
""",
    "simulation.py": """
'''The run.'''
from math import sqrt

from .errors import NumericalError
from .step import rates
from .step.solve import solve as solved

LIMIT, GROWTH = 3, 2.0

class Simulation:
    '''A run.'''

    def advance(self, dt: float) -> float:
        '''One step.'''
        if dt > LIMIT:  # too long
            raise NumericalError(f"dt = {dt}: too long")
        return solved(sqrt(rates.shear_rate(dt)))
""",
    "step/__init__.py": "",
    "step/rates.py": "def shear_rate(u):\n    return 2.0 * u\n\ndef unused(u):\n    return u\n",
    "step/solve.py": "def solve(x):\n    return x + _half(x)\n\ndef _half(x):\n    return 0.5 * x\n",
    "recorder.py": "class Recorder:\n    pass\n\ndef schedule(case):\n    return ()\n",
    "observation.py": "def flow_case(case):\n    return case\n",
    "observables.py": "def observe(result):\n    return _half(result)\n\ndef _half(x):\n    return 0.25 * x\n",
}


@pytest.fixture
def digest(tmp_path):
    """Digest of the solver in small after changes of its texts; a file of None is taken away."""
    counter = iter(range(100))

    def made(changes=(), files=(), effects=()):
        package = tmp_path / str(next(counter)) / "small"
        texts = FILES | dict(files)
        for name, old, new in changes:
            assert old in texts[name]
            texts[name] = texts[name].replace(old, new)
        for name, text in texts.items():
            if text is not None:
                (package / name).parent.mkdir(parents=True, exist_ok=True)
                (package / name).write_text(text, encoding="utf-8")
        return solver_digest(package, tuple(effects))

    return made


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("step/rates.py", "2.0 * u", "2.1 * u"),
        ("step/solve.py", "0.5 * x", "0.6 * x"),
        ("simulation.py", "LIMIT, GROWTH = 3", "LIMIT, GROWTH = 4"),
        ("simulation.py", "from math import sqrt", "from numpy import sqrt"),
        ("simulation.py", ".solve import solve", ".solve import _half"),
        ("simulation.py", "raise NumericalError", "raise ValueError"),
        ("simulation.py", "'''The run.'''", "import numpy\nnumpy.seterr(all='raise')"),
        ("step/__init__.py", "", "numpy.seterr(all='raise')"),
        ("effects.py", "case = apply(case)", "case = apply(apply(case))"),
        ("case.py", "self.height *", "self.height +"),
    ],
)
def test_what_changes_numbers_counts(digest, file, old, new):
    assert digest([(file, old, new)]) != digest()


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("simulation.py", "  # too long", ""),
        ("simulation.py", "'''A run.'''", "'''A run of the solver.'''"),
        ("simulation.py", "dt: float) -> float", "dt)"),
        ("simulation.py", "dt = {dt}: too long", "time step of {dt} s"),
        ("simulation.py", "solve as solved", "solve as other"),
        ("case.py", "height of the column", "initial height"),
        ("case.py", "gt=0)] = 0.14", "gt=0, le=9)] = 0.15"),
        ("case.py", 'return "case"', 'return "another"'),
        ("sections.py", '"cohesion", ge=0', '"added cohesion", ge=-1'),
        ("effects.py", '"a guess"', '"measured"'),
        ("effects.py", '"uniform", 0, 1', '"uniform", 0, 2'),
        ("step/rates.py", "return u\n", "return -u\n"),
        ("errors.py", "pass", "status = 1"),
    ],
)
def test_what_changes_none_does_not(digest, file, old, new):
    changes = [(file, old, new)]
    if new.endswith("as other"):
        changes.append((file, "return solved(", "return other("))
    assert digest(changes) == digest()


@pytest.mark.parametrize("statement", ["", "numpy.seterr(all='raise')\n"])
def test_a_definition_may_move_to_another_file(digest, statement):
    rates, solve = FILES["step/rates.py"], statement + FILES["step/solve.py"]
    files = {"flow/rates.py": rates + solve, "step/rates.py": None, "step/solve.py": None}
    changes = [
        ("simulation.py", "from .step import rates", "from small.flow import rates"),
        ("simulation.py", ".step.solve import", ".flow.rates import"),
    ]
    assert digest(changes, files) == digest(files={"step/solve.py": solve})


def test_two_functions_of_one_name_may_not_be_exchanged(digest):
    changes = [("step/solve.py", "0.5 * x", "0.25 * x"), ("observables.py", "0.25 * x", "0.5 * x")]
    assert digest(changes) != digest()


def test_an_effect_that_only_changes_keys_counts_where_it_is_on(digest):
    added = [
        (
            "sections.py",
            "class Cohesion",
            "class Drag(Section):\n    c: float = 0.0\n\nclass Cohesion",
        ),
        ("case.py", "import Cohesion", "import Cohesion, Drag"),
        ("case.py", "cohesion: Cohesion", "drag: Drag | None = None\n    cohesion: Cohesion"),
        ("effects.py", "(change_cohesion,)", "(change_cohesion, change_drag)"),
        (
            "effects.py",
            "\ndef stronger",
            "\ndef change_drag(case):\n    return 2 * case\n\ndef stronger",
        ),
    ]
    for effects in ((), ("cohesion",)):
        assert digest(added, effects=effects) == digest(effects=effects)
    assert digest(added, effects=("drag",)) != digest(added)
    other = [*added[:-1], (*added[-1][:2], added[-1][2].replace("2 *", "3 *"))]
    assert digest(other, effects=("drag",)) != digest(added, effects=("drag",))
    changed = [("effects.py", "return stronger(case, 1.0)", "return stronger(case, 2.0)")]
    assert digest(changed) == digest()
    assert digest(changed, effects=("cohesion",)) != digest(effects=("cohesion",))


def test_an_effect_in_a_file_of_its_own_counts_where_it_is_on(digest):
    """The package of effects: a file with an EFFECT, whose laws stand in the step."""
    effect = """
from small.step.drag import brake

EFFECT = Effect("drag", priors={"c": Prior("uniform", 0, 1, "C", "a guess")}, limit=brake)
"""
    package = {
        "effects.py": None,
        "effects/__init__.py": """
from . import drag

CATALOGUE = {"drag": drag.EFFECT}

def with_effects(case):
    for effect in CATALOGUE.values():
        case = effect.change(case)
    return case
""",
        "effects/drag.py": effect,
        "step/drag.py": "def brake(u):\n    return -u\n",
    }
    without = package | {
        "effects/__init__.py": package["effects/__init__.py"].replace('"drag": drag.EFFECT', ""),
        "effects/drag.py": None,
        "step/drag.py": None,
    }
    assert digest(files=package) == digest(files=without)
    drag = digest(files=package, effects=("drag",))
    assert drag != digest(files=package)
    law, prior = ("step/drag.py", "-u", "-2 * u"), ("effects/drag.py", "a guess", "measured")
    assert digest([law], package, ("drag",)) != drag
    assert digest([prior], package, ("drag",)) == drag


def test_the_order_of_effects_that_are_on_counts(digest):
    both = [
        (
            "effects.py",
            "\ndef stronger",
            "\ndef change_drag(case):\n    return 2 * case\n\ndef stronger",
        ),
        ("effects.py", "(change_cohesion,)", "(change_cohesion, change_drag)"),
    ]
    turned = [both[0], ("effects.py", "(change_cohesion,)", "(change_drag, change_cohesion)")]
    on = ("cohesion", "drag")
    assert digest(both, effects=on) != digest(turned, effects=on)
    assert digest(both, effects=("drag",)) == digest(turned, effects=("drag",))
    assert digest(both, effects=on) != digest(both, effects=on[::-1])


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("2.0 * u\n", "2.0 * u\n\nshear_rate = twice(shear_rate)\n"),
        ("def shear_rate(u):", "if FAST:\n  def shear_rate(u):"),
    ],
)
def test_a_name_that_is_bound_again_or_under_a_condition_counts(digest, old, new):
    again = digest([("step/rates.py", old, new)])
    assert again != digest()
    texts = [("step/rates.py", old, new), ("step/rates.py", "2.0 * u", "2.1 * u")]
    assert digest(texts) != again


def test_a_root_that_is_missing_is_an_error(digest):
    with pytest.raises(LookupError, match=r"no definition simulation\.Simulation"):
        digest([("simulation.py", "class Simulation", "class Run")])


def test_the_digest_covers_the_step_and_nothing_of_the_output():
    code = solver_code(Path(fvcollapse.__file__).parent)
    reached = code.reached(ROOTS)
    modules = {module.rpartition(".")[2] for module, _ in reached}
    step = {path.stem for path in (code.package / "step").glob("[a-z]*.py")}
    assert step | {"simulation", "recorder", "grid", "state"} <= modules
    assert not {"output", "sweep", "pictures", "errors", "case_rules", "files"} & modules
    assert not {"CATALOGUE", "KEY_CHANGES", "case_from_table"} & {name for _, name in reached}
    assert {"Geometry", "Simulation", "observe", "KernelCache"} <= {name for _, name in reached}


def test_the_version_depends_on_the_effects_that_are_on():
    assert solver_version() == solver_version(tuple(CATALOGUE))
    assert solver_version(("tilt", "gate")) == solver_version(("gate", "tilt"))
    assert len({solver_version(), solver_version(()), solver_version(("gate",))}) == 3
    assert solver_version().startswith(f"{fvcollapse.__version__}+")
