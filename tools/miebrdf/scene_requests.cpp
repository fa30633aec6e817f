#include "tools/miebrdf/scene_requests.h"

#include <string_view>

#include <miebrdf/error.h>
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/export_options.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {
namespace {

/// Reads a command line into `arguments`, which keep pointers into `command`.
template <typename Arguments>
void read(const std::vector<std::string>& line, CLI::App& command, Arguments& arguments) {
    Shell ignored("");
    arguments.add_to(command);
    ignored.add_common_options(command);
    try {
        command.parse(
            std::vector<std::string>(line.rbegin(), line.rend() - 1));  // CLI11: from the back
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
}

template <typename Arguments>
Request request_of(const std::vector<std::string>& line) {
    CLI::App command;
    Arguments arguments;
    read(line, command, arguments);
    return arguments.parse();
}

constexpr std::string_view kOutput = "--output=", kPicture = "--exr=";

}  // namespace

std::optional<LayerRequest> layer_request(const std::vector<std::string>& line) {
    if (line.front() == "brdf") {
        return LayerRequest{request_of<BrdfArguments>(line), LayerQuantity::reflection};
    }
    if (line.front() != "albedo") return std::nullopt;
    const Request request = request_of<AlbedoArguments>(line);
    return LayerRequest{request, albedo_quantity(request.scene)};
}

void check(const std::vector<std::string>& line) {
    if (line.front() != "export") return;
    CLI::App command;
    ExportArguments arguments;
    read(line, command, arguments);
    arguments.check_format();
    validate(arguments.scene());
    if (output_files(line).empty()) throw UsageError("export needs an 'output'");
}

std::vector<std::string> output_files(const std::vector<std::string>& line) {
    std::vector<std::string> files;
    for (const std::string& word : line) {
        for (const std::string_view option : {kOutput, kPicture}) {
            if (!word.starts_with(option)) continue;
            const std::string file = word.substr(option.size());
            if (!file.empty() && file != "-") files.push_back(file);
        }
    }
    return files;
}

}  // namespace miebrdf::program
