#include "pipeline/report/page_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/report/half_sine_nodes.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/wavelength_table.h"

namespace miebrdf::report {
namespace {

constexpr double kPi = std::numbers::pi;

double at_nodes(const std::vector<double>& values, double mu) {
    const int count = int(values.size());
    const SixNodes six = six_nodes(half_sine_place(mu) * (count - 1), count);
    double sum = 0.0;
    for (std::size_t k = 0; k < 6; ++k) sum += six.weight[k] * values[std::size_t(six.first) + k];
    return sum;
}

/// First of the pairs (i, i), (i, i + 1), ... of a symmetric table.
int pair_index(int i, int o, int count) {
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

}  // namespace

PageTable::PageTable(const BrdfTable& table, double tolerance, const Control& control)
    : wavelengths_(table.wavelength_nm().size()) {
    const BrdfTable::State& state = table.state();
    if (state.scene.surface) add_surface(state);
    if (state.scene.boundary) add_boundary(state);
    add_once(state, control);
    for (const int cosines : {17, 25, 33, 41, 49}) {
        add_multiple(state, cosines, control);
        error_ = measure(table);
        if (error_ <= tolerance) return;
    }
}

double PageTable::measure(const BrdfTable& table) const {
    const Directions grid = check_directions();
    const std::vector<Direction> directions = all_of(grid);
    std::vector<double> exact(directions.size() * wavelengths_), here;
    table.evaluate(directions, exact);
    const std::size_t block = directions.size() / grid.mu_in.size();
    double worst = 0.0;
    for (std::size_t i = 0; i < grid.mu_in.size(); ++i) {
        std::vector<double> largest(wavelengths_, 0.0), error(wavelengths_, 0.0);
        for (std::size_t d = i * block; d < (i + 1) * block; ++d) {
            evaluate(directions[d], here);
            for (std::size_t w = 0; w < wavelengths_; ++w) {
                const double value = exact[d * wavelengths_ + w];
                largest[w] = std::max(largest[w], std::abs(value));
                error[w] = std::max(error[w], std::abs(here[w] - value));
            }
        }
        for (std::size_t w = 0; w < wavelengths_; ++w) {
            if (largest[w] > 0.0) worst = std::max(worst, error[w] / largest[w]);
        }
    }
    return worst;
}

void PageTable::evaluate(const Direction& direction, std::vector<double>& brdf) const {
    evaluate_layers(direction, brdf);
    if (lobe_ && !lobe_->only_in_pictures) add_lobe(direction, brdf);
}

void PageTable::evaluate_layers(const Direction& direction, std::vector<double>& brdf) const {
    Eigen::VectorXd reflection = scattered_more(direction) + scattered_once(direction);
    brdf.resize(wavelengths_);
    for (std::size_t w = 0; w < wavelengths_; ++w) {
        double value = reflection[Eigen::Index(w)] / kPi;
        if (!in_.empty())
            value *= at_nodes(in_[w], direction.mu_in) * at_nodes(out_[w], direction.mu_out);
        brdf[w] = value;
    }
}

double PageTable::let_in(std::size_t wavelength, double mu) const {
    return in_.empty() ? 1.0 : at_nodes(in_[wavelength], mu);
}

Eigen::VectorXd PageTable::scattered_more(const Direction& direction) const {
    const SixNodes in =
        six_nodes(half_sine_place(direction.mu_in) * (pair_cosines_ - 1), pair_cosines_);
    const SixNodes out =
        six_nodes(half_sine_place(direction.mu_out) * (pair_cosines_ - 1), pair_cosines_);
    const double azimuth = direction.azimuth_deg * kPi / 180.0;
    Eigen::VectorXd in_basis = Eigen::VectorXd::Zero(multiple_.basis.cols());
    for (int i = 0; i < 6; ++i) {
        for (int o = 0; o < 6; ++o) {
            const int pair = pair_index(in.first + i, out.first + o, pair_cosines_);
            const double weight = in.weight[std::size_t(i)] * out.weight[std::size_t(o)];
            for (int m = 0; m < orders_[std::size_t(pair)]; ++m) {
                const Eigen::Index row = first_row_[std::size_t(pair)] + m;
                in_basis += weight * std::cos(m * azimuth) * multiple_.scale[row] *
                            multiple_.basis.row(row).transpose();
            }
        }
    }
    return multiple_.column_scale.cwiseProduct(multiple_.coefficients.transpose() * in_basis) /
           (direction.mu_in + direction.mu_out);
}

Eigen::VectorXd PageTable::scattered_once(const Direction& direction) const {
    const auto count = Eigen::Index(wavelengths_);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(count);
    if (angles_ == 0) return sum;
    const double cos_theta = rte::cos_scattering_angle(
        direction.mu_in, direction.mu_out, std::cos(direction.azimuth_deg * kPi / 180.0));
    const SixNodes angle =
        six_nodes(half_sine_place(std::acos(cos_theta) / kPi) * (angles_ - 1), angles_);
    Eigen::VectorXi rows(6);
    Eigen::VectorXd weights(6);
    for (int k = 0; k < 6; ++k) {
        rows[k] = angle.first + k;
        weights[k] = angle.weight[std::size_t(k)];
    }
    const Eigen::VectorXd at_angle = once_.sum_of_rows(rows, weights);
    if (slants_ == 1) {
        sum = at_angle;
    } else {
        const double q = std::min(kLastQ, 1.0 / direction.mu_in + 1.0 / direction.mu_out);
        const SixNodes slant =
            six_nodes(std::log(q / kFirstQ) / std::log(kLastQ / kFirstQ) * (slants_ - 1), slants_);
        for (int k = 0; k < 6; ++k)
            sum +=
                slant.weight[std::size_t(k)] * at_angle.segment((slant.first + k) * count, count);
    }
    return sum / (4.0 * (direction.mu_in + direction.mu_out));
}

void PageTable::add_lobe(const Direction& direction, std::vector<double>& brdf) const {
    const double a = direction.mu_in, b = direction.mu_out;
    const double cos_theta =
        rte::cos_scattering_angle(a, b, std::cos(direction.azimuth_deg * kPi / 180.0));
    // cos Theta is that between the way in and the way out: |in + out|^2 = 2 - 2 cos Theta.
    const double length = std::sqrt(std::max(1e-12, 2.0 - 2.0 * cos_theta));
    const double cos_facet = 0.5 * length, cos_half = std::min(1.0, (a + b) / length);
    const double cos2 = cos_half * cos_half;
    const double t = (1.0 - cos_half) * (1.0 + cos_half) / cos2 / (lobe_->alpha * lobe_->alpha);
    const double density = (lobe_->ggx ? 1.0 / ((1.0 + t) * (1.0 + t)) : std::exp(-t)) /
                           (kPi * lobe_->alpha * lobe_->alpha * cos2 * cos2);
    const double in = at_nodes(lobe_->masking, a), out = at_nodes(lobe_->masking, b);
    double shadowing = 1.0 / (in * out);  // G / (mu_in mu_out)
    if (lobe_->shadowing == rte::Shadowing::smith_correlated)
        shadowing = 1.0 / (in * b + out * a - a * b);
    if (lobe_->shadowing == rte::Shadowing::v_cavity)
        shadowing = std::min(1.0, 2.0 * cos_half * std::min(a, b) / cos_facet) / (a * b);
    for (std::size_t w = 0; w < wavelengths_; ++w) {
        double value = 0.25 * density * shadowing * at_nodes(lobe_->fresnel[w], cos_facet);
        if (!lobe_->scale.empty())
            value *= at_nodes(lobe_->scale[w], a) * at_nodes(lobe_->scale[w], b);
        brdf[w] += value;
    }
}

}  // namespace miebrdf::report
