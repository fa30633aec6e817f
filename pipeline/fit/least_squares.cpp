#include "pipeline/fit/least_squares.h"

#include "pipeline/io/plugin.h"

namespace miebrdf {

bool has_fit() { return has_plugin("ceres"); }

namespace fitting {

Minimum minimise(const LeastSquares& problem) {
    using Minimise = void(const LeastSquares&, Minimum&);
    static Minimise* const function =
        plugin_function<Minimise>("ceres", "miebrdf_minimise", "libceres-dev");
    Minimum minimum;
    function(problem, minimum);
    return minimum;
}

}  // namespace fitting
}  // namespace miebrdf
