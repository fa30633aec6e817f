// Directions of a request with what is the same left out: repeated cosines and azimuths, and
// azimuths that differ by sign or whole turns.
#pragma once

#include <vector>

#include <miebrdf/solver.h>

namespace miebrdf {

class DistinctDirections {
  public:
    explicit DistinctDirections(const rte::Directions& all);

    /// Each cosine once, ascending; each azimuth once, in [0, 180].
    const rte::Directions& directions() const { return distinct_; }
    /// Whether directions() are the requested ones: nothing needs spreading.
    bool are_all() const;
    /// Values at directions(), laid out as in rte::ReflectionTable, at all the requested ones.
    std::vector<double> spread(const std::vector<double>& values) const;
    /// Values at directions().mu_in at all the requested mu_in, and those at mu_out.
    std::vector<double> spread_incident(const std::vector<double>& values) const;
    std::vector<double> spread_outgoing(const std::vector<double>& values) const;

    /// Number of combinations before and after.
    std::size_t requested() const { return in_.size() * out_.size() * azimuth_.size(); }
    std::size_t computed() const;

  private:
    rte::Directions distinct_;
    std::vector<std::size_t> in_, out_, azimuth_;  ///< place of each requested one in distinct_
};

}  // namespace miebrdf
