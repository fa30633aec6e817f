// The results of a scene file as requests, for who wants to know beforehand what they have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/layers.h"
#include "pipeline/request.h"

namespace miebrdf::program {

struct LayerRequest {
    Request request;
    LayerQuantity quantity = LayerQuantity::reflection;
};

/// Reads the words of a command line (its name first) as that command would; empty for commands
/// other than brdf and albedo.
/// @throws UsageError, InputError
std::optional<LayerRequest> layer_request(const std::vector<std::string>& line);

}  // namespace miebrdf::program
