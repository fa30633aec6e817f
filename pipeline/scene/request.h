// A request: what a command or a scene file asks to be solved.
#pragma once

#include <miebrdf/scene.h>
#include <miebrdf/solver.h>

#include <vector>

namespace miebrdf {

struct Request {
    Scene scene;
    std::vector<double> wavelength_nm;
    rte::SolverOptions solver;
};

}  // namespace miebrdf
