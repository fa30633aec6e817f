// The words for how a scene is solved.
#include <fmt/format.h>

#include <vector>

#include "pipeline/scene/word_setters.h"

namespace miebrdf {
namespace {

constexpr NamedValue<rte::GridKind> kGrids[] = {{"auto", rte::GridKind::automatic},
                                                {"gauss", rte::GridKind::gauss},
                                                {"mapped-gauss", rte::GridKind::mapped_gauss},
                                                {"paper", rte::GridKind::paper}};
constexpr NamedValue<rte::HalfSpaceMethod> kHalfSpaceMethods[] = {
    {"auto", rte::HalfSpaceMethod::automatic},
    {"fixed-point", rte::HalfSpaceMethod::fixed_point},
    {"doubling", rte::HalfSpaceMethod::doubling}};
constexpr NamedValue<rte::CoatMethod> kCoatMethods[] = {
    {"auto", rte::CoatMethod::automatic},
    {"first-order", rte::CoatMethod::first_order},
    {"first-order-patched", rte::CoatMethod::first_order_patched},
    {"exponential", rte::CoatMethod::exponential}};

constexpr NamedValue<int> kStokes[] = {{"auto", 0}, {"1", 1}, {"3", 3}, {"4", 4}};

template <auto member>
constexpr auto set_solver_number = set_number<&Request::solver, member>;

template <const auto& names, auto member>
constexpr auto set_solver_name = set_name<names, &Request::solver, member>;

}  // namespace

std::vector<SceneWord> method_words() {
    const std::string group = "Method";
    const rte::SolverOptions defaults;
    return {{.name = "tolerance",
             .placeholder = "ERROR",
             .help = "largest error, relative to the largest BRDF value at the same incidence",
             .group = group,
             .default_text = fmt::format("{}", defaults.tolerance),
             .field = "tolerance",
             .set = set_solver_number<&rte::SolverOptions::tolerance>},
            {.name = "stokes",
             .placeholder = "N",
             .help = "Stokes components that are computed: 1 (I), 3 (I, Q, U) or 4 (I, Q, U, V); "
                     "auto: 3 if polarisation changes the intensity noticeably, else 1",
             .group = group,
             .default_text = kStokes[0].name,
             .field = "stokes",
             .set = set_solver_name<kStokes, &rte::SolverOptions::stokes>},
            {.name = "streams",
             .placeholder = "N",
             .help = fmt::format(
                 "directions (zenith nodes) of each hemisphere, {} to {}; 0: as many as "
                 "the tolerance needs",
                 rte::kFewestNodes, rte::kMostNodes),
             .group = group,
             .default_text = fmt::format("{}", defaults.streams),
             .field = "streams",
             .set = set_solver_number<&rte::SolverOptions::streams>},
            {.name = "grid",
             .placeholder = "NAME",
             .help = "where the zenith nodes lie: " + list_of(kGrids),
             .group = group,
             .default_text = kGrids[0].name,
             .field = "grid",
             .set = set_solver_name<kGrids, &rte::SolverOptions::grid>},
            {.name = "half-space-method",
             .placeholder = "NAME",
             .help = "how the base is solved: " + list_of(kHalfSpaceMethods),
             .group = group,
             .default_text = kHalfSpaceMethods[0].name,
             .field = "half_space_method",
             .set = set_solver_name<kHalfSpaceMethods, &rte::SolverOptions::half_space_method>},
            {.name = "coat-method",
             .placeholder = "NAME",
             .help = "how coats are solved: " + list_of(kCoatMethods),
             .group = group,
             .default_text = kCoatMethods[0].name,
             .field = "coat_method",
             .set = set_solver_name<kCoatMethods, &rte::SolverOptions::coat_method>},
            {.name = "coat-substeps",
             .placeholder = "N",
             .help = "number of steps for each coat; only some coat methods work in steps",
             .group = group,
             .default_text = fmt::format("{}", defaults.coat_substeps),
             .field = "coat_substeps",
             .set = set_solver_number<&rte::SolverOptions::coat_substeps>},
            {.name = "no-delta-m",
             .help = "do not truncate the forward peak of the phase function",
             .group = group,
             .kind = WordKind::flag,
             .field = "delta_m",
             .set = set_switch<false, &Request::solver, &rte::SolverOptions::delta_m>},
            {.name = "no-single-scattering-correction",
             .help = "do not replace light scattered once by its exact value",
             .group = group,
             .kind = WordKind::flag,
             .field = "single_scattering_correction",
             .set = set_switch<false, &Request::solver,
                               &rte::SolverOptions::single_scattering_correction>}};
}

}  // namespace miebrdf
