#include "pipeline/solve/sampled_spectrum.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>

#include "pipeline/cache/job_key.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/resolver.h"
#include "pipeline/solve/sampled_line.h"
#include "pipeline/solve/size_lattice.h"
#include "pipeline/solve/weighted_optics.h"

namespace miebrdf {
namespace {

/// Of K: where a chord absorbs less, the rest of the optics hardly depends on k.
constexpr double kFaintChord = 0.03;

/// Calls see(index, thickness in um) for the core and its coatings.
template <typename See>
void each_layer(const Particles& at, double radius_um, const See& see) {
    see(at.index, radius_um);
    for (const mie::ParticleCoating& coating : at.coatings)
        see(coating.refractive_index, coating.thickness_um + coating.share_of_radius * radius_um);
}

/// K.
double chord_absorption(const Particles& at, double radius_um) {
    double sum = 0.0;
    each_layer(at, radius_um, [&](std::complex<double> index, double thickness_um) {
        sum += index.imag() * thickness_um;
    });
    return sum * 4e3 * std::numbers::pi * (4.0 / 3.0) / at.wavelength_nm;
}

double size_parameter_of(const Particles& at, double radius_um) {
    return 2e3 * std::numbers::pi * at.host_index * radius_um / at.wavelength_nm;
}

std::vector<double> line_of(const std::vector<Particles>& all, const mie::SizeDistribution& sizes) {
    const double radius_um = sizes.effective_radius_um;
    const double width = std::sqrt(std::log1p(sizes.effective_variance));
    std::vector<double> line{0.0};
    for (std::size_t p = 1; p < all.size(); ++p) {
        const Particles &before = all[p - 1], &at = all[p];
        const double x = size_parameter_of(at, radius_um);
        double squares = std::norm(std::log(x / size_parameter_of(before, radius_um)));
        std::vector<std::complex<double>> indices;
        each_layer(before, radius_um,
                   [&](std::complex<double> index, double) { indices.push_back(index); });
        std::size_t layer = 0;
        each_layer(at, radius_um, [&](std::complex<double> index, double) {
            const std::complex<double> m = index / at.host_index;
            // Contrast below the phase of a radian does not show.
            const double contrast = std::abs(m - 1.0) + 0.5 / x;
            squares += std::norm((m - indices[layer++] / before.host_index) / contrast);
        });
        const double chord = std::log((kFaintChord + chord_absorption(at, radius_um)) /
                                      (kFaintChord + chord_absorption(before, radius_um)));
        // Wavelengths ascend, so that no two places are the same.
        line.push_back(line.back() + std::sqrt(squares / (width * width) + chord * chord));
    }
    return line;
}

/// About which share of a line is computed: 12 to 17 places for each length of 1 of ice and dust,
/// up to 60 where ripple shows (docs/maths-mie.md#many-wavelengths).
double computed_share(const std::vector<double>& line) {
    constexpr double per_length = 20.0;
    return std::min(1.0, per_length * (1.0 + line.back()) / double(line.size()));
}

/// The species at one wavelength of its spectrum.
/// @param sampled  as one of a spectrum, which has a key of its own
ResolvedSpecies at_place(const ResolvedSpecies& species, std::size_t place, bool sampled) {
    const Particles& at = species.spectrum->particles[place];
    ResolvedSpecies one{.species = species.species,
                        .particles = {at},
                        .wavelength_nm = {at.wavelength_nm},
                        .sizes = species.sizes,
                        .effective_radius_um = species.effective_radius_um,
                        .outer_radius_um = species.outer_radius_um};
    if (sampled) one.spectrum = species.spectrum;
    one.key = {species_key(one, 0)};
    return one;
}

mie::EnsembleOptics as_ensemble(const MediumOptics& of) {
    mie::EnsembleOptics optics;
    optics.single_scattering_albedo = of.optics.single_scattering_albedo;
    optics.one_minus_albedo = of.optics.one_minus_albedo;
    optics.q_ext = of.q_ext.value_or(0.0);
    optics.asymmetry = of.asymmetry;
    optics.chi = of.optics.chi;
    return optics;
}

/// Places of the line about so far apart, with both ends.
std::vector<std::size_t> spaced(const std::vector<double>& line, double gap) {
    std::vector<std::size_t> places{0};
    for (std::size_t p = 1; p < line.size(); ++p) {
        const bool is_last = p + 1 == line.size();
        if (is_last || line[p + 1] - line[places.back()] > gap) places.push_back(p);
    }
    return places;
}

/// A spectrum between places that were computed.
class Spectrum {
  public:
    Spectrum(const ResolvedSpecies& species, const OpticsDemand& demand)
        : species_(species),
          demand_(demand),
          line_(line_of(species.spectrum->particles, species.sizes)) {
        for (const Particles& at : species.spectrum->particles)
            absorbed_.push_back(
                -std::expm1(-chord_absorption(at, species.sizes.effective_radius_um)));
    }

    /// Memory that all of it takes.
    std::size_t bytes() const {
        const auto moments = std::size_t(std::max(demand_.highest_moment, 0)) + 1;
        return line_.size() * (sizeof(MediumOptics) + moments * sizeof(double));
    }

