#include "pipeline/solve/compact_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/solve/solved_table.h"

namespace miebrdf {
namespace {

/// A function of a cosine at all wavelengths.
Eigen::VectorXd at_nodes(const CompactTable::OfCosine& function, double mu) {
    const SixNodes six = SixNodes::around(mu, SmoothPart::kNodes);
    const Eigen::Map<const Eigen::Matrix<double, 6, 1>> weight(six.weight.data());
    return function.middleCols<6>(Eigen::Index(six.first)) * weight;
}

/// First of the pairs (i, i), (i, i + 1), ... of a symmetric table.
std::size_t pair_index(std::size_t i, std::size_t o, std::size_t count) {
    if (i > o) std::swap(i, o);
    return i * count - i * (i - 1) / 2 + (o - i);
}

/// Steep and shallow directions between the nodes of every table, the same at every call.
Directions check_directions() {
    Directions d;
    for (int i = 0; i < 7; ++i) {
        d.mu_in.push_back(0.06 + 0.155 * i);
        d.mu_out.push_back(0.045 + 0.157 * i);
    }
    d.azimuth_deg = {0.0, 3.0, 22.0, 58.0, 91.0, 127.0, 158.0, 179.0, 180.0};
    return d;
}

std::vector<Direction> all_of(const Directions& d) {
    std::vector<Direction> all;
    for (const double mu_in : d.mu_in) {
        for (const double mu_out : d.mu_out) {
            for (const double azimuth : d.azimuth_deg) all.push_back({mu_in, mu_out, azimuth});
        }
    }
    return all;
}

/// The largest error at an incidence, relative to the largest value of its wavelength there.
double largest_error(const Eigen::MatrixXd& found, const Eigen::MatrixXd& exact) {
    double worst = 0.0;
    for (Eigen::Index w = 0; w < exact.rows(); ++w) {
        const double largest = exact.row(w).cwiseAbs().maxCoeff();
        if (largest > 0.0)
            worst = std::max(worst, (found.row(w) - exact.row(w)).cwiseAbs().maxCoeff() / largest);
    }
    return worst;
}

}  // namespace

void CompactTable::Rows::set(const LowRank& table) {
    const Eigen::Index rank = table.basis.cols(), lane = Lane::SizeAtCompileTime,
                       filled = (rank + lane - 1) / lane * lane;
    basis = Eigen::MatrixXf::Zero(filled, table.basis.rows());
    basis.topRows(rank) = (table.scale.asDiagonal() * table.basis).transpose().cast<float>();
    coefficients = Eigen::MatrixXf::Zero(table.coefficients.cols(), filled);
    coefficients.leftCols(rank) =
        (table.coefficients * table.column_scale.asDiagonal()).transpose().cast<float>();
}

CompactTable::CompactTable(std::span<const BrdfTable> tables, const CompactOptions& options,
                           const Control& control) {
    if (tables.empty()) throw UsageError("no wavelength to tabulate");
    if (options.cosines != 0 &&
        !(options.cosines >= 6 && options.cosines <= int(SmoothPart::kNodes)))
        throw UsageError("cosines", options.cosines, "6 to 49, or 0 to choose by the tolerance");
    if (!(options.orders >= 0)) throw UsageError("orders", options.orders, "0 or more");
    if (!(options.tolerance > 0.0)) throw UsageError("tolerance", options.tolerance, "> 0");
    Tables solved;
    for (const BrdfTable& table : tables) {
        solved.push_back(&table.solved());
        for (const double nm : table.wavelength_nm()) wavelength_nm_.push_back(nm);
    }
    const SolvedTable& first = *solved.front();
    if (first.scene.surface && first.part != BrdfPart::subsurface) add_surface(solved);
    if (first.scene.boundary) add_boundary(solved);
    add_single_scattering(solved, options, control);
    single_rows_.set(single_scattering_);
    std::vector<int> sizes = {17, 25, 33, 41, int(SmoothPart::kNodes)};
    if (options.cosines != 0) sizes = {options.cosines};
    for (const int cosines : sizes) {
        add_multiple(solved, cosines, options, control);
        multiple_rows_.set(multiple_);
        if (!options.is_measured) return;
        error_ = measure(tables);
        if (error_ <= options.tolerance) return;
    }
}

double CompactTable::measure(std::span<const BrdfTable> tables) const {
    const Directions grid = check_directions();
    const std::vector<Direction> directions = all_of(grid);
    const auto count = Eigen::Index(directions.size());
    Eigen::MatrixXd exact(Eigen::Index(wavelengths()), count), found(exact.rows(), count);
    Eigen::Index first = 0;
    for (const BrdfTable& table : tables) {
        Eigen::MatrixXd own(Eigen::Index(table.wavelength_nm().size()), count);
        table.evaluate(directions, {own.data(), std::size_t(own.size())});
        exact.middleRows(first, own.rows()) = own;
        first += own.rows();
    }
    for (Eigen::Index d = 0; d < count; ++d) {
        const auto& [mu_in, mu_out, azimuth_deg] = directions[std::size_t(d)];
        evaluate(mu_in, mu_out, std::cos(azimuth_deg * std::numbers::pi / 180.0),
                 {found.col(d).data(), wavelengths()});
    }
    const Eigen::Index block = count / Eigen::Index(grid.mu_in.size());
    double worst = 0.0;
    for (Eigen::Index d = 0; d < count; d += block)
        worst =
            std::max(worst, largest_error(found.middleCols(d, block), exact.middleCols(d, block)));
    return worst;
}

void CompactTable::evaluate(double mu_in, double mu_out, double cos_azimuth, std::span<double> brdf,
                            Lobes lobes) const {
    evaluate_layers(mu_in, mu_out, cos_azimuth, brdf);
    if (lobe_ && (lobes == Lobes::of_pictures || !lobe_->only_in_pictures))
        add_lobe(mu_in, mu_out, cos_azimuth, brdf);
}

void CompactTable::evaluate_layers(double mu_in, double mu_out, double cos_azimuth,
                                   std::span<double> brdf) const {
    Eigen::Map<Eigen::VectorXd> values(brdf.data(), Eigen::Index(wavelengths()));
    values = ((scattered_repeatedly(mu_in, mu_out, cos_azimuth) +
               scattered_singly(mu_in, mu_out, cos_azimuth)) /
              float(std::numbers::pi * (mu_in + mu_out)))
                 .cast<double>();
    if (in_.size() > 0)
        values.array() *= at_nodes(in_, mu_in).array() * at_nodes(out_, mu_out).array();
}

double CompactTable::let_in(std::size_t wavelength, double mu) const {
    return in_.size() == 0 ? 1.0 : at_nodes(in_, mu)[Eigen::Index(wavelength)];
}

/// Times mu_in + mu_out.
Eigen::VectorXf CompactTable::scattered_repeatedly(double mu_in, double mu_out,
                                                   double cos_azimuth) const {
    const auto count = std::size_t(pair_cosines_);
    const SixNodes in = SixNodes::around(mu_in, count), out = SixNodes::around(mu_out, count);
    // cos(m azimuth).
    Eigen::ArrayXf harmonics(*std::max_element(orders_.begin(), orders_.end()));
    double before = cos_azimuth, here = 1.0;
    for (float& harmonic : harmonics) {
        harmonic = float(here);
        const double next = 2.0 * cos_azimuth * here - before;
        before = here;
        here = next;
    }
    Eigen::VectorXf in_basis = Eigen::VectorXf::Zero(multiple_rows_.basis.rows());
    for (std::size_t i = 0; i < SixNodes::kCount; ++i) {
        for (std::size_t o = 0; o < SixNodes::kCount; ++o) {
            const std::size_t pair = pair_index(in.first + i, out.first + o, count);
            const auto weight = float(in.weight[i] * out.weight[o]);
            for (Eigen::Index lane = 0; lane < multiple_rows_.lanes(); ++lane) {
                Rows::Lane sum = Rows::Lane::Zero();
                for (int m = 0; m < orders_[pair]; ++m)
                    sum += harmonics[m] * multiple_rows_.lane_of(first_row_[pair] + m, lane);
                in_basis
                    .segment<Rows::Lane::SizeAtCompileTime>(lane * Rows::Lane::SizeAtCompileTime)
                    .array() += weight * sum;
            }
        }
    }
    return multiple_rows_.coefficients * in_basis;
}

/// Times mu_in + mu_out.
Eigen::VectorXf CompactTable::scattered_singly(double mu_in, double mu_out,
                                               double cos_azimuth) const {
    const auto count = Eigen::Index(wavelengths());
    Eigen::VectorXf sum = Eigen::VectorXf::Zero(count);
    if (angles_ == 0) return sum;
    const double theta = std::acos(rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth));
    const SixNodes angle = SixNodes::around(theta / std::numbers::pi, std::size_t(angles_));
    Eigen::VectorXf in_basis = Eigen::VectorXf::Zero(single_rows_.basis.rows());
    for (std::size_t k = 0; k < SixNodes::kCount; ++k)
        in_basis += float(angle.weight[k]) * single_rows_.basis.col(Eigen::Index(angle.first + k));
    if (slants_ == 1) {
        sum = single_rows_.coefficients * in_basis;
    } else {
        const double q = std::min(kLastQ, 1.0 / mu_in + 1.0 / mu_out);
        const SixNodes slant(std::log(q / kFirstQ) / std::log(kLastQ / kFirstQ) * (slants_ - 1),
                             std::size_t(slants_));
        const Eigen::VectorXf at_slants =
            single_rows_.coefficients.middleRows(Eigen::Index(slant.first) * count, 6 * count) *
            in_basis;
        for (std::size_t k = 0; k < SixNodes::kCount; ++k)
            sum += float(slant.weight[k]) * at_slants.segment(Eigen::Index(k) * count, count);
    }
    return sum / 4.0F;
}

