// How a CompactTable is filled from solved BRDFs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/solve/compact_table.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/solved_table.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"

namespace miebrdf {
namespace {

/// Share of the tolerance that each of these may take: basis columns that are left out (over the
/// largest value at an incidence), the last orders of a series that are left out (their sum), and
/// every second angle of the table of light scattered once.
constexpr double kShare = 1.0 / 8;
/// Slope parameter of the lobe that shows the mirror reflection of a smooth boundary in pictures.
constexpr double kMirrorAlpha = 0.02;
/// Samples in half a turn of light scattered once that is put into the series: 48 orders.
constexpr int kSamples = 64;

CompactTable::Lobe lobe_of(const rte::SurfaceOptions& options,
                           const std::vector<std::complex<double>>& index) {
    CompactTable::Lobe lobe{.ggx = options.distribution == rte::MicrofacetDistribution::ggx,
                            .alpha = options.beckmann_alpha,
                            .shadowing = options.shadowing,
                            .masking = {},
                            .fresnel = {},
                            .scale = {}};
    const rte::ShadowingOverCosines masking(options);
    const std::vector<double> nodes = half_sine_nodes(SmoothPart::kNodes);
    for (const double mu : nodes) lobe.masking.push_back(masking.cosine_over_masking(mu));
    const bool schlick = options.fresnel == rte::FresnelKind::schlick;
    lobe.fresnel.resize(Eigen::Index(index.size()), Eigen::Index(nodes.size()));
    for (std::size_t w = 0; w < index.size(); ++w) {
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            lobe.fresnel(Eigen::Index(w), Eigen::Index(k)) =
                schlick ? rte::schlick_reflectance(rte::normal_reflectance(index[w]), nodes[k])
                        : rte::fresnel_reflectance(index[w], nodes[k]);
        }
    }
    return lobe;
}

/// function(wavelength, cosine) of all wavelengths of the tables at the nodes of functions of one
/// cosine.
template <typename Function>
CompactTable::OfCosine tabulated(const std::vector<const SolvedTable*>& tables,
                                 const Function& function) {
    const std::vector<double> nodes = half_sine_nodes(SmoothPart::kNodes);
    std::vector<std::vector<double>> rows;
    for (const SolvedTable* table : tables) {
        for (const SolvedWavelength& at : table->wavelengths) {
            std::vector<double>& row = rows.emplace_back();
            for (const double mu : nodes) row.push_back(function(at, mu));
        }
    }
    CompactTable::OfCosine values(Eigen::Index(rows.size()), Eigen::Index(nodes.size()));
    for (std::size_t w = 0; w < rows.size(); ++w)
        values.row(Eigen::Index(w)) =
            Eigen::Map<const Eigen::RowVectorXd>(rows[w].data(), values.cols());
    return values;
}

/// Calls action(wavelength's place among all, its table, its place there, the part that has it).
template <typename Action>
void for_each_sharp(const std::vector<const SolvedTable*>& tables, const Action& action) {
    std::size_t first = 0;
    for (const SolvedTable* table : tables) {
        for (const SharpPart& part : table->sharp) {
            action(first, part);
            first += part.wavelengths();
        }
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
    const double q = std::min(CompactTable::kLastQ, 2.0 / std::max(sine, 1e-9));
    const double place = std::log(q / CompactTable::kFirstQ) /
                         std::log(CompactTable::kLastQ / CompactTable::kFirstQ) * (slants - 1);
    return std::clamp(int(place) - 3, 0, slants - 6);
}

/// The columns of a row that can be asked for.
auto columns_of_use(const Eigen::MatrixXd& table, Eigen::Index row, int slants) {
    const Eigen::Index wavelengths = table.cols() / slants;
    const int first = first_slant(int(row), int(table.rows()), slants);
    return Eigen::seqN(first * wavelengths, (slants - first) * wavelengths);
}

/// True if every second angle is enough: six of them describe what lies between.
bool half_as_many_will_do(const Eigen::MatrixXd& table, const Eigen::VectorXd& scale, int slants,
                          double tolerance) {
    const int count = int(table.rows() + 1) / 2;
    for (Eigen::Index row = 1; row < table.rows(); row += 2) {
        const SixNodes six(0.5 * double(row), std::size_t(count));
        const auto columns = columns_of_use(table, row, slants);
        Eigen::RowVectorXd error = -table(row, columns);
        for (std::size_t k = 0; k < SixNodes::kCount; ++k)
            error += six.weight[k] * table(2 * Eigen::Index(six.first + k), columns);
        if (!(error.cwiseAbs().maxCoeff() <= tolerance * scale[row])) return false;
    }
    return true;
}

Eigen::VectorXd row_scale(const Eigen::MatrixXd& table, int slants) {
    Eigen::VectorXd scale(table.rows());
    for (Eigen::Index row = 0; row < table.rows(); ++row)
        scale[row] = table(row, columns_of_use(table, row, slants)).cwiseAbs().maxCoeff();
    return scale;
}

/// Slants that no direction has at an angle may hold anything: they repeat the nearest one that
/// some direction has, a few nodes away from it (angles between the rows mix neighbours).
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

void CompactTable::add_surface(const Tables& tables) {
    std::vector<std::complex<double>> index;
    for (const SolvedTable* table : tables)
        index.insert(index.end(), table->scene.surface_index.begin(),
                     table->scene.surface_index.end());
    lobe_ = lobe_of(*tables.front()->scene.surface, index);
    // The product is what is known: shares are relative to those at the normal.
    in_ = tabulated(tables,
                    [](const SolvedWavelength& at, double mu) { return at.transmitted(mu, 1.0); });
    out_ = tabulated(tables, [](const SolvedWavelength& at, double mu) {
        return at.transmitted(1.0, mu) / at.transmitted(1.0, 1.0);
    });
}

void CompactTable::add_boundary(const Tables& tables) {
    const rte::Boundary& boundary = *tables.front()->scene.boundary;
    const bool rough = boundary.is_rough();
    if (!rough && tables.front()->part == BrdfPart::subsurface) return;
    std::vector<std::complex<double>> index;
    for (const SolvedTable* table : tables) {
        for (std::size_t w = 0; w < table->wavelengths.size(); ++w)
            index.emplace_back(table->scene.top_index(w));
    }
    lobe_ = lobe_of(
        {.beckmann_alpha = rough ? boundary.roughness : kMirrorAlpha,
         .distribution = rough ? boundary.distribution : rte::MicrofacetDistribution::beckmann},
        index);
    lobe_->only_in_pictures = !rough;
    if (rough)
        lobe_->scale = tabulated(
            tables, [](const SolvedWavelength& at, double mu) { return at.lobe_scale(mu); });
}

void CompactTable::add_single_scattering(const Tables& tables, const CompactOptions& options,
                                         const Control& control) {
    const double tolerance = options.tolerance;
    bool layered = false, any = false;
    for (const SolvedTable* table : tables) {
        for (const SolvedWavelength& at : table->wavelengths) {
            if (at.has_optical_steps() || at.stack().ground) return;  // in the series
            for (const rte::ScaledMedium& medium : at.stack().media) {
                any = true;
                layered = layered || std::isfinite(medium.scaled_optical_depth) ||
                          !medium.narrow.structure.empty();
            }
        }
    }
    if (!any) return;
    angles_ = options.angles;
    slants_ = layered ? options.slants : 1;
    const std::size_t count = wavelengths();
    Eigen::MatrixXd table(angles_, Eigen::Index(count) * slants_);
    run_parallel("light scattered once", std::size_t(slants_), control, [&](std::size_t slant) {
        const double q =
            kFirstQ * std::pow(kLastQ / kFirstQ, double(slant) / std::max(1, slants_ - 1));
        // Equal cosines of this q. The formula knows q and the scattering angle alone, so that the
        // cosine of an azimuth may be any number; at the normal itself every azimuth has one angle.
        const double mu = std::min(2.0 / q, 1.0 - 1e-4);
        std::vector<double> cos_azimuth;
        for (const double share : half_sine_nodes(std::size_t(angles_))) {
            const double cos_theta = std::cos(std::numbers::pi * share);
            cos_azimuth.push_back((cos_theta + mu * mu) / ((1.0 - mu) * (1.0 + mu)));
        }
        for_each_sharp(tables, [&](std::size_t first, const SharpPart& part) {
            Eigen::MatrixXd values(Eigen::Index(part.wavelengths()), angles_);
            part.first_order().evaluate(mu, mu, cos_azimuth,
                                        {values.data(), std::size_t(values.size())});
            table.middleCols(Eigen::Index(slant * count + first), values.rows()) =
                8.0 * mu * values.transpose();
        });
    });
    flatten_what_is_of_no_use(table, slants_);
    Eigen::VectorXd scale = row_scale(table, slants_);
    while (angles_ > 33 && half_as_many_will_do(table, scale, slants_, kShare * tolerance)) {
        angles_ = (angles_ + 1) / 2;
        const Eigen::MatrixXd every_other = table(Eigen::seqN(0, angles_, 2), Eigen::all);
        table = every_other;
        scale = row_scale(table, slants_);
    }
    // Half the share, over the largest value at an angle: there light scattered once may be small
    // at one incidence and large at another.
    single_scattering_ = reduce_rank(table, std::move(scale), Eigen::VectorXd::Ones(table.cols()),
                                     0.5 * kShare * tolerance, tolerance);
}

void CompactTable::add_multiple(const Tables& tables, int cosines, const CompactOptions& options,
                                const Control& control) {
    pair_cosines_ = cosines;
    std::vector<double> nodes = half_sine_nodes(std::size_t(cosines));
    nodes.front() = SmoothPart::nodes().front();
    std::vector<std::vector<std::vector<double>>> series(wavelengths());  // [wavelength][pair]
    const std::vector<double> cos_azimuth = cosines_of_azimuths(kSamples);
    const Eigen::MatrixXd to_orders = samples_to_orders(kSamples);
    struct Place {
        const SharpPart* part;
        std::size_t own;
    };
    std::vector<Place> places;
    for_each_sharp(tables, [&](std::size_t, const SharpPart& part) {
        for (std::size_t own = 0; own < part.wavelengths(); ++own) places.push_back({&part, own});
    });
    run_parallel("compact table", wavelengths(), control, [&](std::size_t w) {
        const auto [part, own] = places[w];
        const SolvedWavelength& at = part->wavelength(own);
        rte::SpectralFirstOrder::Scratch scratch;
        Eigen::RowVectorXd once(to_orders.rows()), orders;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            for (std::size_t o = i; o < nodes.size(); ++o) {
                std::vector<double>& a = series[w].emplace_back();
                at.smooth().series_at(nodes[i], nodes[o], a);
                const double surface = at.transmitted(nodes[i], nodes[o]);
                for (double& value : a) value *= surface > 0.0 ? 1.0 / surface : 0.0;
                if (angles_ == 0 && (!at.stack().media.empty() || at.stack().ground)) {
                    part->first_order().evaluate_alone(own, nodes[i], nodes[o], cos_azimuth,
                                                       {once.data(), cos_azimuth.size()}, scratch);
                    orders = once * to_orders;
                    a.resize(std::max(a.size(), std::size_t(orders.size())), 0.0);
                    for (Eigen::Index m = 0; m < orders.size(); ++m) a[std::size_t(m)] += orders[m];
                }
                for (double& value : a) value *= nodes[i] + nodes[o];
                if (!std::all_of(a.begin(), a.end(), [](double v) { return std::isfinite(v); })) {
                    throw InputError(fmt::format(
                        "no physical solution at {} nm; try other streams or a smaller tolerance",
                        wavelength_nm_[w]));
                }
                if (options.orders > 0 && a.size() > std::size_t(options.orders))
                    a.resize(std::size_t(options.orders));
            }
        }
    });
    keep_orders(series, cosines, options);
}

/// Errors of a pair of cosines count beside the largest value at either incidence; what is small
/// everywhere at a wavelength counts beside its own.
void CompactTable::keep_orders(const std::vector<std::vector<std::vector<double>>>& series,
                               int cosines, const CompactOptions& options) {
    const std::vector<double> nodes = half_sine_nodes(std::size_t(cosines));
    const auto pairs = std::size_t(cosines * (cosines + 1) / 2);
    const auto each_pair = [&](const auto& action) {
        std::size_t p = 0;
        for (int i = 0; i < cosines; ++i) {
            for (int o = i; o < cosines; ++o, ++p)
                action(p, std::size_t(i), std::size_t(o),
                       nodes[std::size_t(i)] + nodes[std::size_t(o)]);
        }
    };
    Eigen::MatrixXd largest = Eigen::MatrixXd::Zero(cosines, Eigen::Index(wavelengths()));
    for (std::size_t w = 0; w < wavelengths(); ++w) {
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
        for (std::size_t w = 0; w < wavelengths(); ++w) {
            const double allowed = kShare * options.tolerance * unit(i, o, mu_sum, w);
            orders_[p] = std::max(orders_[p], int(needed_orders(series[w][p], allowed)));
        }
        first_row_[p] = rows;
        rows += orders_[p];
    });
    Eigen::MatrixXd table = Eigen::MatrixXd::Zero(rows, Eigen::Index(wavelengths()));
    Eigen::VectorXd scale(rows);
    each_pair([&](std::size_t p, std::size_t i, std::size_t o, double mu_sum) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t w = 0; w < wavelengths(); ++w) {
            const double own = of_wavelength[Eigen::Index(w)];
            const auto count = std::min(series[w][p].size(), std::size_t(orders_[p]));
            for (std::size_t m = 0; m < count; ++m)
                table(first_row_[p] + Eigen::Index(m), Eigen::Index(w)) = series[w][p][m];
            if (own > 0.0) least = std::min(least, unit(i, o, mu_sum, w) / own);
        }
        scale.segment(first_row_[p], orders_[p]).setConstant(std::isfinite(least) ? least : 0.0);
    });
    multiple_ = reduce_rank(table, std::move(scale), std::move(of_wavelength),
                            kShare * options.tolerance, options.tolerance);
}

}  // namespace miebrdf
