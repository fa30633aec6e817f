// Errors of radiative transfer, against many more nodes at a tolerance of 1e-7: as
// ensemble_battery has them for averages over sizes.
//
//     transfer_battery TRUTH [PART...]     PART: media, coats, smooth, rough, spheres
//
// TRUTH is a file that holds the reference; it is made if it is not there (minutes).
#include <miebrdf/ensemble.h>
#include <miebrdf/transfer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tools/constants/tally.h"
#include "tools/stress/dice.h"
#include "tools/stress/random_media.h"

namespace {

using namespace miebrdf;
using constants::Tally;
using stress::Dice;

struct Case {
    rte::Stack stack;
    rte::Directions directions;
};

struct Part {
    std::string name;
    std::vector<double> tolerances;
    std::vector<Case> cases;
};

// Reflections, then albedos at mu_in and of uniform light, and transmittances.
struct Values {
    std::vector<double> reflection, albedos, errors;
    double albedo_error = 0;
};

rte::Optics two_lobes(Dice& dice) {
    const double albedo = stress::random_albedo(dice), share = dice.uniform(0.5, 1);
    return rte::mix({{rte::henyey_greenstein_optics(albedo, dice.uniform(0.5, 0.97)), share},
                     {rte::henyey_greenstein_optics(albedo, dice.uniform(-0.7, 0.3)), 1 - share}});
}

rte::Optics random_medium(Dice& dice) {
    return dice.chance(0.5) ? two_lobes(dice) : stress::random_smooth(dice);
}

// Bows, glories and narrow peaks of spheres.
rte::Optics random_spheres(Dice& dice) {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = dice.logarithmic(0.3, 12);
    request.sizes.effective_variance = dice.uniform(0.03, 0.2);
    request.refractive_index = {dice.uniform(1.3, 2.2),
                                dice.chance(0.5) ? 0 : dice.logarithmic(1e-5, 1e-2)};
    request.with_phase_table = true;
    request.phase_tolerance = request.table_tolerance = 1e-3;
    request.tolerance = 1e-6;
    request.highest_moment = mie::highest_moment_of(request);
    const auto optics = mie::average_over_sizes(request);
    return {optics.single_scattering_albedo, optics.one_minus_albedo, optics.chi, false,
            [table = optics.phase_table](double mu) { return (*table)(mu); }};
}

rte::Stack random_stack(Dice& dice, const std::string& part) {
    rte::Stack stack;
    stack.base = part == "spheres" ? random_spheres(dice) : random_medium(dice);
    const bool has_boundary = part == "smooth" || part == "rough";
    if (has_boundary) {
        stack.boundary = rte::Boundary{};
        stack.base_index = dice.uniform(1.1, 2.2);
        if (part == "rough") stack.boundary->roughness = dice.logarithmic(0.05, 0.8);
        if (dice.chance(0.3)) stack.boundary->distribution = rte::MicrofacetDistribution::beckmann;
    }
    const bool is_coated = part == "coats" || (has_boundary && dice.chance(0.6));
    for (int i = is_coated ? dice.integer(1, 2) : 0; i > 0; --i) {
        const double depth = dice.chance(0.2) ? 100 : dice.logarithmic(1e-3, 20);
        stack.coats.push_back({random_medium(dice), depth, stack.base_index});
    }
    if (!is_coated || dice.chance(0.4)) return stack;
    stack.base_kind = part == "smooth" && dice.chance(0.3) ? rte::BaseKind::mirror
                      : dice.chance(0.5)                   ? rte::BaseKind::lambertian
                                                           : rte::BaseKind::none;
    stack.mirror_index = {0.2, 3.0};
    stack.ground_albedo = dice.uniform(0, 1);
    return stack;
}

std::vector<Part> random_parts() {
    std::vector<Part> parts = {{"media", {1e-2, 1e-3, 1e-5}, {}},
                               {"coats", {1e-2, 1e-3, 1e-5}, {}},
                               {"smooth", {1e-2, 1e-3, 1e-4}, {}},
                               {"rough", {1e-2, 1e-3}, {}},
                               {"spheres", {1e-2, 1e-3}, {}}};
    unsigned seed = 1;
    for (Part& part : parts) {
        Dice dice(seed++);
        for (int i = part.name == "rough" || part.name == "spheres" ? 8 : 20; i > 0; --i)
            part.cases.push_back({random_stack(dice, part.name), stress::random_directions(dice)});
    }
    return parts;
}

Values values_of(const Case& one, const rte::SolverOptions& options) {
    const rte::ReflectionTable table = rte::reflect(one.stack, one.directions, options);
    rte::AlbedoTable albedos = rte::albedo(one.stack, one.directions.mu_in, options);
    Values values{table.reflection, std::move(albedos.plane_albedo), table.errors,
                  albedos.report.error_estimate};
    values.albedos.push_back(albedos.spherical_albedo);
    values.albedos.insert(values.albedos.end(), albedos.transmittance.begin(),
                          albedos.transmittance.end());
    return values;
}

constexpr double kTruthTolerance = 1e-7;

// At two numbers of nodes: their difference is the noise of the reference.
struct Truth {
    Values finest, coarser;
};

Truth truth_of(const Case& one) {
    const bool is_rough = one.stack.boundary && one.stack.boundary->is_rough();
    const int streams = is_rough ? 48 : 128;
    return {values_of(one, {.tolerance = kTruthTolerance, .streams = streams}),
            values_of(one, {.tolerance = kTruthTolerance, .streams = 3 * streams / 4})};
}

// The error beyond the noise of the truth.
void add(double value, double finest, double coarser, double scale, double stated, double tolerance,
         Tally& tally) {
    const double noise = std::max(std::abs(coarser - finest) / scale, kTruthTolerance);
    tally.add(std::max(0.0, std::abs(value - finest) / scale - noise), 0.5 * noise, stated,
              tolerance);
}

void tally_part(const Part& part, const std::vector<Truth>& truth, Tally& tally) {
    for (std::size_t i = 0; i < part.cases.size(); ++i) {
        const rte::Directions& d = part.cases[i].directions;
        const std::size_t block = d.mu_out.size() * d.azimuth_deg.size();
        const auto& [finest, coarser] = truth[i];
        for (const double tolerance : part.tolerances) {
            const Values values = values_of(part.cases[i], {.tolerance = tolerance});
            for (std::size_t k = 0; k < values.reflection.size(); ++k) {
                double scale = 1e-300;
                for (std::size_t n = k / block * block; n < (k / block + 1) * block; ++n)
                    scale = std::max(scale, std::abs(finest.reflection[n]));
                add(values.reflection[k], finest.reflection[k], coarser.reflection[k], scale,
                    values.errors[k], tolerance, tally);
            }
            for (std::size_t k = 0; k < values.albedos.size(); ++k) {
                add(values.albedos[k], finest.albedos[k], coarser.albedos[k],
                    std::max(finest.albedos[k], 1e-6), values.albedo_error, tolerance, tally);
            }
        }
    }
}

template <typename Visit>
void visit_numbers(std::vector<std::vector<Truth>>& all, const Visit& visit) {
    for (auto& part : all) {
        for (Truth& truth : part) {
            for (Values* values : {&truth.finest, &truth.coarser})
                for (auto* list : {&values->reflection, &values->albedos}) visit(*list);
        }
    }
}

bool load(const std::string& file, std::vector<std::vector<Truth>>& all) {
    std::ifstream in(file);
    visit_numbers(all, [&](std::vector<double>& list) {
        std::size_t count = 0;
        if (in >> count) list.resize(count);
        for (double& v : list) in >> v;
    });
    return bool(in);
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 2) {
        std::fprintf(stderr, "transfer_battery TRUTH [media|coats|smooth|rough|spheres...]\n");
        return 2;
    }
    const std::vector<Part> parts = random_parts();
    std::vector<std::vector<Truth>> truth;
    for (const Part& part : parts) truth.emplace_back(part.cases.size());
    if (!load(arguments[1], truth)) {
        for (std::size_t p = 0; p < parts.size(); ++p)
            for (std::size_t i = 0; i < truth[p].size(); ++i)
                truth[p][i] = truth_of(parts[p].cases[i]);
        std::ofstream out(arguments[1]);
        out.precision(17);
        visit_numbers(truth, [&](const std::vector<double>& list) {
            out << list.size();
            for (const double v : list) out << ' ' << v;
            out << '\n';
        });
    }
    constants::print_header();
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (constants::is_wanted(parts[p].name, count, arguments))
            constants::measure(parts[p].name,
                               [&](Tally& tally) { tally_part(parts[p], truth[p], tally); });
    }
    return 0;
}
