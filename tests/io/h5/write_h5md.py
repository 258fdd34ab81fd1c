"""Writes a trajectory with MDAnalysis, as a simulation from elsewhere would come.

Exit code 77: MDAnalysis is not installed.
"""
import sys
import warnings

warnings.simplefilter("ignore")
try:
    import MDAnalysis
    import numpy
except ImportError as error:
    print(error)
    sys.exit(77)

universe = MDAnalysis.Universe.empty(3, trajectory=True, velocities=True)
with MDAnalysis.Writer(sys.argv[1], n_atoms=3, format="H5MD", convert_units=False, positions=True,
                       velocities=True, forces=False, timeunit="ps", lengthunit="nm",
                       velocityunit="nm/ps") as writer:
    for frame in range(4):
        timestep = universe.trajectory.ts
        timestep.frame = frame
        timestep.data["step"] = 10 * frame
        timestep.time = frame / 4
        timestep.dimensions = [8, 9, 10, 90, 90, 90]
        timestep.positions = numpy.arange(9).reshape(3, 3) + frame / 2
        timestep.velocities = numpy.full((3, 3), frame)
        writer.write(universe)
