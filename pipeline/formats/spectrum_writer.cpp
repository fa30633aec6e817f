#include "pipeline/formats/spectrum_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include <miebrdf/error.h>
#include "pipeline/formats/npz_writer.h"

namespace miebrdf::exports {
namespace {

void require_ascending(const Spectrum& spectrum) {
    for (std::size_t i = 1; i < spectrum.wavelength_nm.size(); ++i) {
        if (!(spectrum.wavelength_nm[i] > spectrum.wavelength_nm[i - 1])) {
            throw UsageError(
                fmt::format("a spectrum needs ascending wavelengths; {} nm follows {} nm",
                            spectrum.wavelength_nm[i], spectrum.wavelength_nm[i - 1]));
        }
    }
    if (spectrum.wavelength_nm.empty())
        throw UsageError("a spectrum needs at least one wavelength");
}

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

}  // namespace

void write_spd(const Spectrum& spectrum, std::ostream& out) {
    require_ascending(spectrum);
    for (const std::string& comment : spectrum.comments) out << "# " << one_line(comment) << '\n';
    for (std::size_t i = 0; i < spectrum.value.size(); ++i) {
        out << fmt::format("{} {}\n", spectrum.wavelength_nm[i], spectrum.value[i]);
    }
}

void write_mitsuba_irregular(const Spectrum& spectrum, std::ostream& out) {
    require_ascending(spectrum);
    for (const std::string& comment : spectrum.comments) {
        std::string text = one_line(comment);
        // Two hyphens end an XML comment.
        for (std::size_t at; (at = text.find("--")) != text.npos;) text.replace(at, 2, "- -");
        out << "<!-- " << text << " -->\n";
    }
    out << "<spectrum type=\"irregular\" name=\"reflectance\">\n"
        << fmt::format("    <string name=\"wavelengths\" value=\"{}\"/>\n",
                       fmt::join(spectrum.wavelength_nm, ", "))
        << fmt::format("    <string name=\"values\" value=\"{}\"/>\n",
                       fmt::join(spectrum.value, ", "))
        << "</spectrum>\n";
}

void write_scattering_npz(const ScatteringTable& table, const std::filesystem::path& path) {
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
    archive.write(path);
}

}  // namespace miebrdf::exports
