"""Opens a trajectory as lab scripts do, with MDAnalysis and with h5py, and prints what is in it.

Exit code 77: one of the two is not installed.
"""
import json
import math
import sys
import warnings

warnings.simplefilter("ignore")
try:
    import h5py
    import MDAnalysis
except ImportError as error:
    print(error)
    sys.exit(77)


def number(value):
    return None if math.isnan(value) else float(value)


def table(array):
    return [[number(value) for value in row] for row in array]


path = sys.argv[1]
frames = []
with h5py.File(path) as file:
    particles = file["particles/trajectory"]
    position = particles["position"]
    count = position["value"].shape[1]
    universe = MDAnalysis.Universe.empty(count, trajectory=True)
    # Their reader asks for units unless it is told not to; ours stand under /parameters.
    universe.load_new(path, format="H5MD", convert_units=False)
    for i, timestep in enumerate(universe.trajectory):
        frames.append({
            "step": int(timestep.data["step"]),
            "time": float(timestep.time),
            "box": [float(length) for length in timestep.dimensions],
            "mda": table(timestep.positions),
            "position": table(position["value"][i]),
            "id": [int(name) for name in particles["id/value"][i]],
        })
    content = {
        "version": [int(n) for n in file["h5md"].attrs["version"]],
        "author": file["h5md/author"].attrs["name"].decode()
        if isinstance(file["h5md/author"].attrs["name"], bytes)
        else str(file["h5md/author"].attrs["name"]),
        "top": sorted(file),
        "boundary": [b.decode() if isinstance(b, bytes) else str(b)
                     for b in particles["box"].attrs["boundary"]],
        "dimension": int(particles["box"].attrs["dimension"]),
        "attributes": sorted(position.attrs) + sorted(position["value"].attrs),
        "shared": particles["id/step"] == position["step"]
        and particles["box/edges/time"] == position["time"],
        "checksums": all(particles[name]["value"].fletcher32 for name in particles if name != "box"),
        "columns": sorted(particles),
        "frames": frames,
    }
print(json.dumps(content))
