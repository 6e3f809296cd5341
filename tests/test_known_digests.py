"""A digest is kept for the bytes of all files, and found anew where these change or nothing can be kept."""

import os

from fvcollapse.output.known_digests import FILE, bytes_digest, known_digest


def test_a_digest_is_kept_for_the_bytes_of_all_files(tmp_path):
    """Whatever changes in them, be it a comment, it is found anew; as it is if what was kept cannot be read."""
    file, calls = tmp_path / "rates.py", []

    def known(name=""):
        bytes_digest.cache_clear()  # as in another process
        return known_digest(tmp_path, name, lambda: calls.append(name) or f"digest {len(calls)}")

    file.write_text("a = 1\n")
    assert known() == known() == "digest 1"
    assert known("gate") == known("gate") == "digest 2"
    assert known() == "digest 1"
    status = file.stat()
    file.write_text("a = 2\n")
    os.utime(file, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert known() == known() == "digest 3"
    (tmp_path / "other.py").touch()
    assert known() == known() == "digest 4"
    for broken in ("", "[]", "{}", '{"bytes": 3}', "\xff"):
        (tmp_path / "__pycache__" / FILE).write_text(broken, encoding="latin-1")
        count = len(calls)
        assert known() == known() == f"digest {count + 1}"


def test_a_digest_of_files_that_change_meanwhile_is_not_kept(tmp_path):
    """Else the files as they were before, put back, would have the digest of the others."""
    file = tmp_path / "rates.py"
    file.write_text("a = 1\n")

    def find():
        file.write_text("a = 2\n")
        return "digest of 2"

    bytes_digest.cache_clear()
    assert known_digest(tmp_path, "", find) == "digest of 2"
    file.write_text("a = 1\n")
    bytes_digest.cache_clear()
    assert known_digest(tmp_path, "", lambda: "digest of 1") == "digest of 1"
    bytes_digest.cache_clear()
    assert known_digest(tmp_path, "", lambda: "found again") == "digest of 1"


def test_a_digest_is_found_each_time_where_nothing_can_be_kept(tmp_path):
    (tmp_path / "__pycache__").touch()  # no folder
    assert [known_digest(tmp_path, "", lambda n=n: f"digest {n}") for n in (1, 2)] == [
        "digest 1",
        "digest 2",
    ]
    assert {path.name for path in tmp_path.iterdir()} == {"__pycache__"}
