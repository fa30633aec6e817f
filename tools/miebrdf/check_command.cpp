// miebrdf check: what a BRDF file of any known format holds, and whether that can be.
#include <fmt/format.h>

#include <cmath>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/export_options.h"
#include "tools/miebrdf/file_origin.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

/// Energy is conserved by the layers; the reciprocal coupling to a surface conserves it in the mean
/// over incidences alone, and reflects up to 1.003 of the light along the normal (white layers).
constexpr double kLargestAlbedo = 1.005;

struct CheckArguments {
    std::string file;
    SceneArguments scene;
    bool own_scene = false;
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

/// The scene that the file shall be compared with: its own, or that of the options.
SceneOfFile scene_to_compare(const CheckArguments& arguments, const Shell& shell) {
    if (!arguments.own_scene) {
        SceneOfFile typed{arguments.scene.parse(), arguments.component, arguments.rgb};
        if (!arguments.scene.given("coupling"))
            typed.request.scene.coupling = rte::SurfaceCoupling::reciprocal;  // as export does
        return typed;
    }
    for (const std::string& word : shell.scene_words()) {
        if (!arguments.scene.given(word)) continue;
        throw UsageError(fmt::format(
            "--own-scene takes the scene from the file, and --{0} says it too; leave one of them "
            "out",
            word));
    }
    SceneOfFile own = scene_of_file(arguments.file);
    shell.note("compared with the scene of the command that made the file: " +
               command_of_file(arguments.file));
    return own;
}

/// A peak that a file has lost passes the bound of its region's rms; it is said all the same.
constexpr double kLostPeak = 0.3;

/// How far the file is from the scene that it is said to hold.
void compare(const BrdfFile& file, const CheckArguments& arguments, const Shell& shell,
             Verdict& verdict, Table& table) {
    SceneOfFile said = scene_to_compare(arguments, shell);
    if (!file.wavelength_nm().empty()) said.request.wavelength_nm = file.wavelength_nm();
    const Brdf brdf = solved(said.request, shell.control());
    const BrdfTable source = brdf.table(as_evaluated(brdf, parse_brdf_part(said.component), shell));
    const FileComparison found = compare_file(file, source, said.rgb);
    AcceptedErrors accepted = find_format(file.format()).accepted;
    if (arguments.largest_deviation > 0.0)
        accepted = accepted.with_plain(arguments.largest_deviation);
    for (const RegionDeviation& region : found.deviation.regions) {
        verdict.at_most(fmt::format("deviation_rms ({})", region.name), region.rms,
                        found.only_listed ? accepted.plain : accepted.of(region.kind));
        verdict.tell(fmt::format("deviation_worst ({})", region.name), region.worst);
        table.facts.emplace_back(fmt::format("worst at {}", region.name), worst_of(region));
        if (region.kind == RegionKind::peaks && !(std::abs(region.worst) <= kLostPeak)) {
            shell.note(fmt::format("{}: a peak narrower than the file's cells, up to {}",
                                   region.name, worst_of(region)));
        }
    }
    verdict.tell("directional_albedo_error", found.albedo_error);
}

/// A file alone does not say what it should hold between its nodes.
void tell_what_is_not_seen(const BrdfFile& file, const CheckArguments& arguments, Table& table) {
    const bool sampled = find_format(file.format()).content == FormatContent::sampled;
    const bool says_scene = !command_of_file(arguments.file).empty();
    table.facts.emplace_back(
        "cannot be seen from the file alone",
        fmt::format("{}; compare with the scene: miebrdf check FILE {}",
                    sampled
                        ? "peaks narrower than its cells (retro-reflection of large spheres, "
                          "sharp lobes at mirror directions, grazing directions)"
                        : "whether its values are the scene's, and peaks between its directions",
                    says_scene ? "--own-scene" : "--base ..."));
    table.rows.push_back({std::string("deviation (all regions)"), Cell(), Cell(),
                          std::string("not judged without a scene")});
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
    if (arguments.own_scene || arguments.scene.given() || arguments.scene.given("substrate"))
        compare(*file, arguments, shell, verdict, table);
    else
        tell_what_is_not_seen(*file, arguments, table);
    shell.write(std::move(table));
    if (check.largest_albedo && *check.largest_albedo > 1.0 &&
        *check.largest_albedo <= arguments.largest_albedo + check.largest_albedo_error) {
        shell.note(
            "the largest albedo is a little above 1. Causes are the file's cells and their "
            "interpolation, or a surface's reciprocal coupling, which conserves energy only on "
            "average over all incidences; `miebrdf albedo` with the scene's options prints the "
            "albedo of the scene itself");
    }
    if (check.reciprocity_rms && !(*check.reciprocity_rms <= arguments.largest_asymmetry)) {
        shell.note(
            "the file is not reciprocal: a rough surface with --coupling paper (eq. 5 of the "
            "paper) is not, with --coupling reciprocal it is");
    }
    return verdict.good() ? kGood : kCheckFailed;
}

}  // namespace

void add_check(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<CheckArguments>();
    option(command, "FILE", arguments->file, "",
           "a BRDF file; its format is recognised by its content")
        ->required();
    auto* group = command.add_option_group("Bounds");
    option(
        *group, "--max-reciprocity-error", arguments->largest_asymmetry, "",
        "largest accepted rms of |f(i,o) - f(o,i)| over the mean, where both cosines exceed 0.2");
    option(*group, "--max-albedo", arguments->largest_albedo, "",
           "largest accepted directional albedo of any channel; a little above 1, since the "
           "reciprocal coupling conserves energy only on average over all incidences");
    option(*group, "--max-deviation", arguments->largest_deviation, "",
           "when compared with a scene: largest accepted relative error (rms) where mu > 0.2 and "
           "near the mirror direction. At retro-reflection and the zenith 0.5 is accepted, where "
           "mu < 0.2 2, or this number if it is larger; 0: what export accepts of the format");
    option(*group, "--max-sampling-error", arguments->largest_sampling_error, "",
           "largest accepted error of the albedo that is found by the file's importance sampling");
    command.add_flag("--own-scene", arguments->own_scene,
                     "compare with the scene that the file was made from: the command in its "
                     "metadata is solved anew");
    arguments->scene.add_to(command, shell, SceneArguments::Base::optional);
    default_to_reciprocal(command);
    option(command, "--component", arguments->component, "",
           "part of the scene's BRDF to compare with: total, subsurface or surface");
    option(command, "--rgb", arguments->rgb, "",
           "how the colours of the scene are made, as for export");
    finish(command, shell, arguments, run_check,
           "Example:\n  miebrdf check paint.bsdf --own-scene\n  miebrdf check paint_spec.bsdf "
           "--base TiO2 --coat AlGaAs7@0.1");
}

}  // namespace miebrdf::program
