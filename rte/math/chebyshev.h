// Interpolation between Chebyshev points: through all of them at once, or in adaptive pieces.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace miebrdf::math {

/// Chebyshev points of the first kind on (-1, 1), to interpolate between by the barycentric
/// formula.
class ChebyshevPoints {
  public:
    explicit ChebyshevPoints(int count = 1);
    int count() const { return int(points_.size()); }
    double operator[](int node) const { return points_[node]; }
    /// Lagrange's weights at t.
    Eigen::VectorXd weights(double t) const;

  private:
    Eigen::VectorXd points_;
    Eigen::VectorXd factors_;
};

/// How well each function must be known; at a panel the sum of both counts.
struct AngleTolerance {
    double absolute = 0.0;
    double relative = 0.0;  ///< to the largest coefficient of the function in the panel
};

/// Several functions of one angle on common panels. Panels are halved until the last two Chebyshev
/// coefficients of every function are within the tolerance.
class AngleTable {
  public:
    static constexpr int kNodes = 8;  ///< of a panel

    /// Values of all functions at angles in [0, pi]: row = angle, column = function.
    using Functions = std::function<Eigen::MatrixXd(const Eigen::VectorXd& angles)>;

    /// @param functions  called with the nodes of many panels at a time
    /// @param narrowest  no panel gets narrower than this: where the functions are a known sum of
    ///                   waves, half a wavelength of the shortest
    AngleTable(const Functions& functions, double narrowest, const AngleTolerance& tolerance);

    int function_count() const { return function_count_; }
    std::size_t panel_count() const { return panels_.size(); }

    /// The functions at one angle.
    /// @param angle   in [0, pi]
    /// @param values  function_count() of them
    void evaluate(double angle, Eigen::Ref<Eigen::VectorXd> values) const;

  private:
    struct Panel {
        double lower, upper;
    };
    /// Angles become t = (angle - middle) * scale, in [-1, 1] within the panel.
    struct Place {
        double middle, scale;
    };
    std::vector<Panel> first_panels() const;
    /// Keeps what has converged, returns the halves of the others.
    std::vector<Panel> refine(const std::vector<Panel>& panels, const Functions& functions,
                              double narrowest, const AngleTolerance& tolerance);
    void sort_panels();
    void index_panels();

    int function_count_ = 0;
    std::vector<Panel> panels_;  ///< ascending, from 0 to pi
    std::vector<Place> places_;  ///< of the panels
    /// [(panel * kNodes + degree) * function_count() + function]
    std::vector<double> coefficients_;
    /// For each of equal cells of [0, pi], each within one panel unless there would be too many:
    /// the first panel that reaches into it.
    std::vector<std::uint32_t> first_of_cell_;
};

}  // namespace miebrdf::math
