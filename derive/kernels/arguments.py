"""The arguments of every kernel, as arrays; see `sebody.contract.layout`."""

from sebody.contract import layout
from sebody.derive.form.arrays import pointed
from sebody.derive.form.counts import count, stride, task, width

SIZES = task, count, stride, width
ARGUMENTS = {name: pointed(name, whole=kind == "int64") for name, kind, _ in layout.ARGUMENTS}
