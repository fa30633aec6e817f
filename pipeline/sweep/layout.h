// The variables of a sweep's table, and how the values of one scene lie in memory.
#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/sweep.h"

namespace miebrdf::sweep {

struct Variable {
    std::string name;
    std::string long_name;
    std::string unit;  ///< "sr-1", "1"
    /// Axes behind those of the scenes, the slowest first; they belong to the sweep.
    std::vector<const Axis*> axes = {};
    std::size_t offset = 0;  ///< in the record of a scene
    std::size_t size = 1;    ///< values of one scene
};

struct Layout {
    std::vector<Variable> variables;
    std::size_t record = 0;  ///< values of one scene, of all variables

    /// Null if there is none of this name.
    const Variable* find(const std::string& name) const;
};

/// "m12": row 0, column 1.
std::string mueller_name(int row, int column);
/// The variable of a derivative: `plane_albedo_d_radius_um`.
std::string derivative_name(const std::string& variable, const std::string& parameter);

/// @param sweep  must outlive the layout
Layout layout_of(const Sweep& sweep);

/// The axes of a sweep behind those of its scenes that any variable has: wavelengths, incidences,
/// reflections, azimuths.
std::vector<const Axis*> asked_axes(const Sweep& sweep);

/// The results of one scene.
struct SceneResult {
    std::vector<double> values = {};  ///< laid out by a Layout; not-a-number where it failed
    double error_estimate = 0.0;      ///< relative, the largest; not-a-number of scenes that failed
    bool converged = false;           ///< false where values are missing, too
    std::size_t missing_wavelengths = 0;  ///< that could not be computed: their values are missing
    std::string remark = {};              ///< why they are, or what missed the tolerance
};

/// @throws UsageError  where transmittances are wanted of a scene that has none
void require_transmittance(const Sweep& sweep, const Request& request);

/// Solves the scene of this number. Mistakes of the scene are a result, not an exception.
/// @throws Cancelled
SceneResult solve_scene(const Sweep& sweep, const Layout& layout, std::size_t scene,
                        const Control& control);

}  // namespace miebrdf::sweep
