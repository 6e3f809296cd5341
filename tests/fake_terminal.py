"""A stream that says it is a terminal."""

import io


class Terminal(io.StringIO):
    """What is written to it can be read again."""

    def isatty(self):
        return True
