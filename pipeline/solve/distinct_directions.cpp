#include "pipeline/solve/distinct_directions.h"

#include <algorithm>
#include <cmath>

namespace miebrdf {
namespace {

/// Sorts `values`, drops repetitions, and returns the place of each original value.
std::vector<std::size_t> make_distinct(std::vector<double>& values) {
    const std::vector<double> all = values;
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    std::vector<std::size_t> places;
    for (const double value : all) {
        const auto found = std::lower_bound(values.begin(), values.end(), value);
        places.push_back(static_cast<std::size_t>(found - values.begin()));
    }
    return places;
}

std::vector<double> picked(const std::vector<double>& values,
                           const std::vector<std::size_t>& places) {
    std::vector<double> all;
    all.reserve(places.size());
    for (const std::size_t place : places) all.push_back(values[place]);
    return all;
}

/// The reflection depends on the cosine of the azimuth alone.
double folded(double azimuth_deg) {
    const double turned = std::fmod(std::abs(azimuth_deg), 360.0);
    return turned > 180.0 ? 360.0 - turned : turned;
}

}  // namespace

DistinctDirections::DistinctDirections(const rte::Directions& all) : distinct_(all) {
    for (double& azimuth : distinct_.azimuth_deg) azimuth = folded(azimuth);
    in_ = make_distinct(distinct_.mu_in);
    out_ = make_distinct(distinct_.mu_out);
    azimuth_ = make_distinct(distinct_.azimuth_deg);
}

bool DistinctDirections::are_all() const {
    const auto in_place = [](const std::vector<std::size_t>& places, std::size_t distinct) {
        return places.size() == distinct && std::is_sorted(places.begin(), places.end());
    };
    return in_place(in_, distinct_.mu_in.size()) && in_place(out_, distinct_.mu_out.size()) &&
           in_place(azimuth_, distinct_.azimuth_deg.size());
}

std::size_t DistinctDirections::computed() const {
    return distinct_.mu_in.size() * distinct_.mu_out.size() * distinct_.azimuth_deg.size();
}

std::vector<double> DistinctDirections::spread(const std::vector<double>& values) const {
    std::vector<double> all;
    all.reserve(requested());
    for (const std::size_t i : in_) {
        for (const std::size_t o : out_) {
            const std::size_t row =
                (i * distinct_.mu_out.size() + o) * distinct_.azimuth_deg.size();
            for (const std::size_t a : azimuth_) all.push_back(values[row + a]);
        }
    }
    return all;
}

std::vector<double> DistinctDirections::spread_incident(const std::vector<double>& values) const {
    return picked(values, in_);
}

std::vector<double> DistinctDirections::spread_outgoing(const std::vector<double>& values) const {
    return picked(values, out_);
}

}  // namespace miebrdf
