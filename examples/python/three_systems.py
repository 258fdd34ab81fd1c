"""S(k) at small k of three systems: no order, a layer of hard spheres, the field model."""
import numpy as np

import grainfield as gf

points = list(np.random.default_rng(1).random((60, 400, 2)) * 25)
layer = gf.simulate_md(grains=625, length_x=25, length_y=25, periods=70, discard=10,
                       snapshot_every=1)
field = gf.simulate_field(nx=64, record=1500, relax=400)

fluctuations = {
    "ideal gas": gf.structure_factor(points, box=(25, 25), boundary="periodic").table(),
    "layer": gf.structure_factor(layer).table(),
}
for name, curve in fluctuations.items():
    print(f"{name}: S = {np.average(curve['s'][:4], weights=curve['n'][:4]):.2f} at small k")

modes = np.abs(np.fft.fft2(field.density[:, 0])) ** 2
low = field.spacing**2 / (64**2) * modes[:, 0, 1:4].mean()
print(f"field: S = {low:.2f} at small k")
