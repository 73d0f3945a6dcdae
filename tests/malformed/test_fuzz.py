"""Files of every kind with bits flipped, cut off, or with pieces at the wrong place.

What comes back is the same, or a plain error; of files of other programs, which have no checksums,
it may be another body, which is checked as any.
"""

import importlib.util
import warnings

import numpy as np
import pytest
from malformed.read_files import KINDS, same

from sebody import SebodyError

CASES = 2000
SLOW = {"generated": 60, "op4": 80, "restart": 130, "result hdf5": 130, "sid": 80}     # cases
LONGEST = 10.0      # seconds, see conftest


def counts() -> dict[str, int]:
    """So many cases of each kind; the others share what the slow ones leave."""
    rest = [name for name in KINDS if name not in SLOW]
    each, more = divmod(CASES - sum(SLOW.values()), len(rest))
    return SLOW | {name: each + (k < more) for k, name in enumerate(rest)}


def spoilt(data: bytes, random: np.random.Generator) -> bytes:
    """A file cut off, with flipped bits, or with a piece of it copied elsewhere in it."""
    size, how = len(data), random.integers(4)
    if how == 0:
        return data[:random.integers(size)]
    found = bytearray(data)
    if how == 1:
        begin, end = random.integers(size, size=2)
        length = random.integers(1, 64)
        found[begin:begin + length] = data[end:end + length]
    for _ in range(random.integers(1, 4) if how > 1 else 0):
        found[random.integers(size)] ^= 1 << int(random.integers(8))
    return bytes(found)


def test_there_are_enough():
    assert sum(counts().values()) == CASES and set(counts()) == set(KINDS)


@pytest.mark.parametrize("name", KINDS)
def test_damaged_files(name, tmp_path):
    kind = KINDS[name]
    if kind.needs and importlib.util.find_spec(kind.needs) is None:
        pytest.skip(f"{kind.needs} reads it")
    warnings.simplefilter("ignore")         # of overflow in matrices that are refused
    path = kind.make(tmp_path)
    whole = {one: one.read_bytes() for one in sorted(tmp_path.iterdir()) if one.is_file()}
    right = kind.read(path)
    random = np.random.default_rng(sum(map(ord, name)))
    outcomes = {"same": 0, "refused": 0, "other": 0}
    for case in range(counts()[name]):
        one = list(whole)[random.integers(len(whole))]
        one.write_bytes(spoilt(whole[one], random))
        try:
            found = kind.read(path)
            outcomes["same" if same(found, right) else "other"] += 1
        except SebodyError as error:
            outcomes["refused"] += 1
            said = str(error)       # of the file, or of an interface that it does not have
            assert (path.stem in said or "node set" in said) and ": " in said, (case, one, said)
        finally:
            one.write_bytes(whole[one])
    assert outcomes["refused"] > outcomes["same"] + outcomes["other"] or not kind.exact
    assert not (kind.exact and outcomes["other"]), outcomes
