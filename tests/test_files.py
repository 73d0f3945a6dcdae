"""Files that are written: refused before the work, complete or not there, the older one kept."""

import os
import resource
import signal
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from sebody import InputError, WriteError
from sebody.basics.files import check_target, replacing
from sebody.basics.files.members import Header, Member, Table


def parts(folder):
    return [path for path in folder.iterdir() if path.suffix == ".part"]


def test_a_file_takes_the_place_of_the_older_one_when_it_is_complete(tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(b"older")
    path.chmod(0o640)
    with replacing(path, "output file") as file:
        file.write(b"newer")
        assert path.read_bytes() == b"older"
    assert path.read_bytes() == b"newer" and path.stat().st_mode & 0o777 == 0o640
    assert not parts(tmp_path)


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_error_on_the_way_leaves_the_older_file(tmp_path, error):
    path = tmp_path / "a.npz"
    path.write_bytes(b"older")
    with pytest.raises(error), replacing(path, "output file") as file:
        file.write(b"newer")
        raise error
    assert path.read_bytes() == b"older" and not parts(tmp_path)


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    link, path = tmp_path / "link.npz", tmp_path / "elsewhere" / "a.npz"
    path.write_bytes(b"older")
    link.symlink_to(path)
    with replacing(check_target(link, "output file"), "output file") as file:
        file.write(b"newer")
    assert link.is_symlink() and path.read_bytes() == b"newer"


def test_a_full_disk_leaves_the_older_file(tmp_path):
    """By the largest size of a file, which fails like a disk that is full."""
    path = tmp_path / "a.npz"
    path.write_bytes(b"older")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, limits[1]))
    try:
        with pytest.raises(WriteError, match="the output file .*a.npz cannot be written: File too "
                                             "large; the older file is unchanged"):
            with replacing(path, "output file") as file:
                file.write(bytes(20_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, handler)
    assert path.read_bytes() == b"older" and not parts(tmp_path)


def test_a_process_killed_while_it_writes_leaves_the_older_file(tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(b"older")
    child = os.fork()
    if not child:
        with replacing(path, "output file") as file:
            file.write(bytes(10**6))
            os.kill(os.getpid(), signal.SIGKILL)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    assert path.read_bytes() == b"older"


def test_targets_that_cannot_be_written(tmp_path):
    (tmp_path / "full.npz").symlink_to("/dev/full")
    for path, message in ((tmp_path / "full.npz", "full.npz is a device: give the path of a file"),
                          (tmp_path, "is a folder: give the path of a file"),
                          (tmp_path / "no" / "a.npz", "folder .*no of the .* does not exist")):
        with pytest.raises(InputError, match=f"output file.*{message}|{message}"):
            check_target(path, "output file")
    assert not parts(tmp_path)


@pytest.fixture
def somebody():
    """A user without the rights of root, which may write everywhere."""
    if os.geteuid():
        yield
    else:
        os.seteuid(65534)
        yield
        os.seteuid(0)


def test_folders_and_files_without_the_right_to_write(somebody):
    with tempfile.TemporaryDirectory() as name:
        folder, path = Path(name), Path(name) / "a.npz"
        path.write_bytes(b"older")
        path.chmod(0o444)
        message = r".\.npz cannot be written \(Permission denied\): give another path"
        with pytest.raises(InputError, match=message):
            check_target(path, "output file")
        folder.chmod(0o555)
        with pytest.raises(InputError, match=message):
            check_target(folder / "b.npz", "output file")
        folder.chmod(0o755)


class Arrays:
    """An open file of some arrays."""

    def __init__(self, **members):
        self._members = {name: np.asarray(values) for name, values in members.items()}
        self.headers = {name: Header(one.shape, one.dtype)
                        for name, one in self._members.items()}

    def read(self, name):
        return self._members[name]


def test_an_index_is_below_the_length_it_points_into():
    table = Table("a file", "write it again", {"places": Member(("nodes", 3)), "at": Member(
        (None,), "i", least=0, below="nodes")})
    places = np.zeros((4, 3))
    assert list(table.read(Arrays(places=places, at=[0, 3, 1]))["at"]) == [0, 3, 1]
    for wrong, said in (([0, 4], "a file holds 4 in at, where the largest is 3: write it again"),
                        ([-1, 2], "a file holds -1 in at, where the least is 0: write it again")):
        with pytest.raises(InputError) as caught:
            table.read(Arrays(places=places, at=wrong))
        assert str(caught.value) == said


def test_what_a_killed_writer_left_long_ago_is_removed(tmp_path):
    """By the next writer of this file; what others write, or what is being written, stays."""
    own, other = tmp_path / "a.npz", tmp_path / "b.npz"
    left, entered = [], []
    for path, age in ((own, 7200.0), (own, 60.0), (other, 7200.0)):
        writer = replacing(path, "output file")
        writer.__enter__()
        part, = set(parts(tmp_path)) - set(left)
        os.utime(part, (time.time() - age,) * 2)
        left.append(part)
        if len(left) == 1:
            os.utime(part, (time.time(),) * 2)      # the next writer comes soon
        entered.append(writer)
    os.utime(left[0], (time.time() - 7200.0,) * 2)
    with replacing(own, "output file") as file:
        file.write(b"whole")
    assert own.read_bytes() == b"whole" and set(parts(tmp_path)) == set(left[1:])
