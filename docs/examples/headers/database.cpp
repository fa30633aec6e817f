#include <miebrdf/database.h>
#include <miebrdf/error.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

void show_database() {
    using namespace miebrdf::materials;
    const Database embedded = Database::embedded();  // Database::open(file): a file alone
    const MaterialInfo rutile = embedded.info("TiO2");
    std::cout << embedded.list().size() << " materials; " << rutile.title << " from "
              << rutile.shortest_nm << " nm\n";
    const SearchFilter filter{.text = "oxide", .covers_from_nm = 400, .covers_to_nm = 700};
    for (const DatasetInfo& dataset : embedded.datasets("TiO2"))
        std::cout << dataset.label << (fits(dataset, filter) ? " covers" : " misses") << '\n';
    std::cout << embedded.search(filter).size() << " oxides, " << embedded.search("gold").size()
              << " of gold; 'tio2' is " << embedded.resolve("tio2")[0] << '\n';
    if (const std::optional<CommonWord> snow = common_word("snow"))
        std::cout << snow->word << ": " << snow->meaning << '\n';
    try {
        embedded.refractive_index("TiO22");
    } catch (const UnknownMaterial& unknown) {  // an InputError; DatabaseError: the file is wrong
        std::cout << unknown.name << ": perhaps " << unknown.candidates[0] << '\n';
    } catch (const DamagedDatabase& damaged) {
        std::cout << damaged.what() << '\n';
    }

    // A file of one's own, usually default_user_database().
    const std::filesystem::path mine = "materials.sqlite", file = "ink.csv";
    std::filesystem::remove(mine);
    std::ofstream(file) << "500,1.5,0.01\n600,1.6,0.02\n700,1.7,0.01\n";
    ImportOptions options;
    options.material = "ink";
    options.unit = Unit::nanometre;
    Dataset ink = read_file(file, options);  // @throws ImportError
    for (const ImportItem& item : import_files(mine, std::vector{file}, options))
        std::cout << item.dataset << (item.outcome == AddOutcome::added ? " added\n" : "\n");
    DatabaseWriter writer(mine);
    ink.label = "second";
    writer.add(std::vector{ink}, AddOptions{.replace = true});
    writer.add_alias("ink", "toner");
    writer.set_default("ink", "second");
    const Database both = Database::layered(mine);
    std::cout << "toner at 550 nm: " << both.refractive_index("toner").at(550) << '\n';
    for (const Finding& finding : verify(both, "ink")) std::cout << finding.text << '\n';
    for (const ExportFile& part : export_dataset(both.dataset("ink"), "csv", ExportOptions{}))
        std::cout << "ink" << part.suffix << ": " << part.text.size() << " bytes\n";
    std::cout << "Kramers-Kronig leaves " << kramers_kronig_residual(embedded.dataset("TiO2"))
              << "; " << material_formats().size() << " formats, one of them "
              << MaterialFormat(material_formats()[0]).title << '\n';
    writer.remove_dataset("ink", "second");
    writer.remove_alias("toner");
    writer.remove_material("ink");
    std::cout << default_user_database().filename() << ' ' << both.integrity_problems().size()
              << " problems\n";
}
