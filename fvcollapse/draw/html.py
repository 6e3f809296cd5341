"""Tables that notebooks show in place of an object."""

from collections.abc import Iterable, Sequence
from html import escape


def html_table(title: str, rows: Iterable[Sequence[object]], header: Sequence[str] = ()) -> str:
    """A table as HTML; everything in it is text."""
    lines = [f"<tr>{cells(row, 'td')}</tr>" for row in rows]
    head = f"<thead><tr>{cells(header, 'th')}</tr></thead>" if header else ""
    caption = f"<caption style='text-align:left'><b>{escape(title)}</b></caption>"
    return f"<table>{caption}{head}<tbody>{''.join(lines)}</tbody></table>"


def cells(values: Sequence[object], tag: str) -> str:
    """The cells of a row, aligned to the left."""
    return "".join(f"<{tag} style='text-align:left'>{escape(str(v))}</{tag}>" for v in values)
