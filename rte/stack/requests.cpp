// Validation, and the parts that reflections, albedos and derivatives have in common.
#include "rte/stack/layered_reflection.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include "rte/first_order/beams.h"

namespace miebrdf::rte {
namespace {

// A list that was cut short (has_more_moments) is not padded: its further moments are unknown.
void pad_moments(Optics& optics) {
    if (!optics.polarisation || optics.has_more_moments) return;
    std::size_t count = optics.chi.size();
    for (const auto& [name, list] : kMatrixLists)
        count = std::max(count, ((*optics.polarisation).*list).size());
    optics.chi.resize(count, 0.0);
}

}  // namespace

void require_cosines(const std::vector<double>& cosines, const char* field) {
    for (const double mu : cosines) {
        if (!(mu > 0.0 && mu <= 1.0)) throw UsageError(field, mu, "(0, 1]");
    }
}

void validate(const Directions& directions) {
    require_cosines(directions.mu_in, "mu_in");
    require_cosines(directions.mu_out, "mu_out");
    for (const double azimuth : directions.azimuth_deg) {
        if (!(azimuth >= -360.0 && azimuth <= 360.0))
            throw UsageError("azimuth_deg", azimuth, "[-360, 360]");
    }
}

void validate(const SolverOptions& options) {
    if (!(options.tolerance > 0.0 && options.tolerance < 1.0)) {
        throw UsageError("tolerance", options.tolerance, "(0, 1)");
    }
    if (!(options.streams == 0 ||
          (options.streams >= kFewestNodes && options.streams <= kMostNodes))) {
        throw UsageError(
            "streams", options.streams,
            fmt::format("{} to {}, or 0 to choose from the tolerance", kFewestNodes, kMostNodes));
    }
    if (!(options.coat_substeps >= 1 && options.coat_substeps <= 1000000)) {
        throw UsageError("coat_substeps", options.coat_substeps, "1 to 1000000");
    }
    const int stokes = options.stokes;
    if (!(stokes == 0 || stokes == 1 || stokes == 3 || stokes == 4))
        throw UsageError("stokes", stokes, "1, 3 or 4, or 0: as many as matter");
}

void require_polarisable(const Stack& stack, const SolverOptions& options) {
    if (options.half_space_method != HalfSpaceMethod::automatic ||
        options.coat_method != CoatMethod::automatic) {
        throw UsageError("polarised light is solved by the automatic methods alone");
    }
    if (stack.boundary && stack.boundary->is_rough()) {
        throw UsageError(
            "polarised light: rough boundaries are not available (their facets turn the plane of "
            "polarisation); take a smooth one (roughness 0), or solve without polarisation");
    }
}

Stack with_all_moments(Stack stack) {
    if (stack.base_kind == BaseKind::half_space) pad_moments(stack.base);
    for (Coat& coat : stack.coats) pad_moments(coat.optics);
    return stack;
}

void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, ScaledStack& exact,
                              std::vector<double>& reflectances) {
    reflectances.clear();
    if (!stack.boundary && lowest_kind(stack) != BaseKind::mirror) return;
    scale_stack(stack, 1, false, exact);
    if (exact.top_index == 1.0 && !exact.has_mirrors()) return;
    if (exact.boundary && exact.boundary->is_rough()) return;
    for (const double mu : mu_in) {
        if (light.components == 1) {
            reflectances.push_back(mirror_reflection<double>(exact, mu));
            continue;
        }
        const Eigen::Matrix4d M = mueller_of(mirror_reflection<FresnelMatrix>(exact, mu));
        for (int element = 0, c = light.shown(); element < c * c; ++element)
            reflectances.push_back(M(element / c, element % c));
    }
}

void find_unscattered(const Stack& stack, const std::vector<double>& mu_in, int components,
                      ScaledStack& exact, std::vector<double>& shares) {
    shares.assign(mu_in.size(), 0.0);
    if (lowest_kind(stack) == BaseKind::half_space) return;
    scale_stack(stack, 1, false, exact);
    if (exact.boundary && exact.boundary->is_rough()) return;  // facets turn all of it
    for (std::size_t i = 0; i < mu_in.size(); ++i)
        shares[i] = components == 1
                        ? straight_transmission<double>(exact, mu_in[i])
                        : mueller_of(straight_transmission<FresnelMatrix>(exact, mu_in[i]))(0, 0);
}

std::vector<double> elements_last(std::vector<double> values, std::size_t elements,
                                  std::size_t azimuths) {
    if (elements == 1) return values;
    std::vector<double> result(values.size());
    const std::size_t block = elements * azimuths;
    for (std::size_t first = 0; first < values.size(); first += block) {
        for (std::size_t e = 0; e < elements; ++e)
            for (std::size_t a = 0; a < azimuths; ++a)
                result[first + a * elements + e] = values[first + e * azimuths + a];
    }
    return result;
}

}  // namespace miebrdf::rte
