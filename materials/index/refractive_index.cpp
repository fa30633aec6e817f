#include <miebrdf/index.h>

#include <fmt/format.h>
#include <math.h>  // Boost 1.74 calls ::isnan in pchip.hpp

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>

#include <miebrdf/error.h>
#include "materials/index/series.h"

namespace miebrdf::materials {

using Pchip = boost::math::interpolators::pchip<std::vector<double>>;

static double energy_ev(double wavelength_nm) { return from_nm(wavelength_nm, Unit::electronvolt); }

// An end of a range counts as inside when only rounding separates it from the wavelength: of sums
// (900.0000000000001), or of hc (1239.841984 or 1239.84198433 eV nm: 1.5 eV is 826.561322667 or
// 826.561322888 nm, a relative difference of 2.7e-10).
static bool within(double wavelength_nm, double shortest_nm, double longest_nm) {
    constexpr double kRounding = 1e-9;
    return shortest_nm * (1 - kRounding) <= wavelength_nm &&
           wavelength_nm <= longest_nm * (1 + kRounding);
}

/// One series ready to be evaluated inside its range.
class IndexCurve {
  public:
    IndexCurve(Series series, char quantity, Interpolation interpolation)
        : series_(std::move(series)) {
        check_series(series_, quantity);
        if (!series_.tabulated()) return;
        in_wavelength_ = interpolation == Interpolation::linear_in_wavelength;
        x_ = series_.wavelengths_nm();
        y_ = series_.y;
        if (in_wavelength_) return;
        std::transform(x_.begin(), x_.end(), x_.begin(), energy_ev);
        std::reverse(x_.begin(), x_.end());
        std::reverse(y_.begin(), y_.end());
        if (interpolation == Interpolation::pchip && x_.size() >= 4) {
            pchip_.emplace(std::vector<double>(x_), std::vector<double>(y_));
        }
    }

    const Series& series() const { return series_; }

    double at(double wavelength_nm) const {
        if (!series_.tabulated()) {
            return dispersion_formula(series_.formula, series_.y, wavelength_nm / 1000.0);
        }
        const double x = std::clamp(in_wavelength_ ? wavelength_nm : energy_ev(wavelength_nm),
                                    x_.front(), x_.back());
        const auto above = std::upper_bound(x_.begin(), x_.end(), x);
        if (above == x_.end()) return y_.back();
        const std::size_t i = static_cast<std::size_t>(above - x_.begin());
        if (x == x_[i - 1]) return y_[i - 1];  // tabulated rows come back bit for bit
        const double lower = std::min(y_[i - 1], y_[i]);
        const double upper = std::max(y_[i - 1], y_[i]);
        const double t = (x - x_[i - 1]) / (x_[i] - x_[i - 1]);
        const double value = pchip_ ? (*pchip_)(x) : y_[i - 1] + t * (y_[i] - y_[i - 1]);
        return std::clamp(value, lower, upper);  // monotone, so this removes rounding only
    }

  private:
    Series series_;
    bool in_wavelength_ = false;
    std::vector<double> x_, y_;
    std::optional<Pchip> pchip_;
};

static bool is_index(std::complex<double> m) {
    return m.real() > 0 && m.real() <= kLargestIndex && m.imag() >= 0 && m.imag() <= kLargestIndex;
}

struct RefractiveIndex::State {
    std::string material;
    std::optional<IndexCurve> n;  // nothing: the function says it
    std::optional<IndexCurve> k;
    std::optional<IndexFunction> function;
    IndexOptions options;
    std::vector<Coverage> alternatives;
    double shortest_nm = 0.0;
    double longest_nm = 0.0;

    /// The value of the data inside their range, which need not be a refractive index.
    std::complex<double> value(double wavelength_nm) const {
        if (function) return function->at(wavelength_nm);
        const bool has_k =
            k && within(wavelength_nm, k->series().shortest_nm, k->series().longest_nm);
        return {n->at(wavelength_nm), has_k ? k->at(wavelength_nm) : 0.0};
    }

    std::string allowed() const { return fmt::format("{} to {} nm", shortest_nm, longest_nm); }

    InputError refusal(const std::string& message, double wavelength_nm) const {
        return {message, "wavelength_nm", fmt::format("{}", wavelength_nm), allowed()};
    }

