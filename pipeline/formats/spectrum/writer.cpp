// spd, irregular and scattering: what can be exported without directions. docs/formats/spectra.md
#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/table/npz.h"

namespace miebrdf {
namespace {

/// "nm value" lines under '#' comments.
void write_spd(const ReflectanceSpectrum& spectrum, std::ostream& out) {
    for (const std::string& comment : spectrum.comments) out << "# " << one_line(comment) << '\n';
    for (std::size_t i = 0; i < spectrum.value.size(); ++i) {
        out << fmt::format("{} {}\n", spectrum.wavelength_nm[i], spectrum.value[i]);
    }
}

/// A Mitsuba 3 <spectrum type="irregular"> element, comments before it.
void write_irregular(const ReflectanceSpectrum& spectrum, std::ostream& out) {
    for (const std::string& comment : spectrum.comments) {
        out << "<!-- " << in_xml_comment(one_line(comment)) << " -->\n";
    }
    out << "<spectrum type=\"irregular\" name=\"reflectance\">\n"
        << fmt::format("    <string name=\"wavelengths\" value=\"{}\"/>\n",
                       fmt::join(spectrum.wavelength_nm, ", "))
        << fmt::format("    <string name=\"values\" value=\"{}\"/>\n",
                       fmt::join(spectrum.value, ", "))
        << "</spectrum>\n";
}

/// Arrays wavelength_nm, legendre, ssa, asymmetry, q_ext, chi[wavelength, legendre] and
/// lm_a1 = (2 l + 1) chi_l, as sasktran2 and others name them; zero beyond what is known.
void write_scattering(const ScatteringTable& table, std::ostream& out) {
    std::size_t orders = 0;
    for (const auto& chi : table.chi) orders = std::max(orders, chi.size());
    std::vector<double> chi(table.wavelength_nm.size() * orders, 0.0), a1(chi), legendre(orders);
    for (std::size_t l = 0; l < orders; ++l) legendre[l] = static_cast<double>(l);
    for (std::size_t w = 0; w < table.chi.size(); ++w) {
        for (std::size_t l = 0; l < table.chi[w].size(); ++l) {
            chi[w * orders + l] = table.chi[w][l];
            a1[w * orders + l] = static_cast<double>(2 * l + 1) * table.chi[w][l];
        }
    }
    NpzArchive archive;
    archive.add("wavelength_nm", table.wavelength_nm);
    archive.add("legendre", legendre);
    archive.add("ssa", table.single_scattering_albedo);
    archive.add("asymmetry", table.asymmetry);
    archive.add("q_ext", table.q_ext);
    archive.add("chi", chi, {table.wavelength_nm.size(), orders});
    archive.add("lm_a1", a1, {table.wavelength_nm.size(), orders});
    archive.add_bytes("meta", table.metadata);
    archive.write(out);
}

constexpr char kNoDirections[] = "holds no directions";

Format spectrum_format(const char* name, const char* readers, const char* ending,
                       void (*write)(const ReflectanceSpectrum&, std::ostream&)) {
    return {.name = name,
            .readers = readers,
            .holds = "reflectance spectrum",
            .endings = {ending},
            .content = FormatContent::spectrum,
            .needs_ascending_wavelengths = true,
            .not_checked = kNoDirections,
            .write_spectrum = write};
}

}  // namespace

Format spd_format() {
    return spectrum_format("spd", "Mitsuba 0.6, pbrt and other renderers", ".spd", write_spd);
}

Format irregular_format() {
    return spectrum_format("irregular", "Mitsuba 3", ".xml", write_irregular);
}

Format scattering_format() {
    return {.name = "scattering",
            .readers = "radiative-transfer codes",
            .holds = "albedo and moments of single scattering",
            .endings = {".npz"},
            .content = FormatContent::scattering,
            .seeks = true,
            .not_checked = kNoDirections,
            .write_scattering = write_scattering};
}

}  // namespace miebrdf
