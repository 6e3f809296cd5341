"""All standard pictures of a result as files, each with its caption, and an animation."""

from functools import partial
from pathlib import Path

from fvcollapse.draw.animation import animation, ffmpeg
from fvcollapse.draw.captions import caption
from fvcollapse.draw.drawing import image_of
from fvcollapse.draw.figures import FIGURES, draw, refuse_no_field
from fvcollapse.draw.look import Look
from fvcollapse.errors import InputError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.files.targets import make_folder
from fvcollapse.output.question import case_question, claim_folder
from fvcollapse.output.result import Result, open_result

USUAL = Look()


def claim_pictures(result_path: str | Path, folder: str | Path, force: bool = False) -> None:
    """Make a folder that of the pictures of a run; those of an earlier state of the run may be renewed.

    Parameters
    ----------
    result_path : str or Path
        `result.h5`, or the folder that holds it.
    folder : str or Path
        Where the pictures go.
    force : bool
        Take the folder over from pictures of another run; see `question`.

    Raises
    ------
    InputError, OutputError
    """
    case = open_result(result_path).case
    claim_folder(folder, "plot", case_question(case, without=["time.end"]), force)


def refuse_look(result_path: str | Path, look: Look) -> None:
    """Refuse what cannot be drawn of a result; nothing is written.

    Parameters
    ----------
    result_path : str or Path
    look : Look

    Raises
    ------
    InputError
        A field that is not there, a time outside of the run, MP4 without ffmpeg.
    """
    result = open_result(result_path)
    for name in look.fields if look.animation == "none" else ("speed", *look.fields):
        refuse_no_field(result, name)
    times = result.profiles.time
    slack = times[-1] - times[-2] if len(times) > 1 else 0.0  # the nearest stored time is drawn
    for time in look.times:
        if not 0.0 <= time <= times[-1] + slack:
            allowed = f"0 to {times[-1]:g} s, the end of {result.path}"
            raise InputError("command line", "--times", f"{time:g}", allowed)
    if look.animation == "mp4":
        ffmpeg()


def draw_all(
    result_path: str | Path, folder: str | Path | None = None, look: Look = USUAL
) -> list[Path]:
    """Draw every standard picture of a result, and write a caption beside each.

    Parameters
    ----------
    result_path : str or Path
        `result.h5`, or the folder that holds it.
    folder : str or Path, optional
        Where the pictures go; default `pictures` beside the result.
    look : Look

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        No result, or a look that it does not allow; see `refuse_look`.
    OutputError
    """
    refuse_look(result_path, look)
    result = open_result(result_path)
    folder = Path(folder) if folder is not None else result_path_of(result).parent / "pictures"
    pictures = {
        f"{what}.{look.format}": partial(picture, result, what, look)
        for what in (*FIGURES, *look.fields)
    }
    if look.animation != "none":
        pictures[f"animation.{look.animation}"] = partial(animation, result, look)
    texts = {name: caption(result, name.partition(".")[0], look) for name in pictures}
    files = [name for made in pictures for name in (made, caption_name(made))]
    make_folder(folder, *files)
    for name, make in pictures.items():
        write_atomic(folder / name, make())
        write_atomic(folder / caption_name(name), texts[name].encode())
    return [folder / name for name in files]


def picture(result: Result, what: str, look: Look) -> bytes:
    """A picture as a file."""
    return image_of(draw(result, what, look), look.format, look.dpi)


def caption_name(name: str) -> str:
    """Name of the text file beside a picture."""
    return f"{name.partition('.')[0]}.txt"


def result_path_of(result: Result) -> Path:
    """Path of a result that is a file."""
    if result.path is None:
        raise TypeError("a result in memory has no folder")
    return result.path
