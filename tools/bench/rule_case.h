// What the cases of the suite `rules` have in common: their requests, and how they are run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "tools/bench/suites.h"

namespace miebrdf::bench {

using Values = std::vector<double>;
using Run = std::function<Values()>;

/// 32 x 32 directions and 36 azimuths of HG paint on an HG base, 32 nodes.
Request matrix_request();

/// The same with spheres of 10 um, one direction.
Request spheres_request(const std::string& base);

/// BRDF and plane albedo at the first wavelength, computed as `plan` has it.
Values total(const Request& request);
Values albedo(const Request& request);

/// BRDF by the layers' solver itself, whatever the rules say.
Values unreduced(const Request& request);

BenchCase rule_case(const std::string& rule, const std::string& quantity, const Run& full,
                    const Run& reduced);

/// Cases of rules about the directions that are asked for.
std::vector<BenchCase> direction_rules();

/// Of rules about layers and orders that do not matter.
std::vector<BenchCase> layer_rules();

/// Of rules about work that several layers, results or wavelengths share.
std::vector<BenchCase> shared_work_rules();

/// Of rules about parts of the BRDF or of the optics that nobody asks for.
std::vector<BenchCase> part_rules();

}  // namespace miebrdf::bench
