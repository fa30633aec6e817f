#include "tools/miebrdf/export_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/brdf.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

/// Options that a table of single scattering, without light transfer, leaves unread.
constexpr const char* kOfTransfer[] = {
    "--coat",        "--roughness",     "--coupling",   "--surface-index",
    "--tolerance",   "--streams",       "--grid",       "--half-space-method",
    "--coat-method", "--coat-substeps", "--no-delta-m", "--no-single-scattering-correction"};

/// The option for a field of ExportOptions, or for one of its `extra`.
std::string option_of(std::string field) {
    if (field == "azimuth_deg") return "--azimuth";
    if (field == "largest_error") return "--max-error";
    std::replace(field.begin(), field.end(), '_', '-');
    return "--" + field;
}

std::vector<std::string> file_options_of(const Format& format) {
    std::vector<std::string> options;
    for (const std::string& field : options_of(format)) {
        options.push_back(option_of(field));
    }
    return options;
}

/// "csv, json": the formats of which something is true.
std::string formats_that(const std::function<bool(const Format&)>& is_so) {
    std::vector<std::string> names;
    for (const Format& format : all_formats()) {
        if (is_so(format)) names.push_back(format.name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string formats_that_take(const std::string& field) {
    return formats_that([&](const Format& format) {
        const std::vector<std::string> taken = options_of(format);
        return std::find(taken.begin(), taken.end(), field) != taken.end();
    });
}

/// "csv, json, npz, exr: 16 cosines; pbrt: 56 intervals of the cosine".
std::string resolutions() {
    std::vector<std::pair<std::string, std::string>> groups;  // fineness, names
    for (const Format& format : all_formats()) {
        const Fineness& fineness = format.resolution;
        if (fineness.lowest == fineness.highest) continue;
        const std::string text = fmt::format("{} {}", fineness.standard, fineness.unit);
        const auto same = std::find_if(groups.begin(), groups.end(),
                                       [&](const auto& group) { return group.first == text; });
        if (same != groups.end()) {
            same->second += ", " + format.name;
        } else {
            groups.emplace_back(text, format.name);
        }
    }
    std::vector<std::string> lines;
    lines.reserve(groups.size());
    for (const auto& [text, names] : groups) lines.push_back(fmt::format("{}: {}", names, text));
    return fmt::format("{}", fmt::join(lines, "; "));
}

}  // namespace

Request exported_request(const SceneArguments& scene) {
    Request request = scene.parse();
    if (!scene.given("coupling")) request.scene.coupling = rte::SurfaceCoupling::reciprocal;
    std::sort(request.wavelength_nm.begin(), request.wavelength_nm.end());  // rgb comes descending
    return request;
}

std::optional<SubsurfaceMedium> subsurface_of(const Brdf& brdf) {
    const std::vector<LayerOptics> layers = brdf.layers();
    const std::size_t count = brdf.wavelength_nm().size();
    std::optional<SubsurfaceMedium> top;
    for (const LayerOptics& named : layers) {
        if (named.wavelength != 0) continue;  // the lowest layer first
        SubsurfaceMedium medium;
        for (const LayerOptics& at : layers) {
            if (at.layer != named.layer || !at.scattering_per_um || !at.absorption_per_um) continue;
            const double extinction = *at.scattering_per_um + *at.absorption_per_um;
            if (extinction > 0.0) medium.mean_free_path_um.push_back(1.0 / extinction);
            if (at.wavelength == count / 2) medium.asymmetry = at.asymmetry;
        }
        if (medium.mean_free_path_um.size() == count && std::isfinite(medium.asymmetry))
            top = std::move(medium);
    }
    return top;
}

void default_to_reciprocal(CLI::App& command) {
    CLI::Option* coupling = command.get_option("--coupling");
    coupling->default_str("reciprocal");
    coupling->description(coupling->get_description() +
                          "; default in files: reciprocal, because programs that read them differ "
                          "in which direction is that of the light");
}

void ExportArguments::add_to(CLI::App& command, Shell& shell) {
    command_ = &command;
    option(command, "--format", format_, "NAME", formats_that([](const Format&) { return true; }))
        ->required();
    scene_.add_to(command, shell);
    default_to_reciprocal(command);
    auto* measured = command.add_option_group("Measured");
    option(*measured, "--from", from_, "FILE",
           "a file of measured directions (any that `miebrdf measured` reads) in place of a scene; "
           "the BRDF between them is interpolated and reciprocal");
    option(*measured, "--column", column_, "NAME", "one column or sample of the file of --from");
    option(*measured, "--azimuth-zero", azimuth_zero_, "SIDE",
           "what azimuth 0 means in the file of --from: mirror or back");
    option(command, "--component", component_, "",
           "total, subsurface or surface; transmitted: the BTDF of a film in air");
    add_file_options(command);
}

void ExportArguments::add_file_options(CLI::App& command) {
    auto* group = command.add_option_group("File");
    option(
        *group, option_of("resolution"), options_.resolution, "",
        fmt::format(
            "how fine the file is, counted in what its format counts; 0: the format's default ({})",
            resolutions()))
        ->check(CLI::Range(0, 4096));
    for (const Format& format : all_formats()) {
        for (const FormatOption& extra : format.extra) {
            const std::string help = format.name + ": " + extra.help;
            int& value = options_.extra.emplace(extra.name, extra.standard).first->second;
            if (extra.is_switch) {
                // A flag of a whole number counts as given in CLI11 2.4 when it is not.
                group->add_flag_callback(
                    option_of(extra.name), [&value] { value = 1; }, help);
            } else {
                option(*group, option_of(extra.name), value, "", help);
            }
        }
    }
    const std::string tables = formats_that_take("mu_in");
    mu_in_.add_to(*group, tables + ": cosines of incidence");
    mu_out_.add_to(*group, tables + ": cosines of reflection");
    option(*group, option_of("azimuth_deg"), azimuth_, "LIST",
           tables + ": degrees, 0 = mirror side");
    option(*group, option_of("rgb"), options_.rgb, "",
           fmt::format("colour of {}: cie (observer and D65), wavelengths (the nearest to 620, "
                       "535, 480 nm), auto: cie where the wavelengths cover the visible",
                       formats_that_take("rgb")));
    const std::string sampled = formats_that_take("largest_error");
    const AcceptedErrors usual;
    option(
        *group, option_of("largest_error"), options_.largest_error, "",
        fmt::format(
            "{} are read back and compared with the scene: largest accepted relative error (rms, "
            "where mu > 0.2 and near the mirror direction). At retro-reflection and the zenith {} "
            "is accepted, where mu < 0.2 {}, or this number if it is larger; 0: the format's own",
            sampled, usual.peaks, usual.grazing));
    group->add_flag(option_of("accept_error"), options_.accept_error,
                    sampled + ": write the file even if its errors exceed what is accepted");
}

bool ExportArguments::given(const std::string& option) const {
    // Words of the scene may come from a scene file, where no option is typed.
    if (option == option_of("mu_in")) return mu_in_.given();
    if (option == option_of("mu_out")) return mu_out_.given();
    return scene_.given(option.substr(2)) || command_->get_option(option)->count() > 0;
}

void ExportArguments::check_format() const {
    const std::vector<std::string> taken = file_options_of(format());
    for (const std::string& name : ignored_options_of(format_)) {
        if (!given(name)) continue;
        if (format().content == FormatContent::scattering) {
            throw UsageError(fmt::format(
                "format '{}' has no use for {}: it holds single scattering by the particles of "
                "--base alone (albedo, asymmetry, moments), before any light transfer; leave {} "
                "out, or take a format of BRDFs",
                format_, name, name));
        }
        throw UsageError(fmt::format(
            "format '{}' has no use for {}; {}", format_, name,
            taken.empty()
                ? std::string("it has no options of the file")
                : fmt::format("of the file's options it takes {}", fmt::join(taken, ", "))));
    }
    if (command_->get_option("--resolution")->count() > 0 && lists_all_directions()) {
        throw UsageError(
            "--resolution makes the lists of directions that are not given; here all three are "
            "given");
    }
    if (component_ != "transmitted") parse_brdf_part(component_);
}

Measurements ExportArguments::measurements() const {
    for (const SceneWord& word : scene_words()) {
        if (!scene_.given(word.name)) continue;
        throw UsageError(
            fmt::format("--from takes measured values in place of a scene; leave --{} "
                        "out, or --from",
                        word.name));
    }
    if (format().content != FormatContent::table && format().content != FormatContent::sampled) {
        throw UsageError(
            fmt::format("format '{}' holds no BRDF, which is what --from gives", format_));
    }
    MeasuredOptions options;
    options.column = column_;
    options.azimuth_zero = azimuth_zero_;
    return read_measured(from_, options);
}

Request ExportArguments::scene() const {
    if (!column_.empty() || !azimuth_zero_.empty())
        throw UsageError("--column and --azimuth-zero belong to --from FILE");
    return exported_request(scene_);
}

ExportOptions ExportArguments::file() const {
    ExportOptions options = options_;
    rte::Directions& directions = options.directions;
    if (mu_in_.given()) directions.mu_in = mu_in_.parse();
    if (mu_out_.given()) directions.mu_out = mu_out_.parse();
    if (!azimuth_.empty()) {
        directions.azimuth_deg = parse_number_list(azimuth_, "azimuth (degrees)", -360.0, 360.0);
    }
    // Options that were not typed, or belong to another format, are not looked at.
    std::erase_if(options.extra, [&](const auto& extra) {
        return command_->get_option(option_of(extra.first))->count() == 0;
    });
    return options;
}

std::string worst_of(const RegionDeviation& region) {
    return fmt::format("{:+.3g} % at mu_in {:.3g}, mu_out {:.3g}, azimuth {:.4g}",
                       100.0 * region.worst, region.where.mu_in, region.where.mu_out,
                       region.where.azimuth_deg);
}

std::vector<std::string> ignored_options_of(const std::string& format) {
    const Format& known = find_format(format);
    const std::vector<std::string> taken = file_options_of(known);
    std::vector<std::string> ignored;
    for (const Format& other : all_formats()) {
        for (const std::string& option : file_options_of(other)) {
            const bool there = std::find(taken.begin(), taken.end(), option) != taken.end() ||
                               std::find(ignored.begin(), ignored.end(), option) != ignored.end();
            if (!there) ignored.push_back(option);
        }
    }
    if (known.files.empty()) ignored.emplace_back("--component");
    if (known.content == FormatContent::scattering)
        ignored.insert(ignored.end(), std::begin(kOfTransfer), std::end(kOfTransfer));
    return ignored;
}

}  // namespace miebrdf::program
