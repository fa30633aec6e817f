#include <miebrdf/brdf.h>
#include <miebrdf/formats.h>

#include <fstream>
#include <iostream>
#include <iterator>

void show_formats() {
    using namespace miebrdf;
    const Format& rgl = find_format("rgl");
    std::cout << all_formats().size() << " formats; " << rgl.name << " is read by " << rgl.readers
              << " and takes";
    for (const std::string& option : options_of(rgl)) std::cout << ' ' << option;
    const Fineness& fineness = rgl.resolution;
    std::cout << "; " << fineness.standard << ' ' << fineness.unit << '\n';
    for (const FormatOption& option : rgl.extra)
        std::cout << option.name << ": " << option.help << '\n';
    for (const FormatFile& file : rgl.files) std::cout << "writes *" << file.suffix << '\n';
    std::cout << "accepted rms at grazing angles " << rgl.accepted.of(RegionKind::grazing) << '\n';

    const BrdfTable table = solve({.base = medium("hg:0.9,0.3")}, {450, 550, 650}).table();
    ExportOptions options{.resolution = 32};
    options.largest_error = 0.2;
    std::cout << "about " << expected_bytes(rgl, options, 3) << " bytes\n";
    try {
        for (const ExportedFile& file : export_brdf(table, "rgl", "grey.bsdf", options)) {
            std::cout << file.path << ": " << file.bytes << " bytes\n";
            if (const Deviation* off = file.deviation ? &*file.deviation : nullptr) {
                const RegionDeviation* worst = worst_region(*off, AcceptedErrors{}.with_plain(0.2));
                std::cout << "off by " << off->rms[0] << (worst ? worst->name : "") << '\n';
            }
        }
    } catch (const TooCoarse& error) {  // nothing was written
        std::cout << error.what() << '\n';
    }

    const std::unique_ptr<BrdfFile> file = open_brdf_file("grey_spec.bsdf");
    std::vector<double> values(file->channels().size());
    file->evaluate({0.5, 0.9, 0.0}, values);
    const FileCheck check = check_file(*file, 200);
    const FileComparison comparison = compare_file(*file, table);
    std::cout << file->format() << ": " << values[0] << " / sr, reflects at most "
              << check.largest_albedo.value_or(0) << ", albedos within " << comparison.albedo_error
              << '\n';
    const std::optional<ListedDirections> listed = file->listed();
    if (!listed) std::cout << "it has no list of directions\n";
    const FormatReader& reader = rgl.reader;  // what open_brdf_file and read_brdf_file ask
    std::ifstream stream("grey_spec.bsdf", std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(stream), {}};
    if (reader.recognise(content) == Recognised::by_first_bytes)
        std::cout << read_brdf_file(content, "grey_spec.bsdf")->description() << '\n';
    if (file->sampling() == BrdfFile::Sampling::from_mu_out) {
        if (const auto drawn = file->sample(0.5, 0.3, 0.7))
            std::cout << "drawn with density " << file->density(*drawn) << '\n';
    }

    std::cout << "not in the file: " << left_out_of(rgl, table.provenance()) << '\n';
    ExportOptions with_medium;
    with_medium.subsurface = SubsurfaceMedium{.mean_free_path_um = {90, 90, 90}, .asymmetry = 0.3};
    const OpenPbrFit fit = fit_openpbr(table, with_medium);
    const OpenPbr& surface = fit.surface;
    for (const OpenPbrParameter& one : openpbr_parameters()) {
        if (one.number != nullptr) std::cout << one.name << ' ' << surface.*one.number << '\n';
    }
    const std::vector<Direction> along_the_normal = {{1.0, 1.0, 0.0}};
    std::cout << openpbr_brdf(surface, along_the_normal)[0][0] << " / sr in " << fit.colour_space
              << '\n';
    const GroundFit ground = fit_ground(table, "rpv");
    std::cout << ground.parameters[0] << ' ' << ground.grounds[0].values[0] << ", off by "
              << ground.deviation.rms[0] << '\n';

    const ReflectanceSpectrum spectrum{{400, 500, 600, 700}, {0.1, 0.2, 0.3, 0.4}, {"an example"}};
    export_spectrum(spectrum, "spd", "grey.spd");
    ScatteringTable scattering;
    scattering.wavelength_nm = {550};
    scattering.single_scattering_albedo = {0.9};
    scattering.asymmetry = {0.3};
    scattering.q_ext = {2.0};
    scattering.chi = {{1.0, 0.3}};
    scattering.metadata = "{}";
    for (const Format& format : all_formats()) {
        if (format.content == FormatContent::scattering)
            export_scattering(scattering, format.name, "haze" + format.endings[0]);
    }
}
