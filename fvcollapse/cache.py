"""The place of `RunCache` in earlier scripts; new ones import it from `fvcollapse`."""

from fvcollapse.studies.cache import RunCache as RunCache
