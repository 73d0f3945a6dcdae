"""Variants of a model: changed copies, each with a sentence that says what was changed.

The model stays as it is, and its copy shares nothing with it that can change.

| variant | what it changes |
|---|---|
| `keep_modes` | how many internal modes a superelement has |
| `rigid` | a superelement into a rigid body |
| `divide` | how many superelements a beam has |
| `with_options` | frame, inertia and stiffening of a superelement |
| `planar` | a model that is symmetric about a plane into a planar one |
"""

from sebody.model.variants.copying import Variant, copied
from sebody.model.variants.division import divide
from sebody.model.variants.modes import keep_modes
from sebody.model.variants.options import with_options
from sebody.model.variants.planar import planar
from sebody.model.variants.rigid import rigid

# of a model and the name of one of its bodies or beams
VARIANTS = {"modes": keep_modes, "rigid": rigid, "divided": divide, "options": with_options}

__all__ = ["VARIANTS", "Variant", "copied", "divide", "keep_modes", "planar", "rigid",
           "with_options"]
