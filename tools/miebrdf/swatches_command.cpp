// miebrdf swatches: scenes as a sheet of colours.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>

#include <miebrdf/error.h>
#include "pipeline/io/markup.h"
#include "pipeline/plot/panel.h"
#include "pipeline/scene/labels.h"
#include "pipeline/solve/named_index.h"
#include "tools/miebrdf/plot_scenes.h"
#include "tools/miebrdf/reflection_options.h"
#include "tools/miebrdf/run_command.h"

namespace miebrdf::program {
namespace {

struct SwatchArguments {
    ScenePlot scenes = std::make_shared<ScenePlotArguments>();
    std::vector<std::string> files;
    DirectionArgument mu_in{DirectionArgument::Side::in};
    std::string over = "black,white", viewing = "d65";
};

/// A scene seen on one ground.
struct Patch {
    std::string ground;  ///< empty: the scene's own, which it hides or says
    LinearSrgb ground_colour;
    Colour colour;
};

struct Swatch {
    std::string name;
    std::vector<Patch> patches = {};      ///< over the dark and the light ground, or one
    std::vector<std::string> words = {};  ///< its name, then a line for each patch
    std::optional<double> contrast_ratio = {};
    bool is_doubtful = false;  ///< a table of its media is not for colours
};

struct Sheet {
    std::vector<Swatch> swatches;
    Table table;  ///< its facts
    bool converged = true;
};

std::vector<ShownScene> swatch_scenes(const SwatchArguments& arguments) {
    const SceneArguments& words = arguments.scenes->scene;
    std::vector<ShownScene> all;
    for (const std::string& file : arguments.files) {
        for (NamedScene& one : read_scenes(file)) {
            if (words.given("wavelengths")) one.request.wavelength_nm = words.parse().wavelength_nm;
            const std::string stem = std::filesystem::path(file).stem().string();
            all.push_back({words.complete(std::move(one.request)),
                           arguments.files.size() > 1 ? stem + ": " + one.name : one.name});
        }
    }
    if (words.given("base") || words.given("coat") || words.given("substrate")) {
        for (ShownScene& one : shown_scenes(*arguments.scenes, words.parse())) {
            if (one.label.empty()) one.label = label_of(one.request.scene);
            all.push_back(std::move(one));
        }
    }
    if (all.empty())
        throw UsageError(
            "swatches need a scene: scene files (SCENE.toml), or --base, --coat and the like");
    for (ShownScene& one : all) {
        prepare_for_colour(one.request.wavelength_nm);
        const Scene& scene = one.request.scene;
        if (!scene.substrate && scene.base.species.empty() && scene.layers.empty())
            throw UsageError(
                fmt::format("scene '{}' has neither base, substrate nor coat", one.label));
    }
    return all;
}

/// The plane albedo at the only mu_in.
Colour colour_of(const AlbedoValues& values, const std::vector<double>& wavelength_nm,
                 const Viewing& viewing) {
    std::vector<double> spectrum;
    spectrum.reserve(values.plane_albedo.size());
    for (const std::vector<double>& at : values.plane_albedo) spectrum.push_back(at.front());
    return Colorimeter(wavelength_nm, viewing)(spectrum);
}

LinearSrgb colour_of(const Substrate& ground) {
    const std::vector<double>& albedo = ground.albedo;
    const bool is_grey = ground.kind == Substrate::Kind::lambertian && !albedo.empty();
    const double grey =
        is_grey ? std::accumulate(albedo.begin(), albedo.end(), 0.0) / double(albedo.size()) : 0.0;
    return {grey, grey, grey};
}

Sheet solve_all(const std::vector<ShownScene>& scenes, const SwatchArguments& arguments,
                const Shell& shell) {
    const std::vector<Substrate> grounds = parse_grounds(arguments.over);
    const Viewing light = viewing(arguments.viewing);
    const std::vector<double> mu_in = arguments.mu_in.parse("0.99026806874157");  // 8 degrees
    if (mu_in.size() != 1) throw UsageError("swatches are seen in one light; give one --mu-in");
    Sheet sheet;
    auto& facts = sheet.table.facts;
    facts.emplace_back(
        "units",
        "X, Y, Z: white of the illuminant has Y = 1; L, a, b: CIE 1976; hex: sRGB of "
        "8 bits, clipped; srgb: encoded, linear and acescg: linear, none clipped; "
        "contrast_ratio: Y over the dark ground by Y over the light one");
    facts.emplace_back("viewing", describe(light));
    facts.emplace_back("mu_in", mu_in.front());
    Control control = shell.control();
    if (control.memo == nullptr) control.memo = make_optics_memo();
    for (const ShownScene& shown : scenes) {
        const Request& request = shown.request;
        facts.emplace_back("scene", fmt::format("{}: {}", shown.label, describe(request.scene)));
        Swatch swatch{.name = shown.label, .words = {shown.label}};
        const auto add = [&](const AlbedoValues& values, const std::string& ground,
                             const LinearSrgb& ground_colour) {
            if (swatch.patches.empty()) {
                for (const std::string& note : values.notes) {
                    facts.emplace_back("note", shown.label + ": " + note);
                    swatch.is_doubtful |= note.find(kColourCaveat) != std::string::npos;
                }
            }
            const Colour colour = colour_of(values, request.wavelength_nm, light);
            swatch.patches.push_back({ground, ground_colour, colour});
            swatch.words.push_back(fmt::format(
                "{}{:.1f}, {:.1f}, {:.1f}  {}", ground.empty() ? "" : "over " + ground + ": ",
                colour.lab.l, colour.lab.a, colour.lab.b, plot::css_colour(colour.srgb)));
            sheet.converged = sheet.converged && values.converged();
            for (const std::string& line : values.shortfalls())
                facts.emplace_back("not converged", shown.label + ": " + line);
        };
        if (request.scene.substrate || !request.scene.base.species.empty()) {
            add(solved(request, control).albedo(mu_in), "", {});
        } else {
            const Drawdown film =
                draw_down(request.scene, request.wavelength_nm, mu_in,
                          {grounds[0], grounds[1], 0.0, light}, request.solver, control);
            add(film.over_dark, describe(grounds[0]), colour_of(grounds[0]));
            add(film.over_light, describe(grounds[1]), colour_of(grounds[1]));
            swatch.contrast_ratio = film.hiding.front().contrast_ratio;
            swatch.words[0] += fmt::format(", contrast ratio {:.3f}", *swatch.contrast_ratio);
        }
        sheet.swatches.push_back(std::move(swatch));
    }
    return sheet;
}

void add_patch_rows(Sheet& sheet, const Viewing& light) {
    Table& table = sheet.table;
    table.columns = {"name",     "over",     "X",        "Y",        "Z",        "L",
                     "a",        "b",        "hex",      "srgb_r",   "srgb_g",   "srgb_b",
                     "linear_r", "linear_g", "linear_b", "acescg_r", "acescg_g", "acescg_b"};
    table.columns.insert(table.columns.end(), {"contrast_ratio", "colour_error"});
    for (const Swatch& swatch : sheet.swatches) {
        for (const Patch& patch : swatch.patches) {
            const auto& [xyz, lab, lch, rgb, error] = patch.colour;
            std::vector<Cell>& row = table.rows.emplace_back(
                std::vector<Cell>{swatch.name, patch.ground.empty() ? Cell() : Cell(patch.ground),
                                  xyz.x, xyz.y, xyz.z, lab.l, lab.a, lab.b, plot::css_colour(rgb)});
            for (const double value : {rgb.red, rgb.green, rgb.blue})
                row.emplace_back(encode_srgb(value));
            row.insert(row.end(), {rgb.red, rgb.green, rgb.blue});
            for (const double value : to_acescg(xyz, light)) row.emplace_back(value);
            row.insert(row.end(), {cell_of(swatch.contrast_ratio), rounded(error, 2)});
        }
    }
}

/// A cell for each scene, in rows: its colour, over two grounds as a drawdown, above its words.
plot::Picture draw(const Sheet& sheet, const plot::Caption& caption) {
    constexpr double kPage = 1280.0, kPatch = 40.0, kRim = 8.0, kGap = 14.0, kTop = 62.0,
                     kLine = 15.0, kText = 11.5;
    const std::string legend =
        "L*, a*, b* and sRGB; a white corner: outside sRGB; red: a table is not for colours";
    double cell = 120.0, row = 0.0;
    for (const Swatch& swatch : sheet.swatches) {
        for (const std::string& words : swatch.words)
            cell = std::max(cell, plot::SvgDrawing::text_width(words, kText));
        row = std::max(row, kPatch + kLine * double(swatch.words.size()) + kGap);
    }
    const std::size_t count = sheet.swatches.size();
    const auto fitting = static_cast<std::size_t>((kPage - kGap) / (cell + kGap));
    const std::size_t columns = std::clamp(fitting, std::size_t{1}, count);
    const double head = std::max(plot::SvgDrawing::text_width(legend, kText),
                                 plot::SvgDrawing::text_width(caption.title, 1.4 * kText));
    plot::SvgDrawing drawing(std::max(head + kGap, double(columns) * (cell + kGap)) + kGap,
                             kTop + row * double((count + columns - 1) / columns));
    drawing.text({kGap, 24.0}, caption.title, {.size = 1.4 * kText});
    drawing.text({kGap, 46.0}, legend, {.size = kText, .colour = "#555555"});
    for (std::size_t i = 0; i < count; ++i) {
        const Swatch& swatch = sheet.swatches[i];
        const plot::Point corner{kGap + double(i % columns) * (cell + kGap),
                                 kTop + double(i / columns) * row};
        const double part = cell / double(swatch.patches.size());
        const double rim = swatch.patches.size() > 1 ? kRim : 0.0;
        double left = corner.x, line = corner.y + kPatch;
        for (const Patch& patch : swatch.patches) {
            if (rim > 0.0)
                drawing.rectangle({left, corner.y}, part, kPatch,
                                  plot::css_colour(patch.ground_colour));
            const double top = corner.y + rim, right = left + part;
            drawing.rectangle({left, top}, part, kPatch - 2.0 * rim,
                              plot::css_colour(patch.colour.srgb));
            const auto& [red, green, blue] = patch.colour.srgb;
            const auto [low, high] = std::minmax({red, green, blue});
            if (!(low >= -1e-3 && high <= 1.001))
                drawing.polygon({{right - kRim, top}, {right, top}, {right, top + kRim}}, "#fff");
            left = right;
        }
        drawing.frame(corner, cell, kPatch, {.colour = "#bbbbbb"});
        for (const std::string& words : swatch.words)
            drawing.text({corner.x, line += kLine}, words,
                         {.size = kText, .colour = swatch.is_doubtful ? "#b00020" : "#000000"});
    }
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

/// The picture and the numbers as one page that needs no other file.
std::string page_of(const Sheet& sheet, const plot::Picture& picture, const std::string& title) {
    const auto text_of = [](const Cell& cell) {
        const auto* number = std::get_if<double>(&cell);
        const auto* text = std::get_if<std::string>(&cell);
        return number != nullptr ? fmt::format("{:.4f}", *number) : text != nullptr ? *text : "";
    };
    std::vector<std::vector<std::string>> rows = {sheet.table.columns}, facts = {{"fact", "value"}};
    for (const std::vector<Cell>& row : sheet.table.rows)
        std::transform(row.begin(), row.end(), std::back_inserter(rows.emplace_back()), text_of);
    for (const auto& [name, value] : sheet.table.facts) facts.push_back({name, text_of(value)});
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title>\n"
        "<style>body{{font:14px sans-serif;margin:16px}}svg{{max-width:100%;height:auto}}"
        "div{{overflow-x:auto}}table{{border-collapse:collapse}}th,td{{padding:3px 8px;"
        "border-bottom:1px solid #ddd;text-align:left}}</style></head>\n<body>\n{}\n"
        "<div>{}</div>{}</body></html>\n",
        escape_markup(title), picture.svg.substr(picture.svg.find("<svg")), html_table(rows),
        html_table(facts));
}

int run_swatches(const SwatchArguments& arguments, const std::vector<ShownScene>& scenes,
                 const Shell& shell) {
    Sheet sheet = solve_all(scenes, arguments, shell);
    add_patch_rows(sheet, viewing(arguments.viewing));
    const std::string& output = shell.common().output;
    const plot::Caption caption = arguments.scenes->plot.caption(
        shell, fmt::format("{} under {}", scenes.size() == 1 ? "Colour" : "Colours",
                           describe(viewing(arguments.viewing))));
    if (output.ends_with(".svg") || output.ends_with(".png")) {
        arguments.scenes->plot.save(draw(sheet, caption), shell);
    } else if (output.ends_with(".html")) {
        sheet.table.facts.emplace_back("command", shell.command_line());
        shell.write_text(page_of(sheet, draw(sheet, caption), caption.title));
        shell.tell_written({.columns = {"file"}, .rows = {{output}}});
    } else {
        return shell.write(std::move(sheet.table), sheet.converged);
    }
    return sheet.converged ? kGood : kNotConverged;
}

}  // namespace

void add_swatches(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<SwatchArguments>();
    option(command, "scenes", arguments->files, "SCENE.toml",
           "scene files: a row for each [scene.NAME], or for each result of a file that names no "
           "scenes");
    arguments->scenes->scene.add_to(command, shell, SceneArguments::Base::optional, "400:700:10");
    add_scene_choices(command, arguments->scenes);
    arguments->mu_in.add_to(command, "cosine of the angle of incidence, in (0, 1]",
                            "0.990268 (8 degrees)");
    option(command, "--over", arguments->over, "GROUNDS",
           "the dark and the light ground below scenes that have neither base nor substrate, each "
           "written as for --substrate; white has an albedo of 0.8");
    option(command, "--colour,--color", arguments->viewing, "ILLUMINANT",
           "illuminant d65, d50, a or e and, after a comma, the observer's degrees: d65,10");
    arguments->scenes->plot.add_to(command);
    shell.add_common_options(command);
    command.footer(
        "-o FILE.svg, .png or .html draws the sheet; else the table has X, Y, Z, Lab, hex, sRGB "
        "and ACEScg.\nExample:\n  miebrdf swatches --boundary smooth --host-index 1.5 --base "
        "paste:acrylic_red_oxide --compare paste:acrylic_violet -o sheet.svg");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        const std::string& output = shell.common().output;
        if (output.ends_with(".svg") || output.ends_with(".png"))
            arguments->scenes->plot.check(shell);
        const std::vector<ShownScene> scenes = swatch_scenes(*arguments);
        return [arguments, scenes, &shell] { return run_swatches(*arguments, scenes, shell); };
    });
}

}  // namespace miebrdf::program
