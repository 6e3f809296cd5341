"""The digest of the solver: what changes numbers changes it, and nothing else does."""

from pathlib import Path

import pytest

import fvcollapse
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.output.fingerprint import ROOTS, solver_code, solver_digest, solver_version

# a solver in small, with the roots of the true one
FILES = {
    "errors.py": "class NumericalError(Exception):\n    pass\n",
    "case/grammar.py": (
        "class Section:\n    pass\n\ndef key(unit, description, **limits):\n    return unit\n"
    ),
    "case/case.py": """
from small.effects.catalogue import CATALOGUE, with_effects
from .grammar import Section, key

class Geometry(Section):
    '''The column.'''
    height: Annotated[float, key("m", "height of the column", gt=0)] = 0.14

    @property
    def area(self):
        return self.height * self.length

Effects = msgspec.defstruct("Effects", [(name, each.section) for name, each in CATALOGUE.items()])

class Case(Section):
    geometry: Geometry = Geometry()
    effects: Effects = Effects()

    @property
    def resolved(self):
        return with_effects(self)

    def to_toml(self):
        return "case"
""",
    "effects/catalogue.py": """
NAMES = ("cohesion",)
CATALOGUE = {name: import_module(f"small.effects.{name}").EFFECT for name in NAMES}

def with_effects(case):
    for effect in CATALOGUE.values():
        case = effect.change(case)
    return case
""",
    "effects/cohesion.py": """
from small.case.grammar import Section, key
from small.effects.effect import Effect, Prior

class Cohesion(Section):
    kappa_0: Annotated[float, key("Pa", "cohesion", ge=0)] = 0.0

def raise_yield_stress(case):
    return stronger(case, 1.0)

def stronger(case, factor):
    return case

EFFECT = Effect("cohesion", PHYSICAL, Cohesion,
    priors={"kappa_0": Prior("uniform", 0, 1, "C", "a guess")}, change=raise_yield_stress)
""",
    "effects/effect.py": "class Effect(NamedTuple):\n    name: str\n\nclass Prior(NamedTuple):\n    kind: str\n",
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
    "output/recorder.py": "class Recorder:\n    pass\n\ndef schedule(case):\n    return ()\n",
    "measure/observation.py": "def flow_case(case):\n    return case\n",
    "measure/observables.py": (
        "def observe(result):\n    return _half(result)\n\ndef _half(x):\n    return 0.25 * x\n"
    ),
}
DRAG = """
from small.case.grammar import Section
from small.effects.effect import Effect, Prior

class Drag(Section):
    c: float = 0.0

EFFECT = Effect("drag", PHYSICAL, Drag, priors={"c": Prior("uniform", 0, 1, "C", "a guess")}, term="drag")
"""
ADDED = [("effects/catalogue.py", '("cohesion",)', '("cohesion", "drag")')]
ADDED_FILES = {"effects/drag.py": DRAG, "step/drag.py": "def before_solve(u):\n    return -u\n"}


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
        ("effects/catalogue.py", "effect.change(case)", "effect.change(effect.change(case))"),
        ("case/case.py", "self.height *", "self.height +"),
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
        ("case/case.py", "height of the column", "initial height"),
        ("case/case.py", "gt=0)] = 0.14", "gt=0, le=9)] = 0.15"),
        ("case/case.py", 'return "case"', 'return "another"'),
        ("effects/cohesion.py", '"cohesion", ge=0', '"added cohesion", ge=-1'),
        ("effects/cohesion.py", '"a guess"', '"measured"'),
        ("effects/cohesion.py", '"uniform", 0, 1', '"uniform", 0, 2'),
        ("step/rates.py", "return u\n", "return -u\n"),
        ("errors.py", "pass", "status = 1"),
        ("simulation.py", "    def advance", "    def plot(self):\n        1\n\n    def advance"),
        ("simulation.py", "LIMIT, GROWTH", "if TYPE_CHECKING:\n    import xarray\n\nLIMIT, GROWTH"),
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
    changes = [
        ("step/solve.py", "0.5 * x", "0.25 * x"),
        ("measure/observables.py", "0.25 * x", "0.5 * x"),
    ]
    assert digest(changes) != digest()


def test_an_effect_counts_where_it_is_on(digest):
    for effects in ((), ("cohesion",)):
        assert digest(ADDED, ADDED_FILES, effects) == digest(effects=effects)
    drag = digest(ADDED, ADDED_FILES, ("drag",))
    assert drag != digest(ADDED, ADDED_FILES)
    law = [*ADDED, ("step/drag.py", "-u", "-2 * u")]
    assert digest(law, ADDED_FILES, ("drag",)) != drag
    changed = [("effects/cohesion.py", "return stronger(case, 1.0)", "return stronger(case, 2.0)")]
    assert digest(changed) == digest()
    assert digest(changed, effects=("cohesion",)) != digest(effects=("cohesion",))


def test_what_is_known_of_an_effect_does_not_count(digest):
    for old, new in (
        ("a guess", "measured"),
        ("change=raise", "zero=({}, {}), change=raise"),
        ("change=raise", "needs_walls=True, refuse=stronger, change=raise"),
    ):
        prose = [("effects/cohesion.py", old, new)]
        assert digest(prose, effects=("cohesion",)) == digest(effects=("cohesion",))


def test_the_order_of_effects_that_are_on_counts(digest):
    on = ("cohesion", "drag")
    assert digest(ADDED, ADDED_FILES, on) != digest(ADDED, ADDED_FILES, on[::-1])


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
    assert not {"output", "sweep", "pictures", "errors", "rules", "files"} & modules
    assert not {"CATALOGUE", "NAMES", "case_from_table"} & {name for _, name in reached}
    assert {"Geometry", "Simulation", "observe", "kernel_jit"} <= {name for _, name in reached}
    assert "kernel_cache" not in modules  # where kernels are kept changes no number


def test_the_version_depends_on_the_effects_that_are_on():
    assert solver_version() == solver_version(tuple(CATALOGUE))
    assert solver_version(("tilt", "gate")) == solver_version(("gate", "tilt"))
    assert len({solver_version(), solver_version(()), solver_version(("gate",))}) == 3
    assert solver_version().startswith(f"{fvcollapse.__version__}+")
