// The plane of slopes (x towards the light, y across) of the small mirrors on a rough surface, for
// one direction of incidence: which slopes send light up, and where the V-cavity's G has kinks.
#pragma once

#include <vector>

namespace miebrdf::rte {

/// One direction of incidence; mu in (0, 1].
class SlopePlane {
  public:
    explicit SlopePlane(double mu_in);

    double mu() const { return mu_; }
    double sine() const { return sine_; }

    /// Slopes that reflect above the horizon: the disk (x - tan)^2 + y^2 < 1 / mu^2.
    double largest_y() const { return 1.0 / mu_; }
    double lowest_x(double y) const;
    double highest_x(double y) const;

    /// Where the V-cavity's min(1, 2 cos_half min(mu_in, mu_out) / cos_facet) changes branch along
    /// a line of constant y, ascending.
    std::vector<double> v_cavity_kinks(double y) const;
    /// Where y > 0 those kinks begin, end or meet, ascending: between these the integral over a
    /// line is a smooth function of y.
    std::vector<double> v_cavity_corners() const;

  private:
    double root(double y) const;

    double mu_;
    double sine_;
};

}  // namespace miebrdf::rte
