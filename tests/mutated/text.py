"""Mutations of texts: of any bytes, of lines, of the cells of a CSV file, of TOML values, of JSON trees."""

import json
import re

from mutated.values import DEEP, DEEP_LIST, DEEP_TABLE, NUMBERS, TREES, VERY_DEEP, WORDS, pick

NUMBER = re.compile(rb"-?\d+\.?\d*(?:e-?\d+)?")
MARKS = [b",", b";", b"\t", b" ", b"|", b":", b",,", b", ", b"."]


def encoded(text):
    """UTF-8 in which lone surrogates stay what they are: bytes that are no text."""
    return text.encode("utf-8", "surrogatepass")


# -- any bytes -----------------------------------------------------------------------------------


def flip(data, rng):
    """A few bits flipped."""
    out = bytearray(data)
    for _ in range(int(rng.integers(1, 4))):
        out[int(rng.integers(len(out)))] ^= 1 << int(rng.integers(8))
    return bytes(out)


def cut(data, rng):
    """The end is missing."""
    return data[: int(rng.integers(len(data)))]


def insert(data, rng):
    """Foreign bytes in the middle."""
    at = int(rng.integers(len(data) + 1))
    return data[:at] + pick(rng, [b"\x00", b"\xff", b"\xe9", b"\n", b"\r", b'"', b"#"]) + data[at:]


def remove(data, rng):
    """A stretch is missing."""
    at = int(rng.integers(len(data)))
    return data[:at] + data[at + int(rng.integers(1, 20)) :]


def repeat(data, rng):
    """A stretch is there twice."""
    at, count = int(rng.integers(len(data))), int(rng.integers(1, 60))
    return data[: at + count] + data[at:]


def other_number(data, rng):
    """One number is another, or none."""
    found = list(NUMBER.finditer(data))
    if not found:
        return flip(data, rng)
    match = pick(rng, found)
    return data[: match.start()] + encoded(pick(rng, NUMBERS)) + data[match.end() :]


def other_encoding(data, rng):
    """The same text as another program saves it."""
    text = data.decode("utf-8")
    code = pick(rng, ["utf-16", "utf-8-sig", "utf-32", "utf-16-le"])
    return text.encode(code)


def nothing(data, rng):
    """Empty, blank, zeros, or a file of another kind."""
    return pick(rng, [b"", b"\n", b" \n \n", b"\x00" * 100, b"\x89HDF\r\n\x1a\n", b"PK\x03\x04"])


# -- lines ---------------------------------------------------------------------------------------


def swap_lines(data, rng):
    """Two lines have changed places."""
    lines = data.split(b"\n")
    i, j = (int(rng.integers(len(lines))) for _ in range(2))
    lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def double_line(data, rng):
    """A line is there twice."""
    lines = data.split(b"\n")
    i = int(rng.integers(len(lines)))
    return b"\n".join([*lines[: i + 1], lines[i], *lines[i + 1 :]])


def drop_line(data, rng):
    """A line is missing."""
    lines = data.split(b"\n")
    del lines[int(rng.integers(len(lines)))]
    return b"\n".join(lines)


def other_ends(data, rng):
    """Line ends of other systems."""
    return data.replace(b"\n", pick(rng, [b"\r\n", b"\r", b"\n\n", "\u2028".encode()]))


BYTES = (flip, cut, insert, remove, repeat, other_number, other_encoding, nothing)
LINES = (swap_lines, double_line, drop_line, other_ends)


# -- CSV -----------------------------------------------------------------------------------------


def other_mark(data, rng):
    """Another mark between the columns."""
    return data.replace(b",", pick(rng, MARKS))


def other_cell(data, rng):
    """One cell is another number, word or nothing."""
    lines = data.split(b"\n")
    i = int(rng.integers(len(lines)))
    cells = lines[i].split(b",")
    cells[int(rng.integers(len(cells)))] = encoded(pick(rng, [*NUMBERS, *WORDS]))
    lines[i] = b",".join(cells)
    return b"\n".join(lines)


def scaled_column(data, rng):
    """A column in another unit, of another sign, or shifted."""
    lines = [line.split(b",") for line in data.split(b"\n")]
    column = int(rng.integers(max(len(lines[0]), 1)))
    factor = pick(rng, [-1.0, 10.0, 100.0, 1000.0, 1e-3, 1e300, 0.0])
    for cells in lines:
        if column < len(cells) and NUMBER.fullmatch(cells[column]):
            cells[column] = f"{float(cells[column]) * factor:.12g}".encode()
    return b"\n".join(b",".join(cells) for cells in lines)


