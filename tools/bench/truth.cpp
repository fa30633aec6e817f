#include "tools/bench/truth.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "materials/readers/text.h"

namespace miebrdf::bench {

ReferenceData::ReferenceData(const std::string& name) : name_(name) {
    const char* text = built_in_table(name);
    if (text == nullptr) throw std::logic_error("no built-in reference table " + name);
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line[0] == '#') continue;
        auto fields = materials::split_fields(line);
        if (!columns_.empty()) {
            rows_.push_back(std::move(fields));
            continue;
        }
        for (std::size_t i = 0; i < fields.size(); ++i) columns_[fields[i]] = i;
    }
}

const std::string& ReferenceData::text(std::size_t row, const std::string& column) const {
    return rows_.at(row).at(columns_.at(column));
}

double ReferenceData::number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
}

std::size_t ReferenceData::row(const std::vector<Where>& wanted) const {
    const auto fits = [&](std::size_t row, const Where& where) {
        const std::string& field = text(row, where.column);
        const auto* value = std::get_if<double>(&where.value);
        if (value == nullptr) return field == std::get<std::string>(where.value);
        return !field.empty() && std::strtod(field.c_str(), nullptr) == *value;
    };
    for (std::size_t row = 0; row < size(); ++row) {
        if (std::all_of(wanted.begin(), wanted.end(), [&](auto& w) { return fits(row, w); }))
            return row;
    }
    throw std::logic_error("reference table " + name_ + " lacks a row");
}

namespace {

using std::numbers::pi;

double beckmann(double cos_half, double alpha) {
    const double cos2 = cos_half * cos_half;
    return std::exp((cos2 - 1) / (cos2 * alpha * alpha)) / (pi * alpha * alpha * cos2 * cos2);
}

double smith_lambda(double mu, double alpha) {
    if (mu >= 1) return 0;
    const double a = mu / (alpha * std::sqrt(1 - mu * mu));
    return 0.5 * (std::exp(-a * a) / (a * std::sqrt(pi)) - std::erfc(a));
}

double fresnel(double cosine, std::complex<double> index) {
    const auto root = std::sqrt(index * index - (1 - cosine * cosine));
    const auto s = (cosine - root) / (cosine + root);
    const auto p = (index * index * cosine - root) / (index * index * cosine + root);
    return 0.5 * (std::norm(s) + std::norm(p));
}

}  // namespace

double textbook_reflectance(double alpha, std::complex<double> index, double mu_in) {
    using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;
    constexpr unsigned kDepth = 12;
    const double sin_in = std::sqrt(1 - mu_in * mu_in);
    const double lambda_in = smith_lambda(mu_in, alpha);
    const auto ring = [&](double mu) {
        const double sine = std::sqrt(1 - mu * mu), lambda = smith_lambda(mu, alpha);
        const auto lobe = [&](double azimuth) {
            // Half of the angle between the rays; azimuth 0 is the mirror's side.
            const double between = mu * mu_in - sine * sin_in * std::cos(azimuth);
            const double cos_facet = std::sqrt(0.5 * (1 + between));
            const double cos_half = std::min(1.0, (mu + mu_in) / (2 * cos_facet));
            return beckmann(cos_half, alpha) * fresnel(cos_facet, index);
        };
        // dOmega = 2 dmu dphi over half the azimuths; mu_out cancels the one in the denominator.
        return 2 * Quadrature::integrate(lobe, 0.0, pi, kDepth, 1e-12) /
               ((1 + lambda_in + lambda) * 4 * mu_in);
    };
    // mu = t^2: near the horizon masking behaves like a power of mu.
    return Quadrature::integrate([&](double t) { return 2 * t * ring(t * t); }, 0.0, 1.0, kDepth,
                                 1e-11);
}

}  // namespace miebrdf::bench
