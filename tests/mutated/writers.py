"""Writers of mutated inputs."""

from mutated import seeds, text
from mutated.values import pick


def mutated_text(mutations):
    """A writer of one file from `texts(seed)`, a list of (name, bytes)."""

    def writer(texts):
        def write(seed, rng, folder):
            name, data = pick(rng, texts(seed))
            path = folder / name
            path.write_bytes(text.mutated(data, rng, mutations))
            return path

        return write

    return writer


def in_copy(source, mutations):
    """A writer of a copy of a seed folder with one of its files mutated: mutations by suffix."""

    def write(seed, rng, folder):
        place = seeds.fresh(folder, source, seed.folder / source)
        path = pick(rng, sorted(path for path in place.iterdir() if path.is_file()))
        path.write_bytes(text.mutated(path.read_bytes(), rng, mutations[path.suffix]))
        return place

    return write
