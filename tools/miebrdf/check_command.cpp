// miebrdf check: what a BRDF file of any known format holds, and whether that can be.
#include <fmt/format.h>

#include <cmath>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/export_options.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

/// Energy is conserved by the layers; the reciprocal coupling to a surface conserves it in the mean
/// over incidences alone, and reflects up to 1.003 of the light along the normal (white layers).
constexpr double kLargestAlbedo = 1.005;

struct CheckArguments {
    std::string file;
    SceneArguments scene;
    std::string component = "total";
    std::string rgb = "auto";
    double largest_asymmetry = 0.05;
    double largest_albedo = kLargestAlbedo;
    double largest_deviation = 0.0;  // 0: what export accepts of the format
    double largest_sampling_error = 0.03;
};

/// Rows `quantity,value,bound,ok` and whether all is well.
class Verdict {
  public:
    explicit Verdict(Table& table) : table_(table) {}

    void at_most(const std::string& quantity, double value, double bound) {
        add(quantity, value, bound, value <= bound);
    }
    void at_least(const std::string& quantity, double value, double bound) {
        add(quantity, value, bound, value >= bound);
    }
    /// A number without a bound: to be read, not judged.
    void tell(const std::string& quantity, double value) {
        table_.rows.push_back({quantity, value, Cell(), std::string("not judged")});
    }
    bool good() const { return good_; }

  private:
    void add(const std::string& quantity, double value, double bound, bool ok) {
        table_.rows.push_back({quantity, value, bound, std::string(ok ? "yes" : "no")});
        good_ = good_ && ok;
    }
    Table& table_;
    bool good_ = true;
};

/// How far the file is from the scene that it is said to hold.
void compare(const BrdfFile& file, const CheckArguments& arguments, const Shell& shell,
             Verdict& verdict) {
    Request request = arguments.scene.parse();
    if (!arguments.scene.given("coupling"))
        request.scene.coupling = rte::SurfaceCoupling::reciprocal;  // as export does
    if (!file.wavelength_nm().empty()) request.wavelength_nm = file.wavelength_nm();
    const BrdfTable source =
        solved(request, shell.control())
            .table({parse_brdf_part(arguments.component), shell.command_line()});
    const FileComparison found = compare_file(file, source, arguments.rgb);
    AcceptedErrors accepted = find_format(file.format()).accepted;
    if (arguments.largest_deviation > 0.0)
        accepted = accepted.with_plain(arguments.largest_deviation);
    for (const RegionDeviation& region : found.deviation.regions) {
        verdict.at_most(fmt::format("deviation_rms ({})", region.name), region.rms,
                        found.only_listed ? accepted.plain : accepted.of(region.kind));
        verdict.tell(fmt::format("deviation_worst ({})", region.name), region.worst);
    }
    verdict.tell("directional_albedo_error", found.albedo_error);
}

std::vector<std::pair<std::string, Cell>> facts(const BrdfFile& file, const std::string& path,
                                                const FileCheck& check) {
    std::vector<std::pair<std::string, Cell>> lines = {
        {"file", path},
        {"format", file.format()},
        {"description", file.description()},
        {"channels", fmt::format("{}", fmt::join(file.channels(), ", "))},
        {"directions without a value", fmt::format("{} of {}", check.missing, check.directions)}};
    if (!check.largest_albedo) {
        lines.emplace_back("largest albedo", "none: the table has too few directions to integrate");
        return lines;
    }
    std::string albedo =
        fmt::format("channel {}, mu_in {}", check.largest_albedo_channel, check.largest_albedo_mu);
    if (check.largest_albedo_error > 0.0) {
        albedo += fmt::format(
            "; its bound includes {:.2g}, twice what leaving out every second direction of the "
            "table changes",
            check.largest_albedo_error);
    }
    lines.emplace_back("largest albedo", std::move(albedo));
    return lines;
}

int run_check(const CheckArguments& arguments, const Shell& shell) {
    const auto file = open_brdf_file(arguments.file);
    const FileCheck check = check_file(*file);
    Table table;
    table.facts = facts(*file, arguments.file, check);
    table.columns = {"quantity", "value", "bound", "ok"};
    Verdict verdict(table);
    if (check.reciprocity_rms) {
        verdict.at_most("reciprocity_error_rms (mu > 0.2)", *check.reciprocity_rms,
                        arguments.largest_asymmetry);
    }
    if (check.largest_albedo) {
        verdict.at_most("largest_directional_albedo", *check.largest_albedo,
                        arguments.largest_albedo + check.largest_albedo_error);
    }
    verdict.at_least("least_value_per_sr", check.least_value, 0.0);
    if (check.sampled_albedo_error) {
        verdict.at_most("sampled_albedo_error", *check.sampled_albedo_error,
                        arguments.largest_sampling_error);
    }
    if (arguments.scene.given()) compare(*file, arguments, shell, verdict);
    shell.write(std::move(table));
    if (check.largest_albedo && *check.largest_albedo > 1.0 &&
        *check.largest_albedo <= arguments.largest_albedo + check.largest_albedo_error) {
        shell.note(
            "an albedo a little above 1: cells and interpolation, or a surface's reciprocal "
            "coupling, which conserves energy in the mean over incidences alone; `miebrdf albedo` "
            "with the scene's options says what is the scene's own");
    }
    if (check.reciprocity_rms && !(*check.reciprocity_rms <= arguments.largest_asymmetry)) {
        shell.note(
            "not reciprocal: a rough surface under --coupling paper (eq. 5 of the paper) is not; "
            "--coupling reciprocal is");
    }
    return verdict.good() ? kGood : kCheckFailed;
}

}  // namespace

void add_check(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<CheckArguments>();
    command
        .add_option("FILE", arguments->file, "a BRDF file; its format is recognised by its content")
        ->required();
    auto* group = command.add_option_group("Bounds");
    group
        ->add_option("--max-reciprocity-error", arguments->largest_asymmetry,
                     "rms of |f(i,o) - f(o,i)| / mean, both cosines > 0.2")
        ->capture_default_str();
    group
        ->add_option("--max-albedo", arguments->largest_albedo,
                     "directional, any channel; the reciprocal coupling conserves energy in the "
                     "mean over incidences alone")
        ->capture_default_str();
    group
        ->add_option(
            "--max-deviation", arguments->largest_deviation,
            "rms relative error at mu > 0.2 and near the mirror direction, when a scene is "
            "given to compare with; at retro-reflection and the "
            "zenith it may be 0.5, at mu < 0.2 2, or this if it is larger")
        ->capture_default_str();
    group
        ->add_option("--max-sampling-error", arguments->largest_sampling_error,
                     "of the albedo found by the file's importance sampling")
        ->capture_default_str();
    arguments->scene.add_to(command, shell, SceneArguments::Base::optional);
    default_to_reciprocal(command);
    command.add_option("--component", arguments->component, "of the scene to compare with")
        ->capture_default_str();
    command.add_option("--rgb", arguments->rgb, "colours of the scene to compare with")
        ->capture_default_str();
    shell.add_common_options(command);
    command.footer(
        "Example:\n  miebrdf check paint.bsdf\n  miebrdf check paint_spec.bsdf --base TiO2 --coat "
        "AlGaAs7@0.1");
    shell.on_run(command, [arguments, &shell] { return run_check(*arguments, shell); });
}

}  // namespace miebrdf::program
