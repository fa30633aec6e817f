# %% [markdown]
# # Mie theory, beside miepython
#
# The figures that miepython's own tests and examples are made of: Wiscombe's MIEV0 test cases and the
# example of Bohren & Huffman. miepython writes n - ik, this package n + ik.

# %%
import matplotlib.pyplot as plt
import numpy as np

import miebrdf

# m (as n - ik), x, then the printed figures: extinction, scattering, asymmetry.
WISCOMBE = [
    (0.75, 0.099, 0.000007, 0.000007, 0.001448),
    (0.75, 0.101, 0.000008, 0.000008, 0.001507),
    (0.75, 10.0, 2.232265, 2.232265, 0.896473),
    (0.75, 1000.0, 1.997908, 1.997908, 0.844944),
    (1.5, 10.0, 2.881999, 2.881999, 0.742913),
    (1.5, 100.0, 2.094388, 2.094388, 0.818246),
    (1.5, 1000.0, 2.013945, 2.013945, 0.827882),
    (1.33 - 1e-5j, 1.0, 0.093952, 0.093923, 0.184517),
    (1.33 - 1e-5j, 100.0, 2.101321, 2.096594, 0.868959),
    (1.33 - 1e-5j, 10000.0, 2.004089, 1.723857, 0.907840),
    (1.5 - 1j, 0.055, 0.101491, 0.000011, 0.000491),
    (1.5 - 1j, 1.0, 2.336321, 0.663454, 0.192136),
    (1.5 - 1j, 100.0, 2.097502, 1.283697, 0.850252),
    (1.5 - 1j, 10000.0, 2.004368, 1.236574, 0.846309),
    (10 - 10j, 1.0, 2.532993, 2.049405, -0.110664),
    (10 - 10j, 100.0, 2.071124, 1.836785, 0.556215),
    (10 - 10j, 10000.0, 2.005914, 1.795393, 0.548194),
]
m, x, *printed = (np.array(column) for column in zip(*WISCOMBE))
sphere = miebrdf.sphere(np.conj(m), x)
for name, figures in zip(("q_ext", "q_sca", "asymmetry"), printed):
    difference = np.abs(getattr(sphere, name) - figures)
    print(f"{name:10} largest difference {difference.max():.1e} of {figures.size} printed figures")
    assert difference.max() <= 1.01e-6  # the last printed digit, rounded or cut

# %% [markdown]
# ## Bohren & Huffman, appendix A
# A sphere of 0.525 um and index 1.55 in light of 632.8 nm: Q_ext 3.10543, Q_back 2.92534, g 0.63314.

# %%
one = miebrdf.sphere(1.55, 2 * np.pi * 0.525 / 0.6328)
print(one)
assert abs(one.q_ext - 3.10543) <= 1e-5
assert abs(one.q_back - 2.92534) <= 1e-5
assert abs(one.asymmetry - 0.63314) <= 1e-5

# %% [markdown]
# ## Extinction over size
# Ripples and the limit 2 for large spheres: one call for all sizes and indices.

# %%
x = np.linspace(0.1, 60, 1500)
indices = np.array([1.33, 1.5, 1.5 + 0.05j])
q_ext = miebrdf.sphere(indices[:, None], x).q_ext
fig, ax = plt.subplots(figsize=(7, 3.5))
for index, curve in zip(indices, q_ext):
    ax.plot(x, curve, lw=0.8, label=f"m = {index:.3g}")
ax.axhline(2, color="0.7", lw=0.8)
ax.set_xlabel("size parameter")
ax.set_ylabel("extinction efficiency")
ax.legend()

# %% [markdown]
# ## Scattered light over the angle
# Perpendicular and parallel to the scattering plane, |S1|^2 and |S2|^2; backwards and forwards both
# agree. The integral over all directions is the scattering efficiency.

# %%
angles = np.linspace(0, 180, 1801)
s1, s2 = miebrdf.amplitudes(1.5, 10, angles)
fig, ax = plt.subplots(figsize=(7, 3.5))
ax.semilogy(angles, np.abs(s1) ** 2, label="|S1|²")
ax.semilogy(angles, np.abs(s2) ** 2, label="|S2|²")
ax.set_xlabel("scattering angle (degrees)")
ax.legend()
assert abs(abs(s1[0]) / abs(s2[0]) - 1) <= 1e-12 and abs(abs(s1[-1]) / abs(s2[-1]) - 1) <= 1e-12
nodes, weights = np.polynomial.legendre.leggauss(200)
s1, s2 = miebrdf.amplitudes(1.5, 10, np.degrees(np.arccos(nodes)))
integral = np.sum(weights * (np.abs(s1) ** 2 + np.abs(s2) ** 2)) / 10**2
print("integral of |S|^2:", integral, "scattering efficiency:", miebrdf.sphere(1.5, 10).q_sca)
assert abs(integral / miebrdf.sphere(1.5, 10).q_sca - 1) <= 1e-12
plt.show()
