"""Variants of a model: changed copies, each with a sentence that says what was changed.

The model stays as it is, and its copy shares nothing with it that can change.

| variant | what it changes |
|---|---|
| `keep_modes` | how many internal modes a superelement has |
| `rigid` | a superelement into a rigid body |
| `divide` | how many superelements a beam has |
| `with_options` | frame, inertia and stiffening of a superelement |
| `drop_triplet` | a position or rotation that only a superelement has into one that follows |
| `shared` | equations of a joint into shared or fixed positions and rotations |
| `planar` | a model that is symmetric about a plane into a planar one |
"""

from sebody.model.variants.copying import Variant, copied
from sebody.model.variants.division import divide
from sebody.model.variants.dropping import can_be_dropped, drop_triplet
from sebody.model.variants.modes import keep_modes
from sebody.model.variants.options import with_options
from sebody.model.variants.planar import planar
from sebody.model.variants.rigid import rigid
from sebody.model.variants.sharing import can_be_shared, shared

# of a model and the name of one of its bodies, beams or joints
VARIANTS = {"modes": keep_modes, "rigid": rigid, "divided": divide, "options": with_options,
            "dropped": drop_triplet, "shared": shared}

__all__ = ["VARIANTS", "Variant", "can_be_dropped", "can_be_shared", "copied", "divide",
           "drop_triplet", "keep_modes", "planar", "rigid", "shared", "with_options"]
