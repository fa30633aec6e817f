// Errors of radiative transfer, against many more nodes at a tolerance of 1e-7: as
// ensemble_battery has them for averages over sizes.
//
//     transfer_battery TRUTH [PART...]
//
// Seeds as there.
// PART: media, coats, smooth, rough, spheres; rare-media, rare-coats, rare-smooth, rare-spheres:
// peaks up to g = .995, thin and deep and dark layers, steps of the index, grazing directions;
// rare-glories: spheres near retro-reflection; rare-values: single values of such media; hidden:
// what is lost where layers are taken to be hidden.
// TRUTH-PART is a file that holds the reference; it is made if it is not there.
#include <miebrdf/ensemble.h>
#include <miebrdf/transfer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "rte/stack/hidden_layers.h"
#include "tests/batteries/tally.h"
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
    int cases;
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
rte::Optics random_spheres(Dice& dice, double tolerance) {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = dice.logarithmic(0.3, 12);
    request.sizes.effective_variance = dice.uniform(0.03, 0.2);
    request.refractive_index = {dice.uniform(1.3, 2.2),
                                dice.chance(0.5) ? 0 : dice.logarithmic(1e-5, 1e-2)};
    request.with_phase_table = true;
    request.phase_tolerance = request.table_tolerance = 1e-3;
    request.tolerance = tolerance;
    request.highest_moment = mie::highest_moment_of(request);
    const auto optics = mie::average_over_sizes(request);
    return {optics.single_scattering_albedo, optics.one_minus_albedo, optics.chi, false,
            [table = optics.phase_table](double mu) { return (*table)(mu); }};
}

// As they trouble the solver: dark or nearly white, with peaks that few nodes resolve.
rte::Optics stiff_medium(Dice& dice) {
    const double albedo = dice.chance(0.5) ? stress::random_albedo(dice) : dice.uniform(0.9, 1);
    if (dice.chance(0.3)) return stress::random_smooth(dice);
    const auto peak = rte::henyey_greenstein_optics(albedo, dice.uniform(0.85, 0.995));
    if (dice.chance(0.5)) return peak;
    const double share = dice.uniform(0.3, 1);
    const auto back = rte::henyey_greenstein_optics(albedo, dice.uniform(-0.9, 0));
    return rte::mix({{peak, share}, {back, 1 - share}});
}

rte::Stack stiff_stack(Dice& dice, const std::string& part) {
    const auto medium = [&] {
        return part == "rare-spheres" ? random_spheres(dice, 1e-3) : stiff_medium(dice);
    };
    rte::Stack stack;
    stack.base = medium();
    const bool has_boundary = part == "rare-smooth";
    if (has_boundary) {
        stack.boundary = rte::Boundary{};
        stack.base_index = dice.uniform(1.02, 3);
    }
    int coats = part == "rare-media" ? 0 : dice.integer(has_boundary ? 0 : 1, 2);
    for (; coats > 0; --coats) {
        const double depth =
            dice.chance(0.5) ? dice.logarithmic(1e-4, 0.02) : dice.logarithmic(5, 300);
        const bool has_step = has_boundary && dice.chance(0.4);
        stack.coats.push_back(
            {medium(), depth, has_step ? dice.uniform(1.02, 3) : stack.base_index});
    }
    if (stack.coats.empty() || dice.chance(0.6)) return stack;
    stack.base_kind = has_boundary && dice.chance(0.4) ? rte::BaseKind::mirror
                      : dice.chance(0.5)               ? rte::BaseKind::lambertian
                                                       : rte::BaseKind::none;
    stack.mirror_index = {0.2, 3.0};
    stack.ground_albedo = dice.uniform(0, 1);
    return stack;
}

// Grazing cosines, and straight back.
rte::Directions stiff_directions(Dice& dice) {
    rte::Directions directions = stress::random_directions(dice);
    for (auto* list : {&directions.mu_in, &directions.mu_out})
        list->push_back(dice.logarithmic(0.005, 1));
    if (dice.chance(0.3)) directions.mu_out = directions.mu_in;
    directions.azimuth_deg.push_back(dice.chance(0.5) ? 180 : dice.uniform(0, 180));
    return directions;
}

// Within some degrees of straight back.
rte::Directions near_retro_reflection(Dice& dice) {
    const double mu = dice.chance(0.4) ? 1 : dice.uniform(0.1, 1);
    const double beside = std::cos(std::acos(mu) + dice.uniform(-0.1, 0.1));
    const double step = dice.logarithmic(0.3, 8);
    return {{mu}, {mu, std::max(beside, 0.02)}, {180, 180 - step, 180 - 3 * step, 90}};
}

// One coat of a depth where it begins to hide what is below.
rte::Stack hiding_stack(Dice& dice) {
    rte::Stack stack;
    stack.base = dice.chance(0.5) ? stiff_medium(dice) : rte::isotropic_optics(1);
    if (dice.chance(0.3)) {
        stack.base_kind = rte::BaseKind::lambertian;
        stack.ground_albedo = 1;
    }
    const rte::Optics coat = dice.chance(0.5) ? stiff_medium(dice) : random_medium(dice);
    stack.coats.push_back({coat, dice.logarithmic(1, 1000), 1.0});
    return stack;
}