def extra_column(data, rng):
    """A column more, or a mark at the end of every line."""
    return data.replace(b"\n", pick(rng, [b",\n", b",0\n", b",,,\n", b';"\n']))


CSV = (*BYTES, *LINES, other_mark, other_cell, other_cell, scaled_column, extra_column)


# -- TOML ----------------------------------------------------------------------------------------


def other_value(data, rng):
    """One value is of another type, out of range, or nested deep."""
    lines = data.split(b"\n")
    places = [i for i, line in enumerate(lines) if b"=" in line]
    i = pick(rng, places)
    name = lines[i].partition(b"=")[0]
    deep = [DEEP_LIST, DEEP_TABLE, VERY_DEEP, "[[1, 2], [3]]", "{}", "[]", "[nan]", "{x = 1}"]
    words = [json.dumps(word, ensure_ascii=False) for word in WORDS]
    value = pick(rng, pick(rng, [NUMBERS, deep, words]))
    lines[i] = name + b"= " + encoded(value)
    return b"\n".join(lines)


def other_name(data, rng):
    """One key or section has another name."""
    lines = data.split(b"\n")
    i = pick(rng, [i for i, line in enumerate(lines) if b"=" in line or line.startswith(b"[")])
    word = encoded(pick(rng, [*WORDS, "a." * 300 + "a", "x" * 5000]))
    head, mark, tail = lines[i].partition(b"=")
    quoted = b'"' + word + b'"' if rng.random() < 0.5 else word
    lines[i] = quoted + mark + tail if mark else b"[" + quoted + b"]"
    return b"\n".join(lines)


def many_levels(data, rng):
    """A key or a header of hundreds of levels."""
    levels = ".".join(["a"] * pick(rng, [DEEP, 3000]))
    return data + encoded(pick(rng, [f"\n{levels} = 1\n", f"\n[{levels}]\n", f"\n[[{levels}]]\n"]))


TOML = (*BYTES, *LINES, other_value, other_value, other_value, other_name, many_levels)


# -- JSON ----------------------------------------------------------------------------------------


def places(tree):
    """Every (parent, key) of a tree."""
    todo, found = [tree], []
    while todo:
        node = todo.pop()
        for key in list(node) if isinstance(node, dict) else range(len(node)):
            found.append((node, key))
            if isinstance(node[key], dict | list):
                todo.append(node[key])
    return found


def other_node(tree, rng):
    """One value of a tree is of another type or out of range."""
    parent, key = pick(rng, places(tree))
    numbers = [float("nan"), float("inf"), -float("inf"), *WORDS]
    parent[key] = pick(rng, [*TREES, *numbers])


def lost_node(tree, rng):
    """One value is missing."""
    parent, key = pick(rng, places(tree))
    del parent[key]


def renamed_node(tree, rng):
    """One key is another word."""
    tables = [place for place in places(tree) if isinstance(place[0], dict)]
    parent, key = pick(rng, tables)
    parent[pick(rng, WORDS)] = parent.pop(key)


def moved_node(tree, rng):
    """One value stands where another should."""
    (first, a), (second, b) = pick(rng, places(tree)), pick(rng, places(tree))
    second[b] = json.loads(json.dumps(first[a]))


def mutated_tree(change):
    """A mutation of the text from one of the tree."""

    def mutate(data, rng):
        tree = json.loads(data)
        change(tree, rng)
        return encoded(json.dumps(tree, ensure_ascii=bool(rng.random() < 0.5)))

    mutate.__name__ = change.__name__
    return mutate


def deep_node(data, rng):
    """One number is a list of hundreds of levels."""
    found = list(NUMBER.finditer(data))
    match = pick(rng, found)
    deep = encoded(pick(rng, [DEEP_LIST, VERY_DEEP, '{"a":' * DEEP + "1" + "}" * DEEP]))
    return data[: match.start()] + deep + data[match.end() :]


def double_key(data, rng):
    """A key is there twice."""
    found = list(re.finditer(rb'"([^"]+)":', data))
    match = pick(rng, found)
    return data[: match.start()] + match.group(0) + b" null, " + data[match.start() :]


def whole_tree(data, rng):
    """Something else than a table."""
    return encoded(json.dumps(pick(rng, [*TREES, float("nan"), {"format": [1]}])))


TREE = tuple(map(mutated_tree, (other_node, lost_node, renamed_node, moved_node)))
JSON = (*BYTES, *TREE, *TREE, *TREE, deep_node, double_key, whole_tree)


def mutated(data, rng, mutations):
    """The data after one mutation, sometimes after two."""
    out = pick(rng, mutations)(data, rng)
    if rng.random() < 0.2 and out:
        out = pick(rng, BYTES[:6])(out, rng)
    return out
