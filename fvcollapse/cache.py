"""Public name of `fvcollapse.studies.cache`: the cache of runs."""

from fvcollapse.studies.cache import RunCache as RunCache