rte::Stack random_stack(Dice& dice, const std::string& part) {
    if (part == "hidden") return hiding_stack(dice);
    if (part == "rare-glories") {
        rte::Stack stack{.base = random_spheres(dice, 1e-3)};
        if (dice.chance(0.4))
            stack.coats.push_back({stiff_medium(dice), dice.logarithmic(1e-2, 5), 1.0});
        return stack;
    }
    if (part == "rare-values") return {.base = stiff_medium(dice)};
    if (part.starts_with("rare-")) return stiff_stack(dice, part);
    rte::Stack stack;
    stack.base = part == "spheres" ? random_spheres(dice, 1e-6) : random_medium(dice);
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

const std::vector<Part>& all_parts() {
    static const std::vector<Part> parts = {{"media", {1e-2, 1e-3, 1e-5}, 20},
                                            {"coats", {1e-2, 1e-3, 1e-5}, 20},
                                            {"smooth", {1e-2, 1e-3, 1e-4}, 20},
                                            {"rough", {1e-2, 1e-3}, 8},
                                            {"spheres", {1e-2, 1e-3}, 8},
                                            {"rare-media", {1e-2, 1e-3, 1e-5}, 20},
                                            {"rare-coats", {1e-2, 1e-3, 1e-5}, 20},
                                            {"rare-smooth", {1e-2, 1e-3, 1e-4}, 20},
                                            {"rare-spheres", {1e-2, 1e-3}, 12},
                                            {"rare-glories", {1e-2, 1e-3}, 24},
                                            {"rare-values", {1e-2, 1e-3, 1e-5}, 120},
                                            {"hidden", {1e-2, 1e-3, 1e-5}, 60}};
    return parts;
}

rte::Directions directions_for(Dice& dice, const std::string& part) {
    if (part == "rare-glories") return near_retro_reflection(dice);
    if (part == "rare-values") {
        return {{dice.logarithmic(0.02, 1)}, {dice.logarithmic(0.02, 1)}, {dice.uniform(0, 180)}};
    }
    return part.starts_with("rare-") ? stiff_directions(dice) : stress::random_directions(dice);
}

std::vector<Case> cases_of(const Part& part, unsigned seed) {
    Dice dice(seed);
    std::vector<Case> cases;
    for (int i = 0; i < part.cases; ++i) {
        rte::Stack stack = random_stack(dice, part.name);
        cases.push_back({std::move(stack), directions_for(dice, part.name)});
    }
    return cases;
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

// Without what is below the coat where that counts as hidden.
rte::Stack without_hidden(const Case& one, double tolerance) {
    rte::Stack stack = one.stack;
    const rte::Coat& coat = stack.coats.front();
    if (rte::hides_what_is_below(coat.optics, coat.optical_depth, one.directions, tolerance)) {
        stack.base_kind = rte::BaseKind::half_space;
        stack.base = coat.optics;
        stack.coats.clear();
    }
    return stack;
}

// The error beyond the noise of the truth.
void add(double value, double finest, double coarser, double scale, double stated, double tolerance,
         Tally& tally) {
    const double noise = std::max(std::abs(coarser - finest) / scale, kTruthTolerance);
    tally.add(std::max(0.0, std::abs(value - finest) / scale - noise), 0.5 * noise, stated,
              tolerance);
}

void tally_part(const Part& part, const std::vector<Case>& cases, const std::vector<Truth>& truth,
                Tally& tally) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const rte::Directions& d = cases[i].directions;
        const std::size_t block = d.mu_out.size() * d.azimuth_deg.size();
        const auto& [finest, coarser] = truth[i];
        for (const double tolerance : part.tolerances) {
            Case one = cases[i];
            if (part.name == "hidden") one.stack = without_hidden(one, tolerance);
            const Values values = values_of(one, {.tolerance = tolerance});
            for (std::size_t k = 0; k < values.reflection.size(); ++k) {
                double scale = 1e-300;
                for (std::size_t n = k / block * block; n < (k / block + 1) * block; ++n)
                    scale = std::max(scale, std::abs(finest.reflection[n]));
                add(values.reflection[k], finest.reflection[k], coarser.reflection[k], scale,
                    values.errors[k], tolerance, tally);
            }
            const std::size_t albedos =
                part.name == "hidden" ? d.mu_in.size() + 1 : values.albedos.size();
            for (std::size_t k = 0; k < albedos; ++k) {
                add(values.albedos[k], finest.albedos[k], coarser.albedos[k],
                    std::max(finest.albedos[k], 1e-6), values.albedo_error, tolerance, tally);
            }
        }
    }
}

template <typename Visit>
void visit_numbers(std::vector<Truth>& all, const Visit& visit) {
    for (Truth& truth : all) {
        for (Values* values : {&truth.finest, &truth.coarser})
            for (auto* list : {&values->reflection, &values->albedos}) visit(*list);
    }
}

bool load(const std::string& file, std::vector<Truth>& all) {
    std::ifstream in(file);
    visit_numbers(all, [&](std::vector<double>& list) {
        std::size_t count = 0;
        if (in >> count) list.resize(count);
        for (double& v : list) in >> v;
    });
    return bool(in);
}

std::vector<Truth> truth_in(const std::string& file, const std::vector<Case>& cases) {
    std::vector<Truth> truth(cases.size());
    if (load(file, truth)) return truth;
    std::transform(cases.begin(), cases.end(), truth.begin(), truth_of);
    std::ofstream out(file);
    out.precision(17);
    visit_numbers(truth, [&](const std::vector<double>& list) {
        out << list.size();
        for (const double v : list) out << ' ' << v;
        out << '\n';
    });
    return truth;
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 2) {
        std::fprintf(stderr, "transfer_battery TRUTH [media|coats|smooth|rough|spheres|...]\n");
        return 2;
    }
    constants::print_header();
    unsigned seed = 1 + 1000 * constants::seed_of_run();
    for (const Part& part : all_parts()) {
        const unsigned own_seed = seed++;
        if (!constants::is_wanted(part.name, count, arguments)) continue;
        const std::vector<Case> cases = cases_of(part, own_seed);
        const auto truth = truth_in(std::string(arguments[1]) + "-" + part.name, cases);
        constants::measure(part.name, [&](Tally& tally) { tally_part(part, cases, truth, tally); });
    }
    return 0;
}
