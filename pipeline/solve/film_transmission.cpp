// The BTDF of a film: light scattered more than once from a table, light scattered once exactly.
#include <fmt/format.h>
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/version.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/checks.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/smooth_part.h"
#include "pipeline/solve/solved_table.h"
#include "rte/math/quadrature.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/transmission.h"

namespace miebrdf {
namespace {

struct FilmWavelength {
    rte::Stack stack;
    rte::TransmittedOrders film;  ///< its orders are in `smooth`
    SmoothPart smooth;
    WavelengthReport report;

    /// T at each cosine of an azimuth.
    void evaluate(double mu_in, double mu_out, const std::vector<double>& cos_azimuth,
                  std::vector<double>& values, std::vector<double>& series) const {
        smooth.series_at(mu_in, mu_out, series);
        values.clear();
        for (const double cosine : cos_azimuth) values.push_back(math::cosine_sum(series, cosine));
        rte::add_transmitted_once(film, mu_in, mu_out, cos_azimuth, values);
    }
};

/// How far the light of all directions and the unscattered light are from what the solution lets
/// pass, along the normal: what nodes, azimuthal orders, the table and delta-M leave.
double missing_light(const FilmWavelength& at) {
    constexpr int kCosines = 48, kAzimuths = 48;
    const math::Quadrature cosines = math::gauss_legendre(kCosines, 0.0, 1.0);
    std::vector<double> cos_azimuth, values, series;
    for (int a = 0; a < kAzimuths; ++a)
        cos_azimuth.push_back(std::cos(std::numbers::pi * (a + 0.5) / kAzimuths));
    double sum = rte::unscattered_transmittance(at.stack, 1.0);
    for (int k = 0; k < kCosines; ++k) {
        const double s = cosines.nodes[std::size_t(k)];  // sin^2: nodes crowd at the normal
        const double mu = std::sqrt(1.0 - s * s);
        at.evaluate(1.0, mu, cos_azimuth, values, series);
        for (const double value : values)
            sum += 2.0 * cosines.weights[std::size_t(k)] * s * value / kAzimuths;
    }
    const double all = at.film.plane_transmittance[SmoothPart::kNodes - 1];
    return std::abs(sum - all) / std::max(all, kLeastJudgedFlux);
}

SmoothPart table_of(const rte::TransmittedOrders& film) {
    const std::vector<double>& mu = SmoothPart::nodes();
    const std::size_t count = mu.size(), orders = film.orders.size();
    std::vector<double> modes(count * count * orders);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t o = 0; o < count; ++o) {
            for (std::size_t m = 0; m < orders; ++m)
                modes[(i * count + o) * orders + m] =
                    (mu[i] + mu[o]) * (m == 0 ? 1.0 : 2.0) *
                    film.orders[m](Eigen::Index(o), Eigen::Index(i));
        }
    }
    return {modes, orders};
}

FilmWavelength solved_film(const SceneOptics& optics, double wavelength_nm,
                           const SolverOptions& solver) {
    FilmWavelength at;
    at.stack = optics.stack;
    SolverOptions options = solver;
    options.tolerance = tolerance_for_transfer(solver.tolerance, optics.mie_error_estimate);
    rte::SolverReport& report = at.report.solver;
    report = rte::reflect(at.stack, probe_directions(), options).report;
    at.film = rte::tabulate_transmission(at.stack, SmoothPart::nodes(), report, options);
    report.fourier_orders = int(at.film.orders.size());
    at.report.wavelength_nm = wavelength_nm;
    at.report.optical_depths = optics.optical_depths;
    at.report.mie_error_estimate = optics.mie_error_estimate;
    if (!at.film.physical)
        throw InputError(fmt::format("{} nm: the equations of the film have no physical solution",
                                     wavelength_nm));
    at.smooth = table_of(at.film);
    at.film.orders.clear();
    at.report.error_estimate =
        std::max(report.error_estimate + optics.mie_error_estimate, missing_light(at));
    at.report.converged =
        optics.converged && at.film.converged && at.report.error_estimate <= solver.tolerance;
    return at;
}

}  // namespace