void CompactTable::add_lobe(double mu_in, double mu_out, double cos_azimuth,
                            std::span<double> brdf) const {
    const double cos_theta = rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    // cos Theta is that between the way in and the way out: |in + out|^2 = 2 - 2 cos Theta.
    const double length = std::sqrt(std::max(1e-12, 2.0 - 2.0 * cos_theta));
    const double cos_facet = 0.5 * length, cos_half = std::min(1.0, (mu_in + mu_out) / length);
    const double cos2 = cos_half * cos_half, alpha2 = lobe_->alpha * lobe_->alpha;
    const double t = (1.0 - cos_half) * (1.0 + cos_half) / cos2 / alpha2;
    const double density = (lobe_->ggx ? 1.0 / ((1.0 + t) * (1.0 + t)) : std::exp(-t)) /
                           (std::numbers::pi * alpha2 * cos2 * cos2);
    const double in = at_cosine(lobe_->masking, mu_in), out = at_cosine(lobe_->masking, mu_out);
    double shadowing = 1.0 / (in * out);  // G / (mu_in mu_out)
    if (lobe_->shadowing == rte::Shadowing::smith_correlated)
        shadowing = 1.0 / (in * mu_out + out * mu_in - mu_in * mu_out);
    if (lobe_->shadowing == rte::Shadowing::v_cavity)
        shadowing =
            std::min(1.0, 2.0 * cos_half * std::min(mu_in, mu_out) / cos_facet) / (mu_in * mu_out);
    Eigen::VectorXd lobe = 0.25 * density * shadowing * at_nodes(lobe_->fresnel, cos_facet);
    if (lobe_->scale.size() > 0)
        lobe.array() *=
            at_nodes(lobe_->scale, mu_in).array() * at_nodes(lobe_->scale, mu_out).array();
    Eigen::Map<Eigen::VectorXd>(brdf.data(), lobe.size()) += lobe;
}

}  // namespace miebrdf
