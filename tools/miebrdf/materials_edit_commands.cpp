// miebrdf materials import, alias, default, remove: what changes the user's database.
#include <fmt/format.h>

#include <miebrdf/database.h>
#include <miebrdf/error.h>
#include "materials/index/units.h"
#include "tools/miebrdf/materials_command.h"

namespace miebrdf::program {
namespace {

using materials::Database;
using materials::DatabaseWriter;

struct ImportArguments {
    DatabaseArgument database;
    std::vector<std::string> files;
    bool replace = false;
    std::string unit;
    materials::ImportOptions options;
};

std::string outcome_text(const materials::ImportItem& item) {
    if (!item.outcome) return "refused";
    switch (*item.outcome) {
        case materials::AddOutcome::added:
            return "added";
        case materials::AddOutcome::replaced:
            return "replaced";
        case materials::AddOutcome::unchanged:
            return "unchanged";
    }
    return "";
}

Table table_of(const std::vector<materials::ImportItem>& items, const Shell& shell) {
    Table table;
    table.columns = {"file", "outcome", "dataset", "remarks"};
    std::size_t refused = 0, corrected = 0, unchanged = 0;
    for (const auto& item : items) {
        refused += !item.outcome;
        unchanged += item.outcome == materials::AddOutcome::unchanged;
        corrected += !item.corrections.empty();
        const std::string remarks =
            item.outcome ? fmt::format("{}", fmt::join(item.corrections, "; ")) : item.reason;
        table.rows.push_back({item.file, outcome_text(item), item.dataset, remarks});
    }
    const std::string summary =
        fmt::format("{} read: {} accepted ({} with corrections, {} known already), {} refused",
                    items.size(), items.size() - refused, corrected, unchanged, refused);
    table.facts.emplace_back("summary", summary);
    shell.note(summary);
    return table;
}

int run_import(const ImportArguments& arguments, const Shell& shell) {
    materials::ImportOptions options = arguments.options;
    options.replace = arguments.replace;
    if (!arguments.unit.empty()) options.unit = materials::parse_unit(arguments.unit);
    if (arguments.files.size() > 1 && !options.label.empty()) {
        throw UsageError("--label names one dataset, so it goes with one file");
    }
    const std::vector<std::filesystem::path> files(arguments.files.begin(), arguments.files.end());
    return shell.write(
        table_of(materials::import_files(arguments.database.file(), files, options), shell));
}

void add_import(CLI::App& materials, Shell& shell) {
    auto arguments = std::make_shared<ImportArguments>();
    auto* command =
        materials.add_subcommand("import", "add files or folders to the user's database");
    option(*command, "files", arguments->files, "",
           "files, folders, or a folder with the refractiveindex.info database")
        ->required()
        ->check(CLI::ExistingPath);
    std::vector<std::string> formats;
    for (const auto& format : materials::material_formats()) {
        if (!format.read) continue;
        formats.push_back(format.name);
        if (!format.other_name.empty()) formats.push_back(format.other_name);
    }
    option(*command, "--format", arguments->options.format, "",
           "format of the files; default: recognised by their content")
        ->check(CLI::IsMember(formats));
    option(*command, "--name", arguments->options.material, "",
           "name of the material; default: that in the file or of the file");
    option(*command, "--label", arguments->options.label, "",
           "name of the dataset within the material");
    option(*command, "--source", arguments->options.source, "",
           "collection that the data come from");
    option(*command, "--negative-k-tolerance", arguments->options.negative_k_tolerance, "",
           "negative k down to minus this number is taken for noise and set to 0")
        ->check(CLI::NonNegativeNumber);
    option(*command, "--unit", arguments->unit, "",
           "unit of the first column if the file does not name it; with it, files of bare columns "
           "(wavelength, n and perhaps k) can be read")
        ->check(CLI::IsMember({"nm", "um", "A", "eV", "cm-1", "THz"}));
    command->add_flag("--skip-bad-rows", arguments->options.skip_bad_rows,
                      "leave out rows that are not numbers or not physical (up to a tenth of all) "
                      "and list them, instead of refusing the file");
    command->add_flag("--replace", arguments->replace,
                      "replace a dataset of the same name that has other values");
    arguments->database.add_to(*command);
    finish(*command, shell, arguments, run_import,
           "If one of the files named is bad, nothing is changed. In a folder, bad files are "
           "refused one by one.\nExample:\n  miebrdf materials import my_oxide.csv --name MyOxide "
           "--source \"our lab\"");
}

struct EditArguments {
    DatabaseArgument database;
    std::string name, second;
    bool remove = false, dry_run = false;
};

int run_alias(const EditArguments& arguments, const Shell& shell) {
    const std::filesystem::path file = arguments.database.file();
    if (arguments.remove) {
        if (!std::filesystem::exists(file) || !DatabaseWriter(file).remove_alias(arguments.name)) {
            throw InputError(fmt::format("'{}' is no alias in {}", arguments.name, file.string()));
        }
        shell.note(fmt::format("the alias '{}' is removed", arguments.name));
        return kGood;
    }
    if (arguments.second.empty())
        throw UsageError("alias needs two words: the alias, and the material that it stands for");
    const Database known = Database::layered(file);
    const std::string material = known.info(arguments.second).name;
    if (const auto taken = known.resolve_exactly(arguments.name); taken && *taken != material) {
        throw InputError(fmt::format("'{}' already means {}", arguments.name, *taken));
    }
    DatabaseWriter(file).add_alias(material, arguments.name);
    shell.note(fmt::format("'{}' now means {}", arguments.name, material));
    return kGood;
}

int run_default(const EditArguments& arguments, const Shell& shell) {
    const Database known = Database::layered(arguments.database.file());
    const auto dataset = known.dataset_info(arguments.name);
    DatabaseWriter(arguments.database.file()).set_default(dataset.material, dataset.label);
    shell.note(
        fmt::format("{} now means {}/{}", dataset.material, dataset.material, dataset.label));
    return kGood;
}

int run_remove(const EditArguments& arguments, const Shell& shell) {
    const Database known = Database::layered(arguments.database.file());
    const bool whole = !known.resolve(arguments.name).empty();
    std::vector<materials::DatasetInfo> asked;
    if (whole) {
        asked = known.datasets(arguments.name);
    } else {
        asked = {known.dataset_info(arguments.name)};
    }
    std::erase_if(asked, [](const auto& dataset) { return dataset.layer == "embedded"; });
    const std::filesystem::path file = arguments.database.file();
    if (arguments.dry_run) {
        Table table;
        table.columns = {"dataset", "source", "reference"};
        for (const auto& d : asked)
            table.rows.push_back({d.material + "/" + d.label, d.source, d.reference});
        shell.write(std::move(table));
        shell.note(fmt::format("{} dataset{} would be removed", asked.size(),
                               asked.size() == 1 ? "" : "s"));
        return kGood;
    }
    bool removed = false;
    if (whole && std::filesystem::exists(file)) {
        removed = DatabaseWriter(file).remove_material(known.info(arguments.name).name);
    } else if (!whole && !asked.empty()) {
        removed = DatabaseWriter(file).remove_dataset(asked[0].material, asked[0].label);
    }
    if (!removed) {
        throw InputError(fmt::format("{} is not in {}; the embedded database cannot be changed",
                                     arguments.name, file.string()));
    }
    shell.note(fmt::format("{} removed: {} dataset{} of your own", arguments.name, asked.size(),
                           asked.size() == 1 ? "" : "s"));
    return kGood;
}

CLI::App* add_edit(CLI::App& materials, Shell& shell, const std::string& name,
                   const std::string& help, const std::shared_ptr<EditArguments>& arguments,
                   int (*run)(const EditArguments&, const Shell&)) {
    auto* command = materials.add_subcommand(name, help);
    arguments->database.add_to(*command);
    shell.add_common_options(*command);
    shell.on_run(*command, [arguments, run, &shell] { return run(*arguments, shell); });
    return command;
}

}  // namespace

void add_materials_edit_commands(CLI::App& materials, Shell& shell) {
    add_import(materials, shell);

    auto alias = std::make_shared<EditArguments>();
    auto* command =
        add_edit(materials, shell, "alias", "give a material another name", alias, run_alias);
    option(*command, "alias", alias->name, "", "the new name")->required();
    option(*command, "material", alias->second, "", "the material that it stands for");
    command->add_flag("--remove", alias->remove, "remove the alias");
    command->footer("Example:\n  miebrdf materials alias \"my white\" TiO2");

    auto chosen = std::make_shared<EditArguments>();
    command = add_edit(materials, shell, "default",
                       "choose the dataset that a material's name stands for", chosen, run_default);
    option(*command, "dataset", chosen->name, "", "NAME/DATASET or SOURCE:KEY")->required();
    command->footer("Example:\n  miebrdf materials default GaP/SOPRA-GAP");

    auto gone = std::make_shared<EditArguments>();
    command = add_edit(materials, shell, "remove", "remove a material or dataset of your own", gone,
                       run_remove);
    option(*command, "name", gone->name, "", "NAME or NAME/DATASET")->required();
    command->add_flag("--dry-run", gone->dry_run,
                      "list the datasets that would be removed, and remove nothing");
    command->footer("Example:\n  miebrdf materials remove GaP/SOPRA-GAP");
}

}  // namespace miebrdf::program
