// miebrdf measured: what an instrument's file says, as this program understands it.
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/measured_options.h"

namespace miebrdf::program {
namespace {

struct MeasuredQuestion {
    std::string file, picture;
    MeasuredArguments arguments;
};

Cell number(double value) { return std::isnan(value) ? Cell() : Cell(value); }

std::string title_of(const Measurements& list) {
    const std::string name = std::filesystem::path(list.file).stem().string();
    return list.samples.size() == 1 && list.format != "csv" ? list.samples.front() : name;
}

int run_measured(const MeasuredQuestion& question, const Shell& shell) {
    if (!question.picture.empty()) plot::check_picture_path(question.picture);
    const Measurements list = question.arguments.read(question.file);
    Table table;
    table.facts.emplace_back("file", list.file);
    table.facts.emplace_back("format", list.format);
    for (const auto& [name, text] : list.facts) table.facts.emplace_back(name, text);
    for (const std::string& doubt : list.doubts) {
        table.facts.emplace_back("doubt", doubt);
        shell.note("doubt: " + doubt);
    }
    table.facts.emplace_back(
        "units",
        "reflectance, transmittance: shares of the incident light; brdf: 1/sr; "
        "reflectance_factor: white Lambertian = 1; azimuth_deg: 0 = mirror side; sigma: standard "
        "error");
    table.columns = {"quantity", "geometry",    "wavelength_nm", "mu_in",
                     "mu_out",   "azimuth_deg", "value",         "sigma"};
    const bool several = list.samples.size() > 1;
    if (several) table.columns.emplace_back("sample");
    for (const MeasuredValue& v : list.values) {
        table.rows.push_back({word_of(v.quantity), word_of(v.geometry), number(v.wavelength_nm),
                              number(v.mu_in), number(v.mu_out), number(v.azimuth_deg), v.value,
                              number(v.sigma)});
        if (several) table.rows.back().emplace_back(list.samples[v.sample]);
    }
    if (!several) table.facts.emplace_back("sample", list.samples.front());
    if (!question.picture.empty()) {
        plot::save_picture(draw_measured(list, {title_of(list), shell.command_line()}),
                           question.picture);
    }
    return shell.write(std::move(table));
}

}  // namespace

void add_measured(CLI::App& command, Shell& shell) {
    auto question = std::make_shared<MeasuredQuestion>();
    option(command, "file", question->file, "FILE", "a file of an instrument, a library or a table")
        ->required();
    question->arguments.add_to(command);
    option(command, "--plot", question->picture, "FILE", "draw it, too: FILE.svg or FILE.png");
    finish(command, shell, question, run_measured,
           "Example:\n  miebrdf measured paint.cxf --plot paint.png -o paint.csv\n  miebrdf "
           "measured lacquer.csv --quantity d8-sci --percent --sigma 0.002");
}

}  // namespace miebrdf::program
