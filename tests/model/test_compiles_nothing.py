"""A model is built without compiling: kernels are named, and loaded when the model is run."""

import os
import subprocess
import sys

BUILD = """
import sys
import numba.core.dispatcher, numba.core.ccallback
compiled = []
for kind, method in ((numba.core.dispatcher.Dispatcher, "compile"),
                     (numba.core.ccallback.CFunc, "compile")):
    def spied(self, *arguments, method=getattr(kind, method)):
        compiled.append(self)
        return method(self, *arguments)
    setattr(kind, method, spied)
from sebody.model.model import Model
from sebody.fem import Section
before = len(compiled)
model = Model()
base, tip = model.node("base", (0, 0, 0)), model.node("tip", (1.0, 0, 0))
section = Section(area=4e-4, inertia_y=1.33e-8, inertia_z=1.33e-8, torsion=2.25e-8,
                  youngs_modulus=2.1e11, poisson_ratio=0.3, density=7800.0)
model.beam("beam", (base, tip), section, 4, 2, modes=2)
model.rigid_body("weight", "tip", 2.0, (0.1, 0.2, 0.2))
model.revolute(base, name="hinge")
model.drive_angle(base, [(0.0, 0.0), (1.0, 0.5)])
model.force(tip, (0, 0, 1), [(0.0, 0.0), (1.0, 3.0)])
model.spring(base, tip, 3.0)
kernels = [m for m in sys.modules if m.startswith("sebody.generated.") and "element_" in m]
print(len(compiled) - before, kernels, model.element("beam 1").kernel)
"""


def test_building_a_model_compiles_nothing(tmp_path):
    done = subprocess.run([sys.executable, "-c", BUILD], capture_output=True, text=True, check=True,
                          env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)})
    assert done.stdout.split() == ["0", "[]", "superelement_f2_converged_mean_floating_field"]
