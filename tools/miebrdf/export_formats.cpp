#include "tools/miebrdf/export_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/formats/brdf_export.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {
namespace {

using Options = std::vector<std::string>;

/// The options of the file, format by format; what is missing here has its own grid or no colour.
const std::map<std::string, Options>& file_options() {
    static const Options kLists = {"--mu-in", "--mu-out", "--azimuth", "--resolution"};
    static const std::map<std::string, Options> options = {
        {"csv", kLists},
        {"json", kLists},
        {"npz", kLists},
        {"exr", {"--mu-in", "--mu-out", "--azimuth", "--resolution", "--rgb"}},
        {"pbrt", {"--resolution", "--rgb", "--max-error"}},
        {"rgl", {"--resolution", "--incident-angles", "--rgb", "--max-error"}},
        {"merl", {"--bin-centres", "--rgb", "--max-error"}},
        {"ssdd", {"--resolution", "--max-error"}},
        {"astm", {"--resolution", "--max-error"}},
        {"radiance", {"--resolution", "--rgb", "--max-error"}},
        {"klems", {"--rgb", "--max-error"}},
        {"spd", {}},
        {"irregular", {}},
        {"scattering", {}}};
    return options;
}

/// What a table of single scattering, without light transfer, leaves unread.
const Options kOfTransfer = {
    "--coat",        "--roughness",     "--coupling",   "--surface-index",
    "--tolerance",   "--streams",       "--grid",       "--half-space-method",
    "--coat-method", "--coat-substeps", "--no-delta-m", "--no-single-scattering-correction"};

}  // namespace

std::vector<std::string> all_export_formats() {
    std::vector<std::string> names = exports::export_formats();
    names.insert(names.end(), {"spd", "irregular", "scattering"});
    return names;
}

std::vector<std::string> file_options_of(const std::string& format) {
    const auto found = file_options().find(format);
    if (found != file_options().end()) return found->second;
    const std::vector<std::string> known = all_export_formats();
    throw UsageError(fmt::format("unknown format '{}'; allowed: {}{}", format,
                                 fmt::join(known, ", "), did_you_mean(format, known)));
}

std::vector<std::string> ignored_options_of(const std::string& format) {
    const Options taken = file_options_of(format);
    Options ignored;
    for (const char* option : {"--mu-in", "--mu-out", "--azimuth", "--resolution", "--rgb",
                               "--max-error", "--incident-angles", "--bin-centres"}) {
        if (std::find(taken.begin(), taken.end(), option) == taken.end())
            ignored.emplace_back(option);
    }
    const auto& brdfs = exports::export_formats();
    if (std::find(brdfs.begin(), brdfs.end(), format) == brdfs.end())
        ignored.emplace_back("--component");
    if (format == "scattering")
        ignored.insert(ignored.end(), kOfTransfer.begin(), kOfTransfer.end());
    return ignored;
}

}  // namespace miebrdf::program
