// miebrdf swatches: scenes as a sheet of colours.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include <miebrdf/error.h>
#include "pipeline/io/markup.h"
#include "pipeline/plot/panel.h"
#include "pipeline/scene/labels.h"
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
    std::vector<Patch> patches;  ///< over the dark and the light ground, or one
    std::optional<double> contrast_ratio;
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
        Swatch swatch{shown.label, {}, {}};
        const auto add = [&](const AlbedoValues& values, const std::string& ground,
                             const LinearSrgb& ground_colour) {
            swatch.patches.push_back(
                {ground, ground_colour, colour_of(values, request.wavelength_nm, light)});
            sheet.converged = sheet.converged && values.converged();
            for (const std::string& line : values.shortfalls())
                facts.emplace_back("not converged", shown.label + ": " + line);
        };
        if (request.scene.substrate || !request.scene.base.species.empty()) {
            const AlbedoValues values = solved(request, control).albedo(mu_in);
            for (const std::string& note : values.notes)
                facts.emplace_back("note", shown.label + ": " + note);
            add(values, "", {});
        } else {
            const Drawdown film =
                draw_down(request.scene, request.wavelength_nm, mu_in,
                          {grounds[0], grounds[1], 0.0, light}, request.solver, control);
            for (const std::string& note : film.over_dark.notes)
                facts.emplace_back("note", shown.label + ": " + note);
            add(film.over_dark, describe(grounds[0]), colour_of(grounds[0]));
            add(film.over_light, describe(grounds[1]), colour_of(grounds[1]));
            swatch.contrast_ratio = film.hiding.front().contrast_ratio;
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

std::string words_of_patch(const Patch& patch) {
    const auto& [xyz, lab, lch, rgb, error] = patch.colour;
    const auto is_outside = [](double value) { return !(value >= -1e-3 && value <= 1.001); };
    const bool clipped = is_outside(rgb.red) || is_outside(rgb.green) || is_outside(rgb.blue);
    return fmt::format("{}L* {:.1f}  a* {:.1f}  b* {:.1f}  {}{}",
                       patch.ground.empty() ? "" : "over " + patch.ground + ": ", lab.l, lab.a,
                       lab.b, plot::css_colour(rgb), clipped ? "  (outside sRGB)" : "");
}

/// A row for each scene: its colour, over two grounds as a drawdown, and words.
plot::Picture draw(const Sheet& sheet, const plot::Caption& caption) {
    constexpr double kPatch = 200.0, kHeight = 52.0, kRow = 66.0, kLeft = 20.0, kRim = 9.0;
    constexpr double kText = kLeft + kPatch + 14.0, kName = 13.0, kSmall = 11.5;
    double width = plot::SvgDrawing::text_width(caption.title, 16.0) + kLeft;
    for (const Swatch& swatch : sheet.swatches) {
        width = std::max(width, kText + plot::SvgDrawing::text_width(swatch.name, kName) + 130.0);
        for (const Patch& patch : swatch.patches)
            width = std::max(width,
                             kText + plot::SvgDrawing::text_width(words_of_patch(patch), kSmall));
    }
    plot::SvgDrawing drawing(std::min(width + kLeft, 1400.0),
                             50.0 + kRow * double(sheet.swatches.size()));
    drawing.text({kLeft, 28.0}, caption.title, {.size = 16.0});
    double top = 44.0;
    for (const Swatch& swatch : sheet.swatches) {
        const double part = kPatch / double(swatch.patches.size());
        const double rim = swatch.patches.size() > 1 ? kRim : 0.0;
        double left = kLeft, line = top + 14.0;
        for (const Patch& patch : swatch.patches) {
            if (rim > 0.0)
                drawing.rectangle({left, top}, part, kHeight,
                                  plot::css_colour(patch.ground_colour));
            drawing.rectangle({left, top + rim}, part, kHeight - 2.0 * rim,
                              plot::css_colour(patch.colour.srgb));
            left += part;
        }
        drawing.frame({kLeft, top}, kPatch, kHeight, {.colour = "#bbbbbb"});
        std::string name = swatch.name;
        if (swatch.contrast_ratio)
            name += fmt::format(", contrast ratio {:.3f}", *swatch.contrast_ratio);
        drawing.text({kText, line}, name, {.size = kName});
        for (const Patch& patch : swatch.patches)
            drawing.text({kText, line += 17.0}, words_of_patch(patch), {.size = kSmall});
        top += kRow;
    }
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

/// The picture and the numbers as one page that needs no other file.
std::string page_of(const Sheet& sheet, const plot::Picture& picture, const std::string& title) {
    std::string page = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
        "<style>body{{font:14px sans-serif;margin:16px}}svg{{max-width:100%;height:auto}}"
        "div{{overflow-x:auto}}table{{border-collapse:collapse}}th,td{{padding:3px 8px;"
        "border-bottom:1px solid #ddd;text-align:right;white-space:nowrap}}"
        "th:first-child,td:first-child{{text-align:left}}</style></head>\n<body>\n{1}\n<div><table>"
        "<tr>",
        escape_markup(title), picture.svg.substr(picture.svg.find("<svg")));
    for (const std::string& column : sheet.table.columns)
        page += "<th>" + escape_markup(column) + "</th>";
    for (const std::vector<Cell>& row : sheet.table.rows) {
        page += "</tr>\n<tr>";
        for (const Cell& cell : row) {
            const auto* number = std::get_if<double>(&cell);
            const auto* text = std::get_if<std::string>(&cell);
            page += fmt::format("<td>{}</td>", number != nullptr ? fmt::format("{:.4f}", *number)
                                               : text != nullptr ? escape_markup(*text)
                                                                 : "");
        }
    }
    page += "</tr></table></div>\n";
    for (const auto& [name, value] : sheet.table.facts) {
        const auto* text = std::get_if<std::string>(&value);
        page += fmt::format("<p>{}: {}</p>\n", escape_markup(name),
                            text != nullptr ? escape_markup(*text)
                                            : fmt::format("{:.4f}", std::get<double>(value)));
    }
    return page + "</body></html>\n";
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
