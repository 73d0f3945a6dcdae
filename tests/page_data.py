"""Reading of the data of an animation's page, as its scripts read it, without a browser."""

import base64
import json
import re
import zlib

import numpy as np


class PageData:
    """Header and numbers of a page, written from the description in blocks.py."""

    def __init__(self, text):
        def script(name):
            return re.search(f'<script type="[^"]*" id="{name}">(.*?)</script>', text, re.S)[1]
        self.header = json.loads(script("header"))
        self.bytes = np.frombuffer(zlib.decompress(base64.b64decode(script("numbers"))), "u1")

    def values(self, block):
        """Values (rows, columns) of a block."""
        rows, columns = block["shape"]
        found = np.tile(np.array(block["low"], dtype=float), (rows, 1)).reshape(rows, columns)
        varying = block["varying"]
        whole = whole_numbers(self.bytes, block, rows, len(varying))
        found[:, varying] += np.array(block["step"]) * whole
        return found

    def indices(self, block):
        """Whole numbers of a block."""
        return whole_numbers(self.bytes, block, block["count"], 1)[:, 0]

    def vectors(self, block):
        """Values of stations (n, 3), stored all x before all y."""
        return self.values(block).reshape(3, -1).T


def whole_numbers(content, block, rows, columns):
    """Numbers (rows, columns) from their differences, low bytes before high ones."""
    count, width = rows * columns, block["bytes"]
    planes = content[block["at"]:block["at"] + count * width].reshape(width, count).astype(int)
    plain = sum(plane << 8 * k for k, plane in enumerate(planes))
    steps = (plain >> 1) ^ -(plain & 1)
    whole = np.cumsum(steps.reshape(columns, rows), axis=1) % (1 << 8 * width)
    return whole.T
