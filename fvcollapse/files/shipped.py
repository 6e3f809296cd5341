"""The case and the experiments that come with the package: `runs` of a checkout, `examples` of an installed copy."""

from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path

PACKAGE = Path(str(files("fvcollapse")))
INSTALLED, CHECKOUT = PACKAGE / "examples", PACKAGE.parent / "runs"
PARTS = ("collapse_22deg_w10cm.toml", "experiments")  # as the wheel has them, see pyproject.toml
KINDS = (".toml", ".csv", ".md")


def shipped_files() -> dict[Path, Path]:
    """{path below `runs`: Path of the file} of everything that is shipped, in the order of the names.

    Raises
    ------
    FileNotFoundError
        The package was installed without them.
    """
    folder = INSTALLED if INSTALLED.is_dir() else CHECKOUT
    found = [path for part in PARTS for path in everything(folder / part) if path.suffix in KINDS]
    if not found:
        raise FileNotFoundError(f"no files in {folder}")
    return {path.relative_to(folder): path for path in sorted(found)}


def everything(path: Path) -> Iterable[Path]:
    """A file itself, or all files below a folder."""
    return path.rglob("*") if path.is_dir() else [path] if path.is_file() else []
