#include "tools/miebrdf/direction_options.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/io/table.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

constexpr int kDigits = 15;
/// The horizon itself gets no light.
constexpr double kLowest_deg = 89.999;

}  // namespace

double cosine_of_degrees(double degrees) {
    return rounded(std::cos(degrees * std::numbers::pi / 180.0), kDigits);
}

void DirectionArgument::add_to(CLI::App& group, const std::string& help,
                               const std::string& default_text) {
    const bool in = side_ == Side::in;
    auto* cosines =
        group.add_option(in ? "--mu-in" : "--mu-out", cosines_, help)->type_name("LIST");
    if (!default_text.empty()) cosines->default_str(default_text);
    option(group, in ? "--theta-in,--sun-zenith" : "--theta-out,--view-zenith", degrees_, "LIST",
           fmt::format("the same in degrees from the normal, in place of {}",
                       in ? "--mu-in" : "--mu-out"));
}

std::vector<double> DirectionArgument::parse(const std::string& otherwise) const {
    const std::string dashed = side_ == Side::in ? "in" : "out";
    if (!cosines_.empty() && !degrees_.empty()) {
        throw UsageError(
            fmt::format("--mu-{0} and --theta-{0}: cosines or degrees, one of them", dashed));
    }
    if (!degrees_.empty()) {
        std::vector<double> list = parse_number_list(
            degrees_, fmt::format("theta_{} (degrees)", dashed), 0.0, kLowest_deg);
        for (double& angle : list) angle = cosine_of_degrees(angle);
        return list;
    }
    const std::string& text = cosines_.empty() ? otherwise : cosines_;
    if (text.empty()) {
        throw UsageError(fmt::format(
            "--mu-{0} (cosines) or --theta-{0} (degrees from the normal) is required", dashed));
    }
    return parse_number_list(text, mu_name(), 0.0, 1.0, true);
}

}  // namespace miebrdf::program
