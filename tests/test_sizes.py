"""Sizes that a reader can hold: files, functions and lists of arguments."""

import ast

from parsed_code import PACKAGE, ROOT, files_in, tree_of

FILE_LINES, CODE_LINES, ARGUMENTS, KERNEL_ARGUMENTS = 300, 40, 6, 10
# functions that may be longer or take more arguments, and why
EXCEPTIONS = {
    ("diagnosis/diagnose.py", "diagnose"): "the public call: one argument for each option",
    ("output/run.py", "run_case"): "the public call: one argument for each option",
    ("measure/observables.py", "observe"): "the public call: one argument for each option",
    ("step/advance.py", "stepper"): "the text of a step, for kernels and for plain Python",
    ("march.py", "marcher"): "the text of a march, for kernels and for plain Python",
    ("step/plain_terms.py", "project"): "a stage: the arguments of the compiled one",
    ("step/coefficients.py", "coefficients"): "entry from Python with fields and constants",
    ("step/coupled.py", "solve"): "the loop over the sweeps: every call takes arrays of its own",
    (
        "step/momentum.py",
        "mass_fluxes",
    ): "six sides of two kinds of control volumes share what they read",
    ("step/momentum.py", "advect_momentum"): "entry from Python with all arrays of two instants",
    ("step/level_set.py", "advection_rate"): "one pass over the band: WENO5 in two directions",
    (
        "step/coulomb_walls.py",
        "bed_friction",
    ): "called in every sweep on arrays that no tuple holds",
    (
        "step/coulomb_walls.py",
        "back_wall_friction",
    ): "called in every sweep on arrays that no tuple holds",
    ("step/gate.py", "gate_friction"): "called in every sweep on arrays that no tuple holds",
    ("step/dilatancy.py", "dilate"): "called in every sweep on arrays that no tuple holds",
    ("step/grain_response.py", "respond"): "the one hook of the effects in a sweep",
    ("step/coefficients.py", "answer_beforehand"): "the hook before the first sweep",
    ("step/quantities.py", "fill_quantities"): "five results of one pass",
    ("step/redistancing.py", "slopes"): "ten values of a stencil",
    ("step/lanes.py", "subtract_rows"): "rows of a band by pointer and stride",
    ("step/lanes.py", "scale_rows"): "rows of a band by pointer and stride",
    ("step/lanes.py", "subtract_block"): "rows of a band by pointer and stride",
    ("step/projection.py", "solve"): "the reference method has the arguments of the coupled one",
    (
        "step/projection.py",
        "assemble_momentum",
    ): "the reference method has the arguments of the coupled one",
    ("verification/boxes.py", "__init__"): "the options of a box, by keyword",
    ("runs/paper/statement_terms.py", "clause_in"): "the parts of a clause, and the windows of it",
    ("runs/remake_tasks.py", "study"): "a row of the list of tasks: the options by keyword",
}
FOLDERS = ("fvcollapse", "runs", "plots")


def functions_of(tree):
    """All functions and methods in a syntax tree."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def code_lines(function, lines):
    """Number of lines of a function that are neither blank, nor comment, nor docstring."""
    documented = ast.get_docstring(function) is not None
    first = function.body[0]
    prose = set(range(first.lineno, first.end_lineno + 1)) if documented else set()
    numbers = set(range(function.lineno, function.end_lineno + 1)) - prose
    stripped = (lines[number - 1].strip() for number in numbers)
    return sum(bool(line) and not line.startswith("#") for line in stripped)


def argument_count(function):
    """Number of arguments of a function, without that of the object of a method."""
    arguments = function.args
    names = [a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"]))


def is_kernel(function):
    """Whether a function is compiled."""
    return any("jit" in ast.unparse(decorator) for decorator in function.decorator_list)


def too_large(path):
    """(file, function) of every function of a file that is larger than allowed."""
    lines = path.read_text(encoding="utf-8").splitlines()
    for function in functions_of(tree_of(path)):
        most = KERNEL_ARGUMENTS if is_kernel(function) else ARGUMENTS
        if code_lines(function, lines) > CODE_LINES or argument_count(function) > most:
            base = PACKAGE if path.is_relative_to(PACKAGE) else ROOT
            yield path.relative_to(base).as_posix(), function.name


def test_files_are_small():
    files = files_in(*FOLDERS, "tests")
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert len(lines) > 400
    assert [path for path, number in lines.items() if number > FILE_LINES] == []


def test_functions_are_small_and_every_exception_is_needed():
    found = {name for path in files_in(*FOLDERS) for name in too_large(path)}
    assert sorted(found - set(EXCEPTIONS)) == []
    assert sorted(set(EXCEPTIONS) - found) == []


def test_the_count_is_of_code():
    text = 'def f(self, a, *, b):\n    """Prose.\n\n    More.\n    """\n    # a comment\n\n    return a\n'
    (function,) = functions_of(ast.parse(text))
    assert code_lines(function, text.splitlines()) == 2
    assert argument_count(function) == 2
