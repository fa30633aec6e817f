// What the solver asks of media that bring their own optics, in place of spheres and Mie theory.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/sizes.h>

#include <functional>
#include <optional>
#include <utility>

namespace miebrdf {

/// The data of one kind of medium, and what follows from them. A new kind derives from it in a file
/// of its own and is made by its entry in medium_kinds().
class GivenMedium {
  public:
    virtual ~GivenMedium() = default;

    /// @throws InputError  for a vacuum wavelength that the data do not cover
    virtual rte::Optics optics(double wavelength_nm) const = 0;

    /// Fourier orders of radiative transfer that it has at most; 0: not known.
    virtual int most_fourier_orders() const { return 0; }

    // Of kinds with an extinction (MediumKind::has_extinction). A layer of which they fill the
    // share f extinguishes 3 f Q / (4 r) per um, as spheres do: of media whose extinction is known
    // without a size Q is the extinction per um of f = 1, and r is kNoRadiusUm.
    static constexpr double kNoRadiusUm = 0.75;

    /// Q.
    virtual double extinction(double) const { return 0.0; }
    /// r, the effective radius.
    virtual double radius_um(double) const { return kNoRadiusUm; }
    /// The sizes that words say; empty: the medium has none.
    virtual std::optional<mie::SizeDistribution> sizes() const { return std::nullopt; }
    /// Of what fills f, where the data tell it.
    virtual std::optional<double> density_g_cm3() const { return std::nullopt; }
    /// f of so many particles in a um3. @throws UsageError  where that is not known
    virtual double share_of_number(double per_um3, double) const { return per_um3; }
};

/// A medium whose optics are a formula.
class FormulaMedium : public GivenMedium {
  public:
    explicit FormulaMedium(std::function<rte::Optics(double wavelength_nm)> optics, int orders = 0)
        : optics_(std::move(optics)), orders_(orders) {}

    rte::Optics optics(double wavelength_nm) const override { return optics_(wavelength_nm); }
    int most_fourier_orders() const override { return orders_; }

  private:
    std::function<rte::Optics(double wavelength_nm)> optics_;
    int orders_ = 0;
};

}  // namespace miebrdf