struct FilmTransmission::State {
    std::vector<std::string> channels;
    std::vector<double> wavelength_nm;
    Provenance provenance;
    std::vector<FilmWavelength> wavelengths;
    ResultReport report;
};

FilmTransmission::FilmTransmission(const Brdf& film, const std::string& command_line) {
    const BrdfState& state = BrdfState::of(film);
    const ResolvedScene& scene = state.resolved;
    const std::vector<std::size_t> all = all_wavelengths(scene);
    auto made = std::make_shared<State>();
    const auto refuse = [](const std::string& why) {
        throw UsageError("transmitted light has no direction here: " + why);
    };
    if (scene.surface) refuse("the surface of a roughness has no lower side; take a boundary");
    if (!scene.substrate) refuse("a half-space lets nothing pass; give a substrate, e.g. none");
    const auto demand = demand_of(state.solver, scene.particles.tolerance, PhaseDemand::whole);
    const auto optics = optics_from(scene, 0, all, demand, state.control);
    for (const SceneOptics& at : optics) {
        const std::string why = rte::why_not_transmitted(at.stack);
        if (!why.empty()) refuse(why);
    }
    made->wavelengths.resize(all.size());
    run_parallel("radiative transfer", all.size(), state.control, [&](std::size_t w) {
        made->wavelengths[w] = solved_film(optics[w], scene.wavelength_nm[w], state.solver);
    });
    made->channels = channel_names(scene.wavelength_nm);
    made->wavelength_nm = scene.wavelength_nm;
    ResultReport& report = made->report;
    report.tolerance = state.solver.tolerance;
    report.sources = scene.sources;
    report.notes = scene.notes;
    for (const FilmWavelength& at : made->wavelengths) report.wavelengths.push_back(at.report);
    std::vector<std::string> shares;
    for (std::size_t w = 0; w < all.size(); ++w)
        shares.push_back(
            fmt::format("{:.4g}", rte::unscattered_transmittance(made->wavelengths[w].stack, 1.0)));
    made->provenance = {.version = std::string("miebrdf ") + kVersion,
                        .command_line = command_line,
                        .title = describe(state.scene),
                        .component = kTransmitted,
                        .accuracy = report.summary(),
                        .polarisation = "light as a number; polarisation is not looked at",
                        .sources = scene.sources,
                        .left_out = fmt::format(
                            "the light that passes straight on without being scattered, a delta; "
                            "along the normal its share is {} at {} nm",
                            fmt::join(shares, ", "), fmt::join(scene.wavelength_nm, ", "))};
    state_ = std::move(made);
}

const std::vector<std::string>& FilmTransmission::channels() const { return state_->channels; }
const std::vector<double>& FilmTransmission::wavelength_nm() const { return state_->wavelength_nm; }
const Provenance& FilmTransmission::provenance() const { return state_->provenance; }
const ResultReport& FilmTransmission::report() const { return state_->report; }

void FilmTransmission::evaluate(std::span<const Direction> asked, std::span<double> values) const {
    const std::size_t stride = state_->wavelengths.size();
    std::vector<Direction> storage;
    const auto directions = require_valid(asked, values.size(), stride, storage);
    std::vector<double> of_pair, series;
    EvaluationScratch scratch;
    for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
        const auto rest = directions.subspan(first);
        count = count_sharing_cosines(rest);
        set_cosines(rest.first(count), scratch);
        for (std::size_t w = 0; w < stride; ++w) {
            state_->wavelengths[w].evaluate(rest.front().mu_in, rest.front().mu_out,
                                            scratch.cos_azimuth, of_pair, series);
            for (std::size_t d = 0; d < count; ++d)  // interpolated: next to nothing may be below 0
                values[(first + d) * stride + w] = std::max(of_pair[d], 0.0) / std::numbers::pi;
        }
    }
}

double FilmTransmission::unscattered(std::size_t wavelength, double mu_in) const {
    if (!(wavelength < state_->wavelengths.size()))
        throw UsageError("wavelength", double(wavelength), "an index of wavelength_nm()");
    if (!(mu_in > 0.0 && mu_in <= 1.0)) throw UsageError("mu_in", mu_in, "(0, 1]");
    return rte::unscattered_transmittance(state_->wavelengths[wavelength].stack, mu_in);
}

}  // namespace miebrdf
