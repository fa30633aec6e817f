// miebrdf report: one interactive page of solved scenes.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include "pipeline/report/page.h"
#include "pipeline/report/report_data.h"
#include "tools/miebrdf/result_facts.h"
#include "tools/miebrdf/run_command.h"
#include "tools/miebrdf/scene_family.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

constexpr char kReportWavelengths[] = "400:700:10";
/// Side by side on one page; more would be too small to compare.
constexpr std::size_t kMostScenes = 2;

struct ReportArguments {
    SceneArguments scene;
    std::vector<std::string> files;
    std::string vary, title;
};

struct NamedRequest {
    std::string name;
    Request request;
};

/// `FILE.toml`, the scene of its first result, or `FILE.toml#2`, that of its second.
NamedRequest read_named_scene(const std::string& text, const ReportArguments& arguments) {
    const std::size_t mark = text.rfind('#');
    const std::string path = text.substr(0, mark);
    const std::vector<SceneFileResult> results = read_scene_results(path);
    std::size_t number = 1;
    if (mark != std::string::npos) {
        const std::string digits = text.substr(mark + 1);
        number = digits.find_first_not_of("0123456789") == std::string::npos && digits.size() < 6 &&
                         !digits.empty()
                     ? std::stoul(digits)
                     : 0;
        if (number < 1 || number > results.size()) {
            throw UsageError(fmt::format("'{}': {} has {} results; allowed: #1 to #{}", text, path,
                                         results.size(), results.size()));
        }
    }
    NamedRequest named{std::filesystem::path(path).stem().string(), results[number - 1].request};
    if (results.size() > 1) named.name += fmt::format(", result {}", number);
    if (arguments.scene.given("wavelengths"))
        named.request.wavelength_nm = arguments.scene.parse().wavelength_nm;
    named.request = arguments.scene.complete(std::move(named.request));
    return named;
}

std::vector<NamedRequest> report_requests(const ReportArguments& arguments) {
    const bool typed = arguments.scene.given("base") || arguments.scene.given("substrate");
    std::vector<NamedRequest> all;
    if (typed) {
        const Request request = arguments.scene.parse();
        all.push_back({report::label_of(request.scene), request});
    }
    for (const std::string& file : arguments.files)
        all.push_back(read_named_scene(file, arguments));
    if (all.empty()) {
        throw UsageError(
            "report needs a scene: one or two scene files (SCENE.toml), or --base with its "
            "options");
    }
    if (all.size() > kMostScenes) {
        throw UsageError(
            fmt::format("{} scenes; allowed: {} on one page", all.size(), kMostScenes));
    }
    if (all.size() == 2 && all[0].name == all[1].name) all[1].name += " (2)";
    return all;
}

/// Of films whose wavelengths give a colour.
void add_contrast_ratio(Facts& facts, const Request& request, const Shell& shell) {
    const bool has_depth = std::any_of(request.scene.layers.begin(), request.scene.layers.end(),
                                       [](const Layer& layer) { return layer.depth.value > 0.0; });
    if (!request.scene.substrate || !has_depth || !covers_the_visible(request.wavelength_nm))
        return;
    const Drawdown film =
        draw_down(request.scene, request.wavelength_nm, {1.0}, {.hiding_contrast_ratio = 0.0},
                  request.solver, shell.control());
    facts.emplace_back(
        "contrast_ratio",
        fmt::format("{:.4f} at normal incidence, {:.4f} in diffuse light (Y over black by Y over a "
                    "white of 0.8, D65)",
                    film.hiding[0].contrast_ratio, film.hiding[1].contrast_ratio));
}

report::ReportScene solve_family(const NamedRequest& named, const ReportArguments& arguments,
                                 const Shell& shell) {
    report::ReportScene scene{named.name, report::label_of(named.request.scene)};
    const Family family = arguments.vary.empty() ? Family{} : parse_family(arguments.vary);
    scene.varied = family.label(named.request);
    for (const double value : family.values_or_one()) {
        Request request = named.request;
        std::string label = family.apply(value, request);
        scene.variants.push_back({solved(request, shell.control()), std::move(label), value,
                                  [request, &shell](const ResultReport& result) {
                                      Facts facts =
                                          page_facts(request.scene, result, shell.command_line());
                                      add_contrast_ratio(facts, request, shell);
                                      return facts;
                                  }});
    }
    return scene;
}

int run_report(const ReportArguments& arguments, const Shell& shell) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<report::ReportScene> scenes;
    std::string title = arguments.title;
    for (const NamedRequest& named : report_requests(arguments)) {
        scenes.push_back(solve_family(named, arguments, shell));
        if (arguments.title.empty()) title += (title.empty() ? "" : " beside ") + named.name;
    }
    const report::ReportData data = report::collect(scenes, shell.control());
    const bool converged = data.shortfalls.empty();
    const std::string page = report::make_page(data.bytes.compressed(data.root), title);
    shell.write_text(page);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    Table files{.facts = {{"converged", std::string(converged ? "yes" : "no")},
                          {"interpolation_error", rounded(data.interpolation_error, 2)}},
                .columns = {"file", "bytes"}};
    files.rows.push_back({shell.common().output, double(page.size())});
    shell.tell_written(std::move(files));
    shell.note(
        fmt::format("{:.2f} MB in {:.1f} s; between the points of its tables the page is "
                    "within {:.1e} of the largest value at an incidence; solver {}",
                    double(page.size()) * 1e-6, seconds.count(), data.interpolation_error,
                    converged ? "converged" : "NOT converged"));
    if (!report::page_has_3d()) {
        shell.note(
            "this build has no three.js (Debian: libjs-three): the page draws the sphere "
            "without WebGL and shows no lobe in 3D");
    }
    if (!converged) shell.set_advice(advice_on(data.shortfalls));
    return converged ? kGood : kNotConverged;
}

}  // namespace

void add_report(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<ReportArguments>();
    option(command, "scenes", arguments->files, "SCENE.toml",
           "one or two scene files, shown side by side; FILE.toml#2 is the scene of the file's "
           "second result, FILE.toml that of its first");
    arguments->scene.add_to(command, shell, SceneArguments::Base::optional, kReportWavelengths);
    option(command, "--vary", arguments->vary, "NAME=FROM:TO:COUNT",
           "solve the scene COUNT times, with a slider on the page; NAME is depth (of the top "
           "layer, in its own unit), roughness, radius or concentration (of the top layer's first "
           "particles), or any option of the scene that takes a number");
    option(command, "--title", arguments->title, "TEXT", "title of the page");
    finish(command, shell, arguments, run_report,
           "Example:\n  miebrdf report --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 -o "
           "report.html\n  miebrdf report matt.toml glossy.toml -o pair.html",
           Writes::file);
}

}  // namespace miebrdf::program
