"""A pin that bends.

Line load along the pin of a clevis, beside the uniform one. [The
page](../how-to/a-pin-that-bends.md) says how accurate it is.
"""

import cylcontact as cc

steel = cc.Material.named("high-strength steel")
eye, cheek = (cc.joint.Plate(t, steel, 15.02) for t in (20.0, 10.0))
clevis = cc.joint.Clevis(steel, 15.0, eye, cheek, gap=1.0)
check = cc.joint.check_clevis(clevis, 10e3)
axes = check.plot()
axes.figure.set_size_inches(6, 4)
axes.figure.savefig("clevis.png", dpi=80)
