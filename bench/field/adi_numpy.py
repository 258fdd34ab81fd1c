#!/usr/bin/python3
"""The published scheme in numpy and scipy (Debian's), 512 x 512, for comparison with bench.field.step.

    /usr/bin/python3 bench/field/adi_numpy.py [cells] [steps]

psi by spectral Crank-Nicolson, rho by ADI with scipy.linalg.solve_banded over all lines at once where
the matrix is the same, line by line here because D varies, and Sherman-Morrison for the ring.
"""

import sys
import time

import numpy
import scipy
from scipy.linalg import solve_banded

n = int(sys.argv[1]) if len(sys.argv) > 1 else 512
steps = int(sys.argv[2]) if len(sys.argv) > 2 else 3
dx, dt, nu = 0.65, 0.05, 0.01
random = numpy.random.default_rng(1)
k = 2 * numpy.pi * numpy.fft.fftfreq(n, dx)
k2 = k[:, None] ** 2 + (k[None, : n // 2 + 1]) ** 2
g = (nu + k2**2) * dt / 2
psi = numpy.zeros((n, n))
rho = numpy.zeros((n, n))
h = dt / (4 * dx * dx)


def explicit(rho, d, axis):
    right = numpy.roll(d, -1, axis) + d
    flux = right * (numpy.roll(rho, -1, axis) - rho)
    return h * (flux - numpy.roll(flux, 1, axis))


def implicit(rhs, d):
    """Rings along the last axis: all lines as one long banded system."""
    right = h * (numpy.roll(d, -1, 1) + d)
    left = numpy.roll(right, 1, 1)
    diagonal = 1 + left + right
    gamma = -diagonal[:, 0].copy()
    corner = -left[:, 0].copy()
    diagonal[:, 0] -= gamma
    diagonal[:, -1] -= corner**2 / gamma
    bands = numpy.zeros((3, n * n))
    upper = -right.copy()
    upper[:, -1] = 0
    lower = -left.copy()
    lower[:, 0] = 0
    bands[0, 1:] = upper.ravel()[:-1]
    bands[1] = diagonal.ravel()
    bands[2, :-1] = lower.ravel()[1:]
    u = numpy.zeros((n, n))
    u[:, 0] = gamma
    u[:, -1] = corner
    q, z = solve_banded((1, 1), bands, numpy.stack([rhs.ravel(), u.ravel()], 1)).T.reshape(2, n, n)
    f = (q[:, 0] + corner / gamma * q[:, -1]) / (1 + z[:, 0] + corner / gamma * z[:, -1])
    return q - f[:, None] * z


def step(psi, rho):
    d = numpy.exp(-(psi**2))
    s = numpy.sqrt(dt) / dx / dx
    fx, fy = s * random.standard_normal((2, n, n))
    kick = 0.5 * (fx - numpy.roll(fx, 1, 1) + fy - numpy.roll(fy, 1, 0))
    rho = implicit(rho + kick + explicit(rho, d, 0), d)
    rho = implicit((rho + kick + explicit(rho, d, 1)).T.copy(), d.T.copy()).T
    noise = numpy.fft.rfft2(numpy.sqrt(dt) / dx * random.standard_normal((n, n)))
    psi = numpy.fft.irfft2(((1 - g) * numpy.fft.rfft2(psi) + noise) / (1 + g), s=(n, n))
    return psi, rho


psi, rho = step(psi, rho)
times = []
for _ in range(steps):
    start = time.perf_counter()
    psi, rho = step(psi, rho)
    times.append(1e3 * (time.perf_counter() - start))
print(f"numpy {numpy.__version__}, scipy {scipy.__version__}: {numpy.median(times):.1f} ms a step")
