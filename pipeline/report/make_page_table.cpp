// How a PageTable is filled from a solved BRDF.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/report/half_sine_nodes.h"
#include "pipeline/report/page_table.h"
#include "pipeline/solve/first_order.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/wavelength_table.h"
#include "rte/boundary/rough_top.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"

namespace miebrdf::report {
namespace {

/// What the basis columns may leave out, over the largest value at an incidence.
constexpr double kRankTolerance = 1e-4;
/// The same of light scattered once, over the largest value at the angle: there it may be small at
/// one incidence and large at another.
constexpr double kOnceTolerance = 5e-5;
/// What the orders at the end of a series may add up to that are left out, likewise.
constexpr double kOrderTolerance = 1e-4;
/// Slope parameter of the lobe that shows the mirror reflection of a smooth boundary in pictures.
constexpr double kMirrorAlpha = 0.02;
/// Most azimuthal orders of light scattered once that is put into the series.
constexpr int kMostOnceOrders = 48;
/// Scattering angles of the table of light scattered once: the finest, and what else is tried.
constexpr int kMostAngles = 1025;
constexpr double kAngleTolerance = 1e-4;

PageLobe lobe_of(const rte::SurfaceOptions& options,
                 const std::vector<std::complex<double>>& index) {
    PageLobe lobe{.ggx = options.distribution == rte::MicrofacetDistribution::ggx,
                  .alpha = options.beckmann_alpha,
                  .shadowing = options.shadowing,
                  .masking = {},
                  .fresnel = {},
                  .scale = {}};
    const rte::ShadowingOverCosines masking(options);
    const std::vector<double> nodes = half_sine_nodes(PageTable::kCosines);
    for (const double mu : nodes) lobe.masking.push_back(masking.cosine_over_masking(mu));
    for (const std::complex<double> n : index) {
        std::vector<double>& fresnel = lobe.fresnel.emplace_back();
        const bool schlick = options.fresnel == rte::FresnelKind::schlick;
        for (const double mu : nodes) {
            fresnel.push_back(schlick ? rte::schlick_reflectance(rte::normal_reflectance(n), mu)
                                      : rte::fresnel_reflectance(n, mu));
        }
    }
    return lobe;
}

/// A series a_0 + sum a_m cos(m phi) from samples at phi = pi j / n, added to `series`.
void add_series(const std::vector<double>& samples, double factor, std::vector<double>& series) {
    const std::size_t n = samples.size() - 1;
    const std::size_t orders = std::min<std::size_t>(n, kMostOnceOrders);
    if (series.size() < orders) series.resize(orders, 0.0);
    for (std::size_t m = 0; m < orders; ++m) {
        double sum = 0.0;
        for (std::size_t j = 0; j <= n; ++j) {
            sum += (j == 0 || j == n ? 0.5 : 1.0) * samples[j] *
                   std::cos(std::numbers::pi * double((m * j) % (2 * n)) / double(n));
        }
        series[m] += factor * (m == 0 ? 1.0 : 2.0) / double(n) * sum;
    }
}

/// Orders before a tail that adds up to no more than is allowed; at least one.
std::size_t needed_orders(const std::vector<double>& series, double allowed) {
    double tail = 0.0;
    std::size_t count = series.size();
    while (count > 1 && tail + std::abs(series[count - 1]) <= allowed)
        tail += std::abs(series[--count]);
    return count;
}

/// The first slant whose node interpolation may need at an angle of this number: light is scattered
/// by small angles at grazing directions only, q >= 2 / sin(Theta / 2).
int first_slant(int angle, int angles, int slants) {
    if (slants == 1) return 0;
    const double sine = std::sin(0.5 * std::numbers::pi * half_sine(double(angle) / (angles - 1)));
    const double q = std::min(PageTable::kLastQ, 2.0 / std::max(sine, 1e-9));
    const double place = std::log(q / PageTable::kFirstQ) /
                         std::log(PageTable::kLastQ / PageTable::kFirstQ) * (slants - 1);
    return std::clamp(int(place) - 3, 0, slants - 6);
}

/// The columns of a row that can be asked for.
auto columns_of_use(const Eigen::MatrixXd& table, Eigen::Index row, int slants) {
    const Eigen::Index wavelengths = table.cols() / slants;
    const int first = first_slant(int(row), int(table.rows()), slants);
    return Eigen::seqN(first * wavelengths, (slants - first) * wavelengths);
}

/// Whether every second angle is enough: six of them describe what lies between.
bool half_as_many_will_do(const Eigen::MatrixXd& table, const Eigen::VectorXd& scale, int slants) {
    const int count = int(table.rows() + 1) / 2;
    for (Eigen::Index row = 1; row < table.rows(); row += 2) {
        const SixNodes six = six_nodes(0.5 * double(row), count);
        const auto columns = columns_of_use(table, row, slants);
        Eigen::RowVectorXd error = -table(row, columns);
        for (int k = 0; k < 6; ++k)
            error += six.weight[std::size_t(k)] * table(2 * (six.first + k), columns);
        if (!(error.cwiseAbs().maxCoeff() <= kAngleTolerance * scale[row])) return false;
    }
    return true;
}

Eigen::VectorXd row_scale(const Eigen::MatrixXd& table, int slants) {
    Eigen::VectorXd scale(table.rows());
    for (Eigen::Index row = 0; row < table.rows(); ++row)
        scale[row] = table(row, columns_of_use(table, row, slants)).cwiseAbs().maxCoeff();
    return scale;
}

/// What cannot be asked for may be anything: the same as what can, a few nodes away from it (angles
/// between the rows mix neighbours).
void flatten_what_is_of_no_use(Eigen::MatrixXd& table, int slants) {
    const Eigen::Index wavelengths = table.cols() / slants;
    for (Eigen::Index row = 0; row < table.rows(); ++row) {
        const int first = std::max(0, first_slant(int(row), int(table.rows()), slants) - 2);
        for (Eigen::Index slant = 0; slant < first; ++slant) {
            table.row(row).segment(slant * wavelengths, wavelengths) =
                table.row(row).segment(first * wavelengths, wavelengths).eval();
        }
    }
}

}  // namespace

void PageTable::add_surface(const BrdfTable::State& state) {
    lobe_ = lobe_of(*state.scene.surface, state.scene.surface_index);
    for (const WavelengthTable& table : state.tables) {
        std::vector<double>&in = in_.emplace_back(), &out = out_.emplace_back();
        // The product is what is known: shares are relative to those at the normal.
        const double normal = table.transmitted(1.0, 1.0);
        for (const double mu : half_sine_nodes(kCosines)) {
            in.push_back(table.transmitted(mu, 1.0));
            out.push_back(table.transmitted(1.0, mu) / normal);
        }
    }
}

void PageTable::add_boundary(const BrdfTable::State& state) {
    const rte::Boundary& boundary = *state.scene.boundary;
    std::vector<std::complex<double>> index;
    for (std::size_t w = 0; w < wavelengths_; ++w) index.emplace_back(state.scene.top_index(w));
    const bool rough = boundary.is_rough();
    lobe_ = lobe_of(
        {.beckmann_alpha = rough ? boundary.roughness : kMirrorAlpha,
         .distribution = rough ? boundary.distribution : rte::MicrofacetDistribution::beckmann},
        index);
    lobe_->only_in_pictures = !rough;
    if (!rough) return;
    const std::vector<double> nodes = half_sine_nodes(kCosines);
    for (const WavelengthTable& table : state.tables) {
        std::vector<double>& scale = lobe_->scale.emplace_back();
        for (const double mu : nodes) scale.push_back(table.lobe_scale(mu));
    }
}

void PageTable::add_once(const BrdfTable::State& state, const Control& control) {
    bool layered = false, any = false;
    std::vector<std::vector<rte::ScaledMedium>> stacks;
    for (const WavelengthTable& table : state.tables) {
        if (table.has_optical_steps()) return;  // in the series
        stacks.push_back(table.media());
        any = any || !stacks.back().empty();
        for (const rte::ScaledMedium& medium : stacks.back()) {
            layered = layered || std::isfinite(medium.scaled_optical_depth) ||
                      !medium.narrow.rest.empty();
        }
    }
    if (!any) return;
    angles_ = kMostAngles;
    slants_ = layered ? kSlants : 1;
    const bool exact = state.solver.single_scattering_correction;
    const FirstOrder first_order(stacks, exact, state.solver.tolerance);
    const std::size_t count = wavelengths_;
    Eigen::MatrixXd table(angles_, Eigen::Index(count) * slants_);
    run_parallel("light scattered once", std::size_t(slants_), control, [&](std::size_t slant) {
        const double q =
            kFirstQ * std::pow(kLastQ / kFirstQ, double(slant) / std::max(1, kSlants - 1));
        // Equal cosines of this q. The formula knows q and the scattering angle alone, so that the
        // cosine of an azimuth may be any number; at the normal itself every azimuth has one angle.
        const double mu = std::min(2.0 / q, 1.0 - 1e-4);
        std::vector<double> cos_azimuth, values(std::size_t(angles_) * count);
        for (const double share : half_sine_nodes(angles_)) {
            const double cos_theta = std::cos(std::numbers::pi * share);
            cos_azimuth.push_back((cos_theta + mu * mu) / ((1.0 - mu) * (1.0 + mu)));
        }
        first_order.evaluate(mu, mu, cos_azimuth, values);
        for (Eigen::Index a = 0; a < angles_; ++a) {
            for (std::size_t w = 0; w < count; ++w) {
                table(a, Eigen::Index(slant * count + w)) =
                    8.0 * mu * values[std::size_t(a) * count + w];
            }
        }
    });
    flatten_what_is_of_no_use(table, slants_);
    Eigen::VectorXd scale = row_scale(table, slants_);
    while (angles_ > 33 && half_as_many_will_do(table, scale, slants_)) {
        angles_ = (angles_ + 1) / 2;
        const Eigen::MatrixXd every_other = table(Eigen::seqN(0, angles_, 2), Eigen::all);
        table = every_other;
        scale = row_scale(table, slants_);
    }
    once_ =
        reduce_rank(table, std::move(scale), Eigen::VectorXd::Ones(table.cols()), kOnceTolerance);
}

void PageTable::add_multiple(const BrdfTable::State& state, int cosines, const Control& control) {
    pair_cosines_ = cosines;
    const std::vector<double> nodes = half_sine_nodes(cosines);
    std::vector<std::vector<std::vector<double>>> series(wavelengths_);  // [wavelength][pair]
    std::vector<double> cos_azimuth;
    const int samples = 2 * kMostOnceOrders;
    for (int j = 0; j <= samples; ++j)
        cos_azimuth.push_back(std::cos(std::numbers::pi * j / samples));
    std::vector<std::pair<const SharpPart*, std::size_t>> place;
    for (const SharpPart& part : state.sharp) {
        for (std::size_t own = 0; own < part.wavelengths(); ++own) place.emplace_back(&part, own);
    }
    run_parallel("table of the page", wavelengths_, control, [&](std::size_t w) {
        const auto [sharp, own] = place[w];
        const WavelengthTable& table = sharp->table(own);
        FirstOrder::Scratch scratch;
        std::vector<double> once(cos_azimuth.size());
        for (int i = 0; i < cosines; ++i) {
            for (int o = i; o < cosines; ++o) {
                const double in = std::max(nodes[std::size_t(i)], FirstOrder::kLeastCosine * 1e-6);
                const double out = std::max(nodes[std::size_t(o)], FirstOrder::kLeastCosine * 1e-6);
                std::vector<double>& a = series[w].emplace_back();
                table.smooth().series_at(in, out, a);
                const double surface = table.transmitted(in, out);
                for (double& value : a) value *= surface > 0.0 ? 1.0 / surface : 0.0;
                if (table.has_optical_steps()) {
                    sharp->scattered_once(own, in, out, cos_azimuth, once, scratch);
                    add_series(once, 1.0, a);
                }
                for (double& value : a) value *= in + out;
                if (!std::all_of(a.begin(), a.end(), [](double v) { return std::isfinite(v); })) {
                    throw InputError(fmt::format(
                        "no physical solution at {} nm; try other streams or a smaller tolerance",
                        state.scene.wavelength_nm[w]));
                }
            }
        }
    });
    keep_orders(series, cosines);
}

/// Errors of a pair of cosines count beside the largest value at either incidence; what is small
/// everywhere at a wavelength counts beside its own.
void PageTable::keep_orders(const std::vector<std::vector<std::vector<double>>>& series,
                            int cosines) {
    const std::vector<double> nodes = half_sine_nodes(cosines);
    const auto pairs = std::size_t(cosines * (cosines + 1) / 2);
    const auto each_pair = [&](const auto& action) {
        std::size_t p = 0;
        for (int i = 0; i < cosines; ++i) {
            for (int o = i; o < cosines; ++o, ++p)
                action(p, std::size_t(i), std::size_t(o),
                       nodes[std::size_t(i)] + nodes[std::size_t(o)]);
        }
    };
    Eigen::MatrixXd largest = Eigen::MatrixXd::Zero(cosines, Eigen::Index(wavelengths_));
    for (std::size_t w = 0; w < wavelengths_; ++w) {
        each_pair([&](std::size_t p, std::size_t i, std::size_t o, double mu_sum) {
            if (i == 0 || o == 0) return;  // the horizon is no direction
            const double mean = std::abs(series[w][p].front()) / mu_sum;
            for (const std::size_t at : {i, o}) {
                double& most = largest(Eigen::Index(at), Eigen::Index(w));
                most = std::max(most, mean);
            }
        });
    }
    largest.row(0) = largest.row(1);
    Eigen::VectorXd of_wavelength = largest.row(cosines - 1);
    const auto unit = [&](std::size_t i, std::size_t o, double mu_sum, std::size_t w) {
        return mu_sum * std::min(largest(Eigen::Index(i), Eigen::Index(w)),
                                 largest(Eigen::Index(o), Eigen::Index(w)));
    };
    orders_.assign(pairs, 1);
    first_row_.assign(pairs, 0);
    int rows = 0;
    each_pair([&](std::size_t p, std::size_t i, std::size_t o, double mu_sum) {
        for (std::size_t w = 0; w < wavelengths_; ++w) {
            const double allowed = kOrderTolerance * unit(i, o, mu_sum, w);
            orders_[p] = std::max(orders_[p], int(needed_orders(series[w][p], allowed)));
        }
        first_row_[p] = rows;
        rows += orders_[p];
    });
    Eigen::MatrixXd table = Eigen::MatrixXd::Zero(rows, Eigen::Index(wavelengths_));
    Eigen::VectorXd scale(rows);
    each_pair([&](std::size_t p, std::size_t i, std::size_t o, double mu_sum) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t w = 0; w < wavelengths_; ++w) {
            const double own = of_wavelength[Eigen::Index(w)];
            const auto count = std::min(series[w][p].size(), std::size_t(orders_[p]));
            for (std::size_t m = 0; m < count; ++m)
                table(first_row_[p] + Eigen::Index(m), Eigen::Index(w)) = series[w][p][m];
            if (own > 0.0) least = std::min(least, unit(i, o, mu_sum, w) / own);
        }
        scale.segment(first_row_[p], orders_[p]).setConstant(std::isfinite(least) ? least : 0.0);
    });
    multiple_ = reduce_rank(table, std::move(scale), std::move(of_wavelength), kRankTolerance);
}

}  // namespace miebrdf::report