    /// Computes what it needs, and puts all of it into the control's memo.
    void sample(const Control& control) const {
        const mie::Executor pieces = pieces_of_job(control);
        const auto compute = [&](const std::vector<std::size_t>& places) {
            std::vector<MediumOptics> all(places.size());
            run_parallel("single scattering", places.size(), control, [&](std::size_t i) {
                const ResolvedSpecies one = at_place(species_, places[i], false);
                all[i] = remembered_optics(control, optics_hash(one, 0, demand_),
                                           [&] { return compute_optics(one, 0, demand_, pieces); });
            });
            return all;
        };
        const auto misfit = [&](const CubicStencil& stencil, std::span<const std::size_t> places,
                                std::span<const MediumOptics> around, std::size_t place,
                                const MediumOptics& computed) {
            return mie::difference_between(as_ensemble(between(stencil, places, around, place)),
                                           as_ensemble(computed)) /
                   demand_.tolerance;
        };
        // First half a width of the law apart, as the sizes of a fine lattice are.
        const auto sampled = sample_line<MediumOptics>(line_, spaced(line_, SizeLattice::kFineStep),
                                                       compute, misfit);
        const double misfit_left = demand_.tolerance * sampled.misfit;
        std::vector<double> known;
        for (const std::size_t place : sampled.places) known.push_back(line_[place]);
        std::size_t next = 0;
        for (std::size_t place = 0; place < line_.size(); ++place) {
            const std::string hash = optics_hash(at_place(species_, place, true), 0, demand_);
            if (sampled.places[next] == place) {
                control.memo->keep(hash, sampled.values[next++]);
                continue;
            }
            const CubicStencil stencil = cubic_at(known, line_[place]);
            MediumOptics optics =
                between(stencil, std::span(sampled.places).subspan(stencil.first, stencil.count),
                        std::span(sampled.values).subspan(stencil.first, stencil.count), place);
            optics.error_estimate += misfit_left;
            control.memo->keep(hash, optics);
        }
    }

  private:
    /// @param places, around  of the stencil
    MediumOptics between(const CubicStencil& stencil, std::span<const std::size_t> places,
                         std::span<const MediumOptics> around, std::size_t place) const {
        const bool all_absorb = absorbed_[place] > 0.0 &&
                                std::all_of(places.begin(), places.end(),
                                            [&](std::size_t p) { return absorbed_[p] > 0.0; });
        std::vector<WeightedOptics> nodes;
        for (std::size_t i = 0; i < stencil.count; ++i)
            nodes.push_back(
                {around[i], stencil.weight[i], all_absorb ? absorbed_[places[i]] : 1.0});
        MediumOptics optics = sum_of(nodes, all_absorb ? absorbed_[place] : 1.0);
        optics.error_estimate = 0.0;
        for (const WeightedOptics& node : nodes)
            optics.error_estimate += std::abs(node.weight) * node.optics.error_estimate;
        optics.converged = optics.converged || optics.error_estimate <= demand_.tolerance;
        return optics;
    }

    const ResolvedSpecies& species_;
    const OpticsDemand& demand_;
    std::vector<double> line_, absorbed_;
};

/// Once for the control's memo: whoever comes meanwhile waits for it.
void sample_spectrum(const Control& control, const ResolvedSpecies& species,
                     const OpticsDemand& demand) {
    const std::lock_guard lock(control.memo->sampling());
    const std::string key =
        JobKey("sampled spectrum").add(optics_hash(at_place(species, 0, true), 0, demand)).hash();
    if (control.memo->find_numbers(key)) return;
    const Spectrum spectrum(species, demand);
    // What does not fit is computed wavelength by wavelength.
    if (2 * spectrum.bytes() > control.memo->free_bytes()) return;
    spectrum.sample(control);
    control.memo->keep_numbers(key, {});
}

}  // namespace

bool is_sampled(const Control& control, const ResolvedSpecies& species,
                const OpticsDemand& demand) {
    return species.spectrum && control.memo != nullptr && !demand.whole_phase_function &&
           !demand.polarisation && demand.angles_deg.empty();
}

bool can_be_sampled(const ResolvedSpecies& species) {
    return species.needs_mie() && has_width(species.sizes);
}

std::shared_ptr<const ParticleSpectrum> spectrum_of(const ResolvedSpecies& all) {
    ParticleSpectrum spectrum{all.particles, {}};
    const auto shorter = [](const Particles& a, const Particles& b) {
        return a.wavelength_nm < b.wavelength_nm;
    };
    const auto is_same = [](const Particles& a, const Particles& b) {
        return a.wavelength_nm == b.wavelength_nm;
    };
    std::vector<Particles>& particles = spectrum.particles;
    std::stable_sort(particles.begin(), particles.end(), shorter);
    particles.erase(std::unique(particles.begin(), particles.end(), is_same), particles.end());
    if (particles.size() <= kMostAveraged || computed_share(line_of(particles, all.sizes)) >= 1.0)
        return {};
    spectrum.hash = JobKey("spectrum").add(particles).hash();
    return std::make_shared<const ParticleSpectrum>(std::move(spectrum));
}

double computed_share(const ResolvedSpecies& species) {
    if (!species.spectrum) return 1.0;
    return computed_share(line_of(species.spectrum->particles, species.sizes));
}

MediumOptics averaged_optics(const Control& control, const ResolvedSpecies& species, std::size_t w,
                             const OpticsDemand& demand, const mie::Executor& run) {
    const std::string hash = optics_hash(species, w, demand);
    if (is_sampled(control, species, demand)) {
        if (const auto known = control.memo->find(hash)) return *known;
        sample_spectrum(control, species, demand);
    }
    return remembered_optics(control, hash,
                             [&] { return compute_optics(species, w, demand, run); });
}

}  // namespace miebrdf
