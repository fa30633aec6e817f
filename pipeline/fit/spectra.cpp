#include "pipeline/fit/spectra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace miebrdf::fitting {
namespace {

/// Spectra with no more wavelengths are solved at each.
constexpr std::size_t kMostSolved = 100;

/// Bands of absorption are wider: the first wavelengths are no farther apart.
constexpr double kFirstSpacingNm = 16.0;

/// Where an axis is off or values are means over bands, others may be solved between the measured
/// ones: where interpolation needs them, down to this spacing.
constexpr double kSpacingNm = 2.0;

/// A mean over a band takes so many points, a quarter of its width apart: the weight of a Gaussian
/// 1.5 widths away is 0.002.
constexpr int kBandPoints = 13;

/// Halving the spacing divides the error of a cubic by 16; half of that is counted on.
constexpr double kGainOfHalving = 8.0;

/// Errors are relative to a value, and to no less than this share of the spectrum's largest.
constexpr double kFaint = 0.01;

/// The four neighbours of a wavelength that lie closest together, and their Lagrange polynomials.
struct Stencil {
    std::size_t first = 0, count = 0;
    std::array<double, 4> weight = {}, slope = {};
};

Stencil stencil_at(std::span<const double> nm, double x) {
    Stencil s;
    s.count = std::min<std::size_t>(4, nm.size());
    const auto above = std::size_t(std::upper_bound(nm.begin(), nm.end(), x) - nm.begin());
    double least = INFINITY;
    for (std::size_t back = 1; back < std::max<std::size_t>(s.count, 2); ++back) {
        const std::size_t first = std::min(above > back ? above - back : 0, nm.size() - s.count);
        const double span = nm[first + s.count - 1] - nm[first];
        // Of windows as wide as each other that in whose middle x lies.
        const double off = std::abs(nm[first] + nm[first + s.count - 1] - 2.0 * x);
        if (span + 1e-3 * off < least) {
            least = span + 1e-3 * off;
            s.first = first;
        }
    }
    for (std::size_t i = 0; i < s.count; ++i) {
        double product = 1.0, sum = 0.0;
        for (std::size_t j = 0; j < s.count; ++j) {
            if (j == i) continue;
            const double distance = nm[s.first + i] - nm[s.first + j];
            double others = 1.0 / distance;
            for (std::size_t k = 0; k < s.count; ++k) {
                if (k != i && k != j)
                    others *= (x - nm[s.first + k]) / (nm[s.first + i] - nm[s.first + k]);
            }
            product *= (x - nm[s.first + j]) / distance;
            sum += others;
        }
        s.weight[i] = product;
        s.slope[i] = sum;
    }
    return s;
}

double reach_of(const Job::Reading& reading) {
    const double shift = reading.shift ? kLargestShiftNm : std::abs(reading.shift_nm);
    return shift + 0.125 * (kBandPoints - 1) * reading.band_width_nm;
}

/// Everything that may be asked for, in steps that interpolation can do with.
std::vector<double> finest_of(const Job& job) {
    std::vector<double> nm = job.wavelength_nm;
    std::sort(nm.begin(), nm.end());
    double reach = 0.0;
    for (const Job::Reading& reading : job.readings) reach = std::max(reach, reach_of(reading));
    if (reach == 0.0) return nm;
    std::vector<double> all;
    const auto add_up_to = [&](double end) {
        const double begin = all.back(), steps = std::ceil((end - begin) / kSpacingNm);
        for (int i = 1; i < int(steps); ++i) all.push_back(begin + (end - begin) * i / steps);
        all.push_back(end);
    };
    all.push_back(nm.front() - reach);
    for (std::size_t i = 0; i < nm.size(); ++i) {
        if (i > 0 && nm[i] - nm[i - 1] > 2.0 * reach) {
            add_up_to(nm[i - 1] + reach);
            all.push_back(nm[i] - reach);
        }
        add_up_to(nm[i]);
    }
    add_up_to(nm.back() + reach);
    return all;
}

bool is_same_spectrum(const Job::Use& a, const Job::Use& b) {
    return a.quantity == b.quantity && a.geometry == b.geometry && a.in == b.in && a.out == b.out &&
           a.azimuth == b.azimuth && a.of_spheres == b.of_spheres;
}

}  // namespace

