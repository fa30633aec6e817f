#include "tools/miebrdf/scene_requests.h"

#include "pipeline/error.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {
namespace {

template <typename Arguments>
Request request_of(const std::vector<std::string>& line) {
    CLI::App command;
    Shell ignored("");
    Arguments arguments;
    arguments.add_to(command);
    ignored.add_common_options(command);
    try {
        command.parse(
            std::vector<std::string>(line.rbegin(), line.rend() - 1));  // CLI11: from the back
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    return arguments.parse();
}

}  // namespace

std::optional<LayerRequest> layer_request(const std::vector<std::string>& line) {
    if (line.front() == "brdf") {
        return LayerRequest{request_of<BrdfArguments>(line), LayerQuantity::reflection};
    }
    if (line.front() != "albedo") return std::nullopt;
    const Request request = request_of<AlbedoArguments>(line);
    return LayerRequest{request, albedo_quantity(request.scene)};
}

}  // namespace miebrdf::program
