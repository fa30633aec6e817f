#include "pipeline/fit/spectra.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pipeline/solve/sampled_line.h"

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
        const CubicStencil s = cubic_at(job.wavelength_nm, nm);
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
    using Values = std::vector<double>;  // of the spectra
    std::vector<double> largest(job.spectra.size());
    const auto wavelengths = [&](const std::vector<std::size_t>& places) {
        std::vector<double> nm;
        for (const std::size_t place : places) nm.push_back(job.finest_nm[place]);
        return nm;
    };
    const auto solve_at = [&](const std::vector<std::size_t>& places) {
        const std::vector<double> values = solve(wavelengths(places));
        std::vector<Values> solved(places.size());
        for (std::size_t s = 0; s < largest.size(); ++s) {
            for (std::size_t w = 0; w < places.size(); ++w) {
                solved[w].push_back(values[s * places.size() + w]);
                largest[s] = std::max(largest[s], std::abs(solved[w].back()));
            }
        }
        return solved;
    };
    const auto misfit = [&](const CubicStencil& stencil, std::span<const std::size_t>,
                            std::span<const Values> around, std::size_t, const Values& solved) {
        double largest_off = 0.0;
        for (std::size_t s = 0; s < largest.size(); ++s) {
            double expected = 0.0;
            for (std::size_t i = 0; i < stencil.count; ++i)
                expected += stencil.weight[i] * around[i][s];
            const double off = std::abs(expected - solved[s]);
            if (off == 0.0) continue;
            largest_off =
                std::max(largest_off, off / std::max(std::abs(solved[s]), kFaint * largest[s]));
        }
        return largest_off / (kGainOfHalving * relative_error);
    };
    std::vector<std::size_t> first;
    for (const double nm : job.wavelength_nm)
        first.push_back(
            std::size_t(std::lower_bound(job.finest_nm.begin(), job.finest_nm.end(), nm) -
                        job.finest_nm.begin()));
    return wavelengths(
        sample_line<Values>(job.finest_nm, std::move(first), solve_at, misfit).places);
}

}  // namespace miebrdf::fitting
