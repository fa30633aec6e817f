// The results of a scene file as requests, for who wants to know beforehand what they have in
// common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "pipeline/solve/layers.h"

namespace miebrdf::program {

struct LayerRequest {
    Request request;
    LayerQuantity quantity = LayerQuantity::reflection;
};

/// Reads the words of a command line (its name first) as that command would; empty for commands
/// other than brdf and albedo.
/// @throws UsageError, InputError
std::optional<LayerRequest> layer_request(const std::vector<std::string>& line);

/// Refuses an export that could not be written, as the command itself would.
/// @throws UsageError, InputError
void check(const std::vector<std::string>& line);

/// The files that a command line writes, as named in it; standard output is none.
std::vector<std::string> output_files(const std::vector<std::string>& line);

}  // namespace miebrdf::program