std::vector<SolvedShare> parts_of(const Job& job, const Job::Reading& reading, double shift_nm) {
    if (!job.is_interpolated()) return {{reading.use, 1.0, 0.0}};
    const std::size_t begin = reading.use * job.wavelength_nm.size();
    const int points = reading.band_width_nm > 0.0 ? kBandPoints : 1, middle = points / 2;
    std::vector<SolvedShare> parts;
    double sum = 0.0;
    for (int k = 0; k < points; ++k) {
        const double off = 0.25 * (k - middle);  // in widths
        const double weight = std::exp(-4.0 * std::numbers::ln2 * off * off);
        const double nm =
            reading.wavelength_nm + reading.shift_nm + shift_nm + off * reading.band_width_nm;
        const Stencil s = stencil_at(job.wavelength_nm, nm);
        for (std::size_t i = 0; i < s.count; ++i)
            parts.push_back({begin + s.first + i, weight * s.weight[i], weight * s.slope[i]});
        sum += weight;
    }
    for (SolvedShare& part : parts) {
        part.weight /= sum;
        part.slope /= sum;
    }
    return parts;
}

void interpolate_spectra(Job& job) {
    if (job.kind == Kind::lab || job.only_wavelength) return;
    const bool is_read_otherwise =
        std::any_of(job.readings.begin(), job.readings.end(),
                    [](const Job::Reading& reading) { return reach_of(reading) > 0.0; });
    if (!is_read_otherwise && job.wavelength_nm.size() <= kMostSolved) return;
    for (Job::Reading& reading : job.readings) {
        const Job::Use& use = job.uses[reading.use];
        auto spectrum =
            std::find_if(job.spectra.begin(), job.spectra.end(),
                         [&](const Job::Use& known) { return is_same_spectrum(known, use); });
        if (spectrum == job.spectra.end()) {
            job.spectra.push_back(use);
            spectrum = job.spectra.end() - 1;
        }
        reading.use = std::size_t(spectrum - job.spectra.begin());
    }
    job.finest_nm = finest_of(job);
    std::vector<double> first = {job.finest_nm.front()};
    for (std::size_t i = 1; i < job.finest_nm.size(); ++i) {
        if (i + 1 == job.finest_nm.size() || job.finest_nm[i + 1] - first.back() > kFirstSpacingNm)
            first.push_back(job.finest_nm[i]);
    }
    job.set_wavelengths(std::move(first));
}

std::vector<double> chosen_wavelengths(const Job& job, double relative_error,
                                       const SolveAt& solve) {
    struct At {
        double nm;
        std::vector<double> values;  ///< of the spectra
        bool is_open = true;         ///< whether to look halfway to the next
    };
    std::vector<At> all;
    const auto solved_at = [&](const std::vector<double>& nm) {
        const std::vector<double> values = solve(nm);
        std::vector<At> solved;
        for (std::size_t w = 0; w < nm.size(); ++w) {
            At at{nm[w], {}};
            for (std::size_t s = 0; s < job.spectra.size(); ++s)
                at.values.push_back(values[s * nm.size() + w]);
            solved.push_back(std::move(at));
        }
        return solved;
    };
    all = solved_at(job.wavelength_nm);
    std::vector<double> largest(job.spectra.size());
    while (true) {
        std::vector<double> known, halfway;
        std::vector<std::size_t> behind;
        for (const At& at : all) known.push_back(at.nm);
        for (std::size_t i = 0; i + 1 < all.size(); ++i) {
            const auto begin =
                           std::upper_bound(job.finest_nm.begin(), job.finest_nm.end(), known[i]),
                       end = std::lower_bound(begin, job.finest_nm.end(), known[i + 1]);
            if (!all[i].is_open || begin == end) continue;
            halfway.push_back(*(begin + (end - begin) / 2));
            behind.push_back(i);
        }
        if (halfway.empty()) return known;
        std::vector<At> fresh = solved_at(halfway);
        for (std::size_t s = 0; s < largest.size(); ++s) {
            for (const At& at : all) largest[s] = std::max(largest[s], std::abs(at.values[s]));
        }
        for (std::size_t k = 0; k < fresh.size(); ++k) {
            const Stencil stencil = stencil_at(known, fresh[k].nm);
            bool is_good = true;
            for (std::size_t s = 0; s < largest.size(); ++s) {
                double expected = 0.0;
                for (std::size_t i = 0; i < stencil.count; ++i)
                    expected += stencil.weight[i] * all[stencil.first + i].values[s];
                const double scale = std::max(std::abs(fresh[k].values[s]), kFaint * largest[s]);
                is_good = is_good && std::abs(expected - fresh[k].values[s]) <=
                                         kGainOfHalving * relative_error * scale;
            }
            fresh[k].is_open = all[behind[k]].is_open = !is_good;
        }
        all.insert(all.end(), fresh.begin(), fresh.end());
        std::sort(all.begin(), all.end(), [](const At& a, const At& b) { return a.nm < b.nm; });
    }
}

}  // namespace miebrdf::fitting
