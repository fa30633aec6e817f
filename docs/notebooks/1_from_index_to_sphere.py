# %% [markdown]
# # From n and k to a lit sphere
#
# Gold particles of 30 nm in a thin coat on rutile paint: the refractive indices, single scattering,
# the spectral BRDF, its colour, and a picture. Everything is computed from n + ik.

# %%
import matplotlib.pyplot as plt
import numpy as np

import miebrdf

nm = np.arange(400.0, 701.0, 20.0)
gold, rutile = miebrdf.materials["Au"], miebrdf.materials["TiO2"]
fig, axes = plt.subplots(1, 2, figsize=(9, 3))
for ax, material in zip(axes, (gold, rutile)):
    material.plot(ax).set(xlim=(380, 720), ylim=(0, 5))
print(gold, rutile, sep="\n")

# %% [markdown]
# ## Single scattering
# Mie theory, averaged over a power law of radii. The peak of gold's extinction is its plasmon
# resonance; it is what makes the coat coloured.

# %%
optics = miebrdf.ensemble(gold, nm, radius_um=0.03, variance=0.1, host_index=1.5)
fig, ax = plt.subplots(figsize=(5, 3))
ax.plot(nm, optics.q_ext, label="extinction efficiency")
ax.plot(nm, optics.single_scattering_albedo, label="single-scattering albedo")
ax.set_xlabel("wavelength in vacuum (nm)")
ax.legend()
peak = nm[np.argmax(optics.q_ext)]
assert 500 <= peak <= 560, peak  # gold spheres in glass or polymer absorb green light

# %% [markdown]
# ## The scene, solved
# The optical depth of the coat is given at 550 nm and follows the extinction elsewhere.

# %%
scene = miebrdf.Scene(
    base=miebrdf.medium("TiO2", radius_um=0.15),
    coats=[miebrdf.coat("Au", depth=0.5, radius_um=0.03, variance=0.1)],
    host=1.5,
)
b = scene.solve(nm, tolerance=1e-2)
fig, ax = plt.subplots(figsize=(5, 4), subplot_kw={"projection": "polar"})
b.plot_lobe(theta_in_deg=45, ax=ax)
print(b.report.summary)

# %% [markdown]
# ## Physics: the albedo is the integral of the BRDF
# 20000 directions drawn by importance sampling estimate the same number that the solver gives.

# %%
u = np.random.default_rng(1).random((2, 20000))
mu_out, azimuth_deg, pdf = b.sample(0.7, *u)
estimate = np.asarray(b(0.7, mu_out, azimuth_deg)) * mu_out / pdf
albedo = np.asarray(b.albedo(0.7))
print("largest difference:", np.max(np.abs(estimate.mean(axis=1) - albedo)))
assert np.max(np.abs(estimate.mean(axis=1) - albedo)) <= 0.01

# %% [markdown]
# ## A sphere in parallel light
# Each pixel has a normal, two cosines and an azimuth; the BRDF is asked for all pixels at once.
# Spectra become colours under D65 for the CIE 1931 observer.

# %%
size = 160
x, y = np.meshgrid(*(np.linspace(-1.05, 1.05, size),) * 2)
inside = x**2 + y**2 < 1
normal = np.stack([x, -y, np.sqrt(np.where(inside, 1 - x**2 - y**2, 0.0))], axis=-1)
light, viewer = np.array([0.48, 0.6, 0.64]), np.array([0.0, 0.0, 1.0])
mu_in, mu_out = normal @ light, normal @ viewer
lit = inside & (mu_in > 1e-3) & (mu_out > 1e-3)
# Azimuth 0 is the mirror side: the viewer opposite to the light.
along = light @ viewer - mu_in * mu_out
across = normal @ np.cross(light, viewer)
azimuth_deg = np.degrees(np.arctan2(across, -along))
values = np.asarray(b(mu_in[lit], mu_out[lit], azimuth_deg[lit]))

radiance = np.zeros((nm.size, size, size))
radiance[:, lit] = values * np.pi * mu_in[lit]
picture = miebrdf.colour.srgb(radiance, nm)
fig, ax = plt.subplots(figsize=(3.5, 3.5))
ax.imshow(picture)
ax.axis("off")
ax.set_title(str(scene), fontsize=7)
red, green, blue = picture[size // 3, int(size * 0.62)]
print(f"sRGB of a lit pixel: {red:.2f} {green:.2f} {blue:.2f}")
assert red > green  # the plasmon took the green
plt.show()