    std::string out_of_range_message(double wavelength_nm) const {
        std::string message = fmt::format("{}: {} nm is outside its data; allowed: {}", material,
                                          wavelength_nm, allowed());
        if (n && k && n->series().shortest_nm <= wavelength_nm &&
            wavelength_nm <= n->series().longest_nm) {
            message += fmt::format(" (n is known from {} to {} nm, k is not)",
                                   n->series().shortest_nm, n->series().longest_nm);
        }
        // A wavelength in micrometres where nanometres are meant.
        if (within(1e3 * wavelength_nm, shortest_nm, longest_nm))
            message += fmt::format("; {} um is written {}um", wavelength_nm, wavelength_nm);
        std::string others;
        for (const Coverage& other : alternatives) {
            if (other.shortest_nm <= wavelength_nm && wavelength_nm <= other.longest_nm) {
                others += fmt::format("{}{} ({} to {} nm)", others.empty() ? "" : ", ", other.name,
                                      other.shortest_nm, other.longest_nm);
            }
        }
        return others.empty() ? message : message + "; covered by " + others;
    }
};

RefractiveIndex::RefractiveIndex(std::string material, IndexTable table)
    : RefractiveIndex(
          std::move(material), make_table(Unit::nanometre, table.wavelength_nm, table.n),
          table.k_known ? std::optional(make_table(Unit::nanometre, table.wavelength_nm, table.k))
                        : std::nullopt) {
    if (!table.k_known &&
        std::any_of(table.k.begin(), table.k.end(), [](double k) { return k != 0; })) {
        throw InputError(state_->material + ": k is declared unknown but has values");
    }
}

RefractiveIndex::RefractiveIndex(std::string material, std::optional<Series> n,
                                 std::optional<Series> k, const IndexOptions& options,
                                 std::vector<Coverage> alternatives) {
    if (!n) throw InputError(material + ": gives k only, n is unknown");
    double shortest_nm = n->shortest_nm;
    double longest_nm = n->longest_nm;
    if (k && !options.missing_k_is_zero) {
        shortest_nm = std::max(shortest_nm, k->shortest_nm);
        longest_nm = std::min(longest_nm, k->longest_nm);
        if (shortest_nm > longest_nm) {
            throw InputError(fmt::format(
                "{}: n ({} to {} nm) and k ({} to {} nm) have no wavelength in common", material,
                n->shortest_nm, n->longest_nm, k->shortest_nm, k->longest_nm));
        }
    }
    try {
        std::optional<IndexCurve> k_curve;
        if (k) k_curve.emplace(std::move(*k), 'k', options.interpolation);
        state_ = std::make_shared<const State>(State{
            material, IndexCurve(std::move(*n), 'n', options.interpolation), std::move(k_curve),
            std::nullopt, options, std::move(alternatives), shortest_nm, longest_nm});
    } catch (const InputError& error) {
        throw InputError(material + ": " + error.what());
    }
}

RefractiveIndex::RefractiveIndex(std::string material, IndexFunction function,
                                 const IndexOptions& options) {
    const double shortest_nm = function.shortest_nm, longest_nm = function.longest_nm;
    state_ = std::make_shared<const State>(State{std::move(material),
                                                 std::nullopt,
                                                 std::nullopt,
                                                 std::move(function),
                                                 options,
                                                 {},
                                                 shortest_nm,
                                                 longest_nm});
}

std::complex<double> RefractiveIndex::at(double wavelength_nm) const {
    const State& s = *state_;
    if (!(wavelength_nm > 0 && std::isfinite(wavelength_nm))) {
        throw s.refusal(fmt::format("{}: wavelength {} nm; allowed: {}", s.material, wavelength_nm,
                                    s.allowed()),
                        wavelength_nm);
    }
    const bool inside = covers(wavelength_nm);
    if (!inside && s.options.extrapolation == Extrapolation::refuse) {
        throw s.refusal(s.out_of_range_message(wavelength_nm), wavelength_nm);
    }
    const double used_nm = std::clamp(wavelength_nm, s.shortest_nm, s.longest_nm);
    const std::complex<double> m = s.value(used_nm);
    if (is_index(m)) return m;
    throw s.refusal(
        s.function
            ? fmt::format(
                  "{}: n + ik is {} + {}i at {} nm; allowed: n > 0, k >= 0, both up to {:g}{}",
                  s.material, m.real(), m.imag(), used_nm, kLargestIndex, s.function->advice)
            : fmt::format("{}: its dispersion formula {} has no real value at {} nm", s.material,
                          s.n->series().formula, used_nm),
        wavelength_nm);
}

double RefractiveIndex::shortest_nm() const { return state_->shortest_nm; }
double RefractiveIndex::longest_nm() const { return state_->longest_nm; }
bool RefractiveIndex::k_known() const {
    return state_->function ? state_->function->k_known : state_->k.has_value();
}

bool RefractiveIndex::k_known_at(double wavelength_nm) const {
    if (!state_->k) return k_known();
    const Series& k = state_->k->series();
    return within(wavelength_nm, k.shortest_nm, k.longest_nm);
}

bool RefractiveIndex::covers(double wavelength_nm) const {
    return within(wavelength_nm, state_->shortest_nm, state_->longest_nm);
}

IndexTable RefractiveIndex::table() const {
    IndexTable table;
    table.k_known = k_known();
    std::vector<double>& grid = table.wavelength_nm;
    const auto add = [&](const Series& series) {
        for (const double w : series.wavelengths_nm()) {
            if (covers(w)) grid.push_back(w);
        }
    };
    if (state_->function) grid = state_->function->grid_nm;
    if (state_->n) add(state_->n->series());
    if (state_->k) add(state_->k->series());
    if (state_->n && !state_->n->series().tabulated()) {
        const double high = energy_ev(shortest_nm());
        const double low = energy_ev(longest_nm());
        for (int i = 1; i < 200; ++i) grid.push_back(energy_ev(high + (low - high) * i / 200.0));
        grid.insert(grid.end(), {shortest_nm(), longest_nm()});
    }
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    // Where a formula or model has no value, its table has no row.
    if (state_->function || !state_->n->series().tabulated())
        std::erase_if(grid, [&](double w) { return !is_index(state_->value(w)); });
    if (grid.empty()) at(shortest_nm());
    for (const double w : grid) {
        const std::complex<double> m = at(w);
        table.n.push_back(m.real());
        table.k.push_back(m.imag());
    }
    return table;
}

}  // namespace miebrdf::materials
