#include "mie/ensemble/particle_ensemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <miebrdf/error.h>
#include "mie/ensemble/size_refinement.h"

namespace miebrdf::mie {

double tail_for(const EnsembleRequest& request) {
    if (SizeLaw::of(request.sizes.kind).has_ends) return 0;
    return std::clamp(0.02 * request.tolerance, 1e-16, 1e-6);
}

namespace {

void require_index(std::complex<double> index, double host_index) {
    const double n = index.real(), k = index.imag();
    if (!(n / host_index >= 0.01 && n / host_index <= 100 && k >= 0 && k <= 1e3)) {
        throw UsageError("refractive_index", fmt::format("{} + {}i", n, k),
                         "n over host_index in [0.01, 100], k in [0, 1000]");
    }
}

// Beyond that, corrections for the shape and tables of scattering serve.
void require_spheroids(const EnsembleRequest& r) {
    if (!(*r.aspect >= kLeastSpheroidAspect && *r.aspect <= kMostSpheroidAspect)) {
        throw UsageError("aspect", *r.aspect,
                         fmt::format("{} to {} (equatorial over polar axis)", kLeastSpheroidAspect,
                                     kMostSpheroidAspect));
    }
    if (!r.coatings.empty())
        throw UsageError("spheroids by the T-matrix have no coatings; leave one of both out");
    const Ensemble ensemble = ensemble_of(r);
    const double largest = ensemble.scatterer.outer_x(ensemble.largest_x());
    if (largest <= kLargestSpheroid) return;
    throw UsageError("size parameter of the larger axis of the spheroids",
                     fmt::format("{:.4g}", largest),
                     fmt::format("up to {:g} by the T-matrix; for larger ones take the corrections "
                                 "for the shape (without method=t-matrix), or a file of scattering",
                                 kLargestSpheroid));
}

}  // namespace

void validate(const EnsembleRequest& r) {
    if (!(r.host_index >= 0.1 && r.host_index <= 10)) {
        throw UsageError("host_index", r.host_index, "0.1 to 10");
    }
    if (!(r.wavelength_nm > 0 && std::isfinite(r.wavelength_nm))) {
        throw UsageError("wavelength_nm", r.wavelength_nm, "positive and finite");
    }
    if (!(r.tolerance > 0 && r.tolerance < 1)) {
        throw UsageError("tolerance", r.tolerance, "(0, 1)");
    }
    if (!(r.phase_floor >= 0)) throw UsageError("phase_floor", r.phase_floor, "0 or above");
    if (!(r.phase_tolerance > 0)) {
        throw UsageError("phase_tolerance", r.phase_tolerance, "above 0");
    }
    if (!(r.table_tolerance > 0)) {
        throw UsageError("table_tolerance", r.table_tolerance, "above 0");
    }
    if (!(r.highest_moment >= -1 && r.highest_moment <= 100000)) {
        throw UsageError("highest_moment", r.highest_moment, "-1 (none) to 100000");
    }
    require_index(r.refractive_index, r.host_index);
    if (r.aspect) require_spheroids(r);
    for (const ParticleCoating& coating : r.coatings) {
        require_index(coating.refractive_index, r.host_index);
        for (const double size : {coating.thickness_um, coating.share_of_radius}) {
            if (!(size >= 0 && std::isfinite(size)))
                throw UsageError("coating's thickness", size, "0 or above");
        }
    }
}

namespace {

// Of P at one of the angles.
double allowed_error(const EnsembleRequest& request, std::size_t angle, double phase) {
    if (!request.phase_allowed.empty()) return request.phase_allowed[angle];
    return request.phase_tolerance * std::max(phase, request.phase_floor);
}

}  // namespace

bool may_be_single(const Ensemble& ensemble, double tolerance) {
    return !ensemble.law().single_size &&
           ensemble.scatterer.outer_x(ensemble.largest_x()) >= SizeRule::kSmallSphere &&
           stated_error(0, tolerance) >= AverageLimits::kSingleError;
}

PhaseValues with_stated_errors(PhaseValues values, const EnsembleRequest& request) {
    if (SizeLaw::of(request.sizes.kind).single_size) return values;
    for (std::size_t i = 0; i < values.error.size(); ++i)
        values.error[i] = stated_error(values.error[i], allowed_error(request, i, values.phase[i]));
    return values;
}

void put_phase(PhaseValues values, const EnsembleRequest& request, EnsembleOptics& optics) {
    optics.phase = std::move(values.phase);
    optics.phase_error = std::move(values.error);
    for (std::size_t i = 0; i < optics.phase.size(); ++i) {
        optics.phase_error_estimate =
            std::max({optics.phase_error_estimate, optics.phase_error[i] / optics.phase[i],
                      AverageLimits::kRounding});
        optics.converged =
            optics.converged && optics.phase_error[i] <= allowed_error(request, i, optics.phase[i]);
    }
}

double Ensemble::finest_angle() const { return std::numbers::pi / scatterer.outer_x(largest_x()); }

double wave_number_per_um(const EnsembleRequest& request) {
    return 2 * std::numbers::pi * request.host_index / (request.wavelength_nm * 1e-3);
}

Ensemble ensemble_of(const EnsembleRequest& request) {
    const double k = wave_number_per_um(request), tail = tail_for(request);
    RadiusRange range =
        tail > 0 ? radius_range(request.sizes, tail, 1 / k) : radius_range(request.sizes);
    // Few large spheres have much of the forward peak: of a log-normal law of variance 0.8, a
    // millionth of the scattering is 1.5 % of it. What is left out of it is the least error stated,
    // but within pi / x, 0.1 degrees, of straight on of those too large for scattering matrices.
    const double forward =
        SizeLaw::of(request.sizes.kind)
            .forward_radius_um(request.sizes, stated_error(0, request.tolerance));
    const double most = (1 - AverageLimits::kRounding) * kLargestMatrixSphere / k;
    if (!request.aspect) range.largest_um = std::max(range.largest_um, std::min(forward, most));
    Scatterer scatterer = request.refractive_index / request.host_index;
    scatterer.aspect = request.aspect.value_or(1.0);
    for (const ParticleCoating& coating : request.coatings)
        scatterer.coatings.push_back({coating.refractive_index / request.host_index,
                                      k * coating.thickness_um, coating.share_of_radius});
    return {std::move(scatterer), request.sizes, range, area_share_within(request.sizes, range), k};
}

void require_angles(const std::vector<double>& angles_deg) {
    for (const double angle : angles_deg) {
        if (!(angle >= 0 && angle <= 180)) throw UsageError("angle_deg", angle, "0 to 180");
    }
}

double similar_absorption(const EnsembleOptics& optics) {
    return optics.one_minus_albedo /
           (1 - optics.single_scattering_albedo * std::min(optics.asymmetry, 1.0));
}

double half_space_albedo(const EnsembleOptics& optics) {
    const double s = std::sqrt(std::clamp(similar_absorption(optics), 0.0, 1.0));
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

double wanted_error(const EnsembleRequest& request, const EnsembleOptics& optics) {
    if (!(request.phase_floor > 0)) return request.tolerance;
    const double share = std::pow(half_space_albedo(optics) / DarkMedium::kDark, 2);
    return std::clamp(share, DarkMedium::kLeastShare, 1.0) * request.tolerance;
}

}  // namespace miebrdf::mie
