"""Version of the code, stored with every result."""

__version__ = "0.1.0"
