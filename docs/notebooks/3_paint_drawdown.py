# %% [markdown]
# # A paint drawdown
#
# White paint over a card that is half black and half white: how well it hides, as a function of its
# thickness, and what Kubelka and Munk's two fluxes make of it.

# %%
import matplotlib.pyplot as plt
import numpy as np

import miebrdf

WHITE = 0.8  # of the card
thickness_um = np.array([5.0, 10.0, 20.0, 40.0, 80.0, 160.0])
nm = np.arange(420.0, 681.0, 20.0)


def film(ground: float, thickness: float, volume: float = 0.05) -> miebrdf.Scene:
    """Rutile of 0.13 um in a binder of index 1.5, by volume."""
    return miebrdf.Scene(
        substrate=ground,
        coats=[
            miebrdf.coat(
                "TiO2", thickness_um=thickness, radius_um=0.13, variance=0.1, volume=volume
            )
        ],
        host=1.5,
    )


# %% [markdown]
# ## Contrast ratio
# The ratio of the luminous reflectances Y over black and over white; from 0.98 on a paint is said to
# hide. Reflectances are those of diffuse light.

# %%
over = {
    ground: np.array([np.asarray(film(ground, t).albedo(nm)) for t in thickness_um])
    for ground in (0.0, WHITE)
}
luminous = {ground: miebrdf.colour.xyz(values.T, nm)[:, 1] for ground, values in over.items()}
contrast = luminous[0.0] / luminous[WHITE]
for t, ratio in zip(thickness_um, contrast):
    print(f"{t:5g} um: contrast ratio {ratio:.3f}")
assert np.all(np.diff(contrast) > 0) and 0 < contrast[0] < contrast[-1] <= 1

# %% [markdown]
# ## Kubelka and Munk beside it
# K and S of the layer follow from its optics (K = 2 mu_a, S = 3/4 mu_s' - 1/4 mu_a); a film of
# thickness X on a ground of reflectance G reflects
#
# R = (1 - G (a - b coth bSX)) / (a - G + b coth bSX), a = 1 + K/S, b = sqrt(a^2 - 1).


# %%
def kubelka_munk(k: float, s: float, x: float, ground: float) -> float:
    a = 1 + k / s
    b = np.sqrt(a * a - 1)
    if b * s * x < 1e-8:  # nothing absorbed: coth(z) = 1/z
        return (ground + s * x * (1 - ground)) / (1 + s * x * (1 - ground))
    c = b / np.tanh(b * s * x)
    return (1 - ground * (a - c)) / (a - ground + c)


layers = {t: film(0.0, t).layers(nm) for t in thickness_um}
two_fluxes = {
    ground: np.array(
        [[kubelka_munk(o["k_km"], o["s_km"], t, ground) for o in layers[t]] for t in thickness_um]
    )
    for ground in (0.0, WHITE)
}
km_luminous = {g: miebrdf.colour.xyz(v.T, nm)[:, 1] for g, v in two_fluxes.items()}

fig, axes = plt.subplots(1, 2, figsize=(10, 4))
for ground, colour in ((0.0, "k"), (WHITE, "tab:orange")):
    axes[0].plot(thickness_um, luminous[ground], colour, label=f"on {ground:g}")
    axes[0].plot(thickness_um, km_luminous[ground], colour, ls="--", label="Kubelka-Munk")
axes[0].set_ylabel("luminous reflectance Y")
axes[1].plot(thickness_um, contrast, "k", label="radiative transfer")
axes[1].plot(thickness_um, km_luminous[0.0] / km_luminous[WHITE], "k--", label="Kubelka-Munk")
axes[1].axhline(0.98, color="0.7")
axes[1].set_ylabel("contrast ratio")
for ax in axes:
    ax.set_xscale("log")
    ax.set_xlabel("thickness (µm)")
    ax.legend(fontsize=8)
# For white films of diffuse light the two fluxes are a good theory.
difference = np.abs(two_fluxes[0.0] - over[0.0])
print(f"largest difference over black: {difference.max():.3f}")
assert difference.max() <= 0.08

# %% [markdown]
# ## The card
# As it looks under D65: each film over the black and the white half.

# %%
card = np.zeros((2, thickness_um.size, 3))
for row, ground in enumerate((0.0, WHITE)):
    card[row] = miebrdf.colour.srgb(over[ground].T, nm)
fig, ax = plt.subplots(figsize=(6, 2.2))
ax.imshow(card, aspect="auto")
ax.set_xticks(
    range(thickness_um.size), [f"{t:g} µm\n{c:.2f}" for t, c in zip(thickness_um, contrast)]
)
ax.set_yticks([0, 1], ["black", "white"])
ax.set_title("thickness and contrast ratio", fontsize=9)
plt.show()
