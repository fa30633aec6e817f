// Importance sampling of any BRDF by a table of cells.
#include <miebrdf/sampling.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>

namespace miebrdf {

// Cells are even in s = mu_out^2 and in the azimuth, folded at the plane of incidence. Within a
// cell s and azimuth are uniform: with dw = dmu dphi and ds = 2 mu dmu, a cell of probability p has
// the density p 2 mu / (ds dphi) per unit of solid angle, which follows the cosine.
struct DirectionSampler::Table {
    std::size_t incidences = 0, zeniths = 0, azimuths = 0;
    /// For each incidence, the running sum of the cells' probabilities, [zenith * azimuths +
    /// azimuth].
    std::vector<double> up_to;

    std::size_t cells() const { return zeniths * azimuths; }
    double width_s() const { return 1.0 / static_cast<double>(zeniths); }
    double width_azimuth() const { return std::numbers::pi / static_cast<double>(azimuths); }

    double probability(std::size_t incidence, std::size_t cell) const {
        const double* sums = &up_to[incidence * cells()];
        return sums[cell] - (cell > 0 ? sums[cell - 1] : 0.0);
    }
};

namespace {

/// Share of the directions that follow the cosine alone.
constexpr double kCosineShare = 0.01;

int whole(const char* name, int value, int lowest) {
    if (!(value >= lowest && value <= 1000))
        throw UsageError(name, double(value), lowest == 1 ? "1 to 1000" : "2 to 1000");
    return value;
}

std::vector<double> checked_weights(const BrdfSource& source, const SamplerOptions& options) {
    const std::size_t channels = source.channels().size();
    if (options.weights.empty()) return std::vector<double>(channels, 1.0);
    if (options.weights.size() != channels)
        throw UsageError("weights", double(options.weights.size()), "one for each channel");
    double sum = 0.0;
    for (const double weight : options.weights) {
        if (!(weight >= 0.0 && std::isfinite(weight)))
            throw UsageError("weights", weight, ">= 0 and finite");
        sum += weight;
    }
    if (!(sum > 0.0)) throw UsageError("weights", sum, "a sum > 0");
    return options.weights;
}

void check_cosine(const char* name, double mu) {
    if (!(mu > 0.0 && mu <= 1.0)) throw UsageError(name, mu, "(0, 1]");
}

/// Place of a cosine among the tabulated incidences, which are even in the angle.
struct CosinePlace {
    std::size_t lower = 0;
    double towards_next = 0.0;  ///< in [0, 1]
};

CosinePlace place_of(double mu_in, std::size_t incidences) {
    const double x =
        std::acos(mu_in) / (std::numbers::pi / 2) * static_cast<double>(incidences - 1);
    const auto lower = std::min(static_cast<std::size_t>(std::max(x, 0.0)), incidences - 2);
    return {lower, std::clamp(x - static_cast<double>(lower), 0.0, 1.0)};
}

/// The cosine of a tabulated incidence; the last one stands for the horizon, which is no direction.
double cosine_of(std::size_t incidence, std::size_t incidences) {
    constexpr double kHorizon = 1e-3;
    return std::max(kHorizon, std::cos(std::numbers::pi / 2 * static_cast<double>(incidence) /
                                       static_cast<double>(incidences - 1)));
}

}  // namespace

DirectionSampler::DirectionSampler(const BrdfSource& source, const SamplerOptions& options,
                                   const Control& control) {
    const std::vector<double> weights = checked_weights(source, options);
    auto table = std::make_shared<Table>();
    table->incidences = static_cast<std::size_t>(whole("incidences", options.incidences, 2));
    table->zeniths = static_cast<std::size_t>(whole("zeniths", options.zeniths, 1));
    table->azimuths = static_cast<std::size_t>(whole("azimuths", options.azimuths, 1));

    std::vector<Direction> centres;
    centres.reserve(table->incidences * table->cells());
    for (std::size_t i = 0; i < table->incidences; ++i) {
        for (std::size_t z = 0; z < table->zeniths; ++z) {
            const double s = (static_cast<double>(z) + 0.5) * table->width_s();
            for (std::size_t a = 0; a < table->azimuths; ++a) {
                const double azimuth = (static_cast<double>(a) + 0.5) * table->width_azimuth();
                centres.push_back({cosine_of(i, table->incidences), std::sqrt(s),
                                   azimuth * (180 / std::numbers::pi)});
            }
        }
    }
    const std::vector<double> values = evaluate_all(source, centres, "sampling", control);

    // Cells have the same projected solid angle, ds dphi / 2, so that f alone is their weight.
    const double even = 1.0 / static_cast<double>(table->cells());
    table->up_to.reserve(centres.size());
    for (std::size_t i = 0; i < table->incidences; ++i) {
        std::vector<double> reflected(table->cells(), 0.0);
        double sum = 0.0;
        for (std::size_t cell = 0; cell < table->cells(); ++cell) {
            const double* const value = &values[(i * table->cells() + cell) * weights.size()];
            for (std::size_t c = 0; c < weights.size(); ++c)
                reflected[cell] += weights[c] * std::max(value[c], 0.0);
            sum += reflected[cell];
        }
        double running = 0.0;
        for (const double f : reflected) {
            running += sum > 0.0 ? kCosineShare * even + (1 - kCosineShare) * f / sum : even;
            table->up_to.push_back(running);
        }
        table->up_to.back() = 1.0;
    }
    table_ = std::move(table);
}

SampledDirection DirectionSampler::sample(double mu_in, double u1, double u2) const {
    check_cosine("mu_in", mu_in);
    if (!(u1 >= 0.0 && u1 < 1.0)) throw UsageError("u1", u1, "[0, 1)");
    if (!(u2 >= 0.0 && u2 < 1.0)) throw UsageError("u2", u2, "[0, 1)");
    const Table& table = *table_;
    const CosinePlace between = place_of(mu_in, table.incidences);
    // What is left of u1 after each decision is uniform again.
    const bool upper = u1 < between.towards_next;
    u1 = upper ? u1 / between.towards_next
               : (u1 - between.towards_next) / (1.0 - between.towards_next);
    const std::size_t incidence = between.lower + (upper ? 1 : 0);
    const auto first = table.up_to.begin() + static_cast<std::ptrdiff_t>(incidence * table.cells());
    const auto last = first + static_cast<std::ptrdiff_t>(table.cells());
    const auto found = std::min(std::upper_bound(first, last, u1), last - 1);
    const auto cell = static_cast<std::size_t>(found - first);
    const double below = cell > 0 ? *(found - 1) : 0.0;
    const double within = std::clamp((u1 - below) / (*found - below), 0.0, 1.0);

    const double s = (static_cast<double>(cell / table.azimuths) + within) * table.width_s();
    // Either side of the plane of incidence with the same probability.
    const bool other_side = u2 >= 0.5;
    const double folded =
        (static_cast<double>(cell % table.azimuths) + 2.0 * (other_side ? u2 - 0.5 : u2)) *
        table.width_azimuth() * (180 / std::numbers::pi);
    SampledDirection drawn;
    drawn.mu_out = std::clamp(std::sqrt(s), 1e-12, 1.0);
    drawn.azimuth_deg = other_side && 360.0 - folded < 360.0 ? 360.0 - folded : folded;
    drawn.density = density(mu_in, drawn.mu_out, drawn.azimuth_deg);
    return drawn;
}

double DirectionSampler::density(double mu_in, double mu_out, double azimuth_deg) const {
    check_cosine("mu_in", mu_in);
    check_cosine("mu_out", mu_out);
    if (!std::isfinite(azimuth_deg)) throw UsageError("azimuth_deg", azimuth_deg, "finite");
    const Table& table = *table_;
    const CosinePlace between = place_of(mu_in, table.incidences);
    const auto cell_in = [](double x, std::size_t count) {
        return std::min(static_cast<std::size_t>(x), count - 1);
    };
    const double folded = std::abs(std::remainder(azimuth_deg, 360.0)) * (std::numbers::pi / 180);
    const std::size_t cell =
        cell_in(mu_out * mu_out / table.width_s(), table.zeniths) * table.azimuths +
        cell_in(folded / table.width_azimuth(), table.azimuths);
    const double probability =
        (1.0 - between.towards_next) * table.probability(between.lower, cell) +
        between.towards_next * table.probability(between.lower + 1, cell);
    // Half of it on this side of the plane of incidence.
    return probability * mu_out / (table.width_s() * table.width_azimuth());
}

}  // namespace miebrdf
