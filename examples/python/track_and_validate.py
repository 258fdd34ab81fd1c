"""A film of a simulated layer, tracked, and scored against the truth."""
import numpy as np

import grainfield as gf

layer = gf.simulate_md(grains=300, length_x=20, length_y=20, periods=12, discard=10,
                       snapshot_every=0.1, sides_x="walls", sides_y="walls")
film = gf.render(layer, "noisy", width=320, height=320)
tracks = gf.track(film.frames, fps=50)

errors, missed, true = [], 0, 0
for found, truth in zip(tracks, film.truth, strict=True):
    places = truth["position"]
    places = places[((places > 10) & (places < 309)).all(axis=1)]
    distance = np.linalg.norm(places[:, None] - found["position"][None], axis=2).min(axis=1)
    errors.extend(distance[distance < 4])
    missed += (distance >= 4).sum()
    true += len(places)
print(f"{true} spheres, {missed} missed, median error {np.median(errors):.3f} px")
