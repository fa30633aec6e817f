// Export and its list of formats as a whole.
#include <atomic>
#include <limits>
#include <nlohmann/json.hpp>

#include <miebrdf/control.h>
#include "pipeline/formats/check/check.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using support::material;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> names_of_brdf_formats() {
    std::vector<std::string> names;
    for (const Format& format : all_formats()) {
        if (!format.files.empty()) names.push_back(format.name);
    }
    return names;
}

/// The material at as many wavelengths as a format holds.
const BrdfSource& material_for(const std::string& format) {
    static const support::TestMaterial five({450, 500, 550, 600, 650}, 0.4);
    return format == "pbsdf" ? five : material();
}

}  // namespace

TEST_CASE("every format is written, recognised by its content and close to the BRDF",
          "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    const std::string format = GENERATE(from_range(names_of_brdf_formats()));
    ExportOptions options;
    if (format == "rgl") options.resolution = 32;
    if (format == "pbsdf") options.resolution = 16;
    const auto files = export_brdf(material_for(format), format, folder / "file.any", options);
    CAPTURE(format);
    CHECK(files.size() == (format == "rgl" ? 2 : 1));
    for (const auto& file : files) {
        const auto read = open_brdf_file(file.path.string());
        CHECK(read->format() == (format == "klems" ? "radiance" : format));
        CHECK(file.bytes == std::filesystem::file_size(file.path));
    }
    CHECK(folder.count() == files.size() + (format == "merl" ? 1 : 0));
}

TEST_CASE("an rgl export that is stopped leaves neither of its two files",
          "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    const Format& rgl = find_format("rgl");
    const ExportOptions options{.resolution = 32};
    std::atomic<bool> cancelled = false;
    std::size_t calls = 0, last = 0;
    Control control{.threads = 1};
    control.is_cancelled = [&cancelled] { return cancelled.load(); };
    control.progress = [&](const std::string&, std::size_t, std::size_t) {
        if (++calls == last) cancelled = true;
    };
    export_brdf(material(), rgl, folder / "whole", options, control);
    CHECK(folder.count() == 2);
    // Shortly before the end the spectral file is long written.
    last = calls - 1;
    calls = 0;
    CHECK_THROWS_AS(export_brdf(material(), rgl, folder / "stopped", options, control), Cancelled);
    CHECK(folder.count() == 2);
}

TEST_CASE("every format says what its numbers are and where they come from",
          "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    const std::string format = GENERATE(from_range(names_of_brdf_formats()));
    const ExportOptions options{.resolution = format == "pbsdf" ? 8 : 0,
                                .directions = {{0.5, 1.0}, {0.3, 1.0}, {0.0, 180.0}},
                                .largest_error = 1e9};
    CAPTURE(format);
    for (const auto& file : export_brdf(material_for(format), format, folder / "file", options)) {
        const bool beside = find_format(format).sidecar != nullptr;
        const std::string content =
            support::read_file(beside ? fs::path(file.path.string() + ".json") : file.path);
        for (const char* said :
             {"generator", "miebrdf test", "command", "miebrdf export", "units", "1/sr", "cosine",
              "azimuth_zero", "sources", "a closed form", "component", "total"}) {
            CHECK_THAT(content, Catch::Contains(said));
        }
        const bool coloured = find_format(format).takes_colours && format != "rgl";
        if (coloured) CHECK_THAT(content, Catch::Contains("R = 600 nm"));
    }
}

TEST_CASE("merl says in a file beside it what it has no room for", "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    export_brdf(material(), "merl", folder / "paint.binary");
    const auto json = nlohmann::json::parse(support::read_file(folder / "paint.binary.json"));
    CHECK(json["units"] == "1/sr");
    CHECK(json["cosine"] == "not included");
    CHECK(json["wavelength_nm"].size() == 7);
    CHECK(json["sources"][0] == "a closed form");
    CHECK(json["command"] == "miebrdf export --base 'test \"material\"'");
}

TEST_CASE("a lobe too sharp for the resolution is refused with the error and what would do",
          "[formats][brdf_export]") {
    const support::SharpMaterial sharp(support::seven_wavelengths(), 0.12);
    const support::TemporaryFolder folder;
    CHECK_THROWS_AS(export_brdf(sharp, "rgl", folder / "sharp.bsdf", {.resolution = 8}), TooCoarse);
    CHECK_THROWS_WITH(export_brdf(sharp, "rgl", folder / "sharp.bsdf", {.resolution = 8}),
                      Catch::Contains("resolution 8 ") && Catch::Contains("; resolution ") &&
                          Catch::Contains("reaches"));
    CHECK(folder.count() == 0);
    // Too narrow to be met by random directions, and too narrow for any resolution.
    const support::SharpMaterial narrow(support::seven_wavelengths(), 0.02);
    CHECK_THROWS_WITH(export_brdf(narrow, "klems", folder / "narrow.xml"),
                      Catch::Contains("near mirror") && Catch::Contains("no finer one"));
    // Nobody asked for the standard: the first finer one that suffices is taken.
    const auto fine = export_brdf(sharp, "ssdd", folder / "fine.ssdd");
    CHECK(fine.front().resolution > find_format("ssdd").resolution.standard);
    CHECK(worst_region(*fine.front().deviation, find_format("ssdd").accepted) == nullptr);
    std::filesystem::remove(fine.front().path);
    const ExportOptions anything{.resolution = 8, .largest_error = 100};
    CHECK(export_brdf(sharp, "rgl", folder / "sharp.bsdf", anything).size() == 2);
}

TEST_CASE("a file of a black ground misses nothing", "[formats][brdf_export]") {
    Scene black;
    black.substrate = substrate("black");
    const BrdfTable table = solve(black, {450, 550, 650}).table();
    const support::TemporaryFolder folder;
    const auto files = export_brdf(table, "pbrt", folder / "black.bsdf", {.resolution = 8});
    for (const RegionDeviation& region : files[0].deviation->regions) {
        CHECK(region.rms == 0.0);
        CHECK(region.worst == 0.0);
    }
}

namespace {

/// Has a value that is no number where light comes in low.
class Broken : public support::TestMaterial {
  public:
    explicit Broken(double bad) : TestMaterial({450, 550, 650}, 0.4), bad_(bad) {}

  protected:
    double lobe(const Direction& direction) const override {
        return direction.mu_in < 0.4 ? bad_ : 0.0;
    }

  private:
    double bad_;
};

}  // namespace

TEST_CASE("values that are no numbers are refused with their direction, and no file appears",
          "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
    for (const Format& format : all_formats()) {
        if (format.files.empty()) continue;
        CAPTURE(format.name);
        const std::string path = folder / "broken";
        CHECK_THROWS_WITH(export_brdf(Broken(bad), format.name, path, {.accept_error = true}),
                          Catch::Contains("the BRDF is") && Catch::Contains("mu_in 0."));
        CHECK(fs::is_empty(folder / ""));
    }
}

TEST_CASE("a negative BRDF of one's own is refused with its direction, and no file appears",
          "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    for (const Format& format : all_formats()) {
        if (format.files.empty()) continue;
        CAPTURE(format.name);
        CHECK_THROWS_WITH(
            export_brdf(Broken(-100.0), format.name, folder / "broken", {.accept_error = true}),
            Catch::Contains("the BRDF is -") && Catch::Contains("mu_in 0.") &&
                Catch::Contains("0 and above"));
        CHECK(fs::is_empty(folder / ""));
    }
}

TEST_CASE("what is refused is written where its error is accepted", "[formats][brdf_export]") {
    const support::SharpMaterial sharp(support::seven_wavelengths(), 0.12);
    const support::TemporaryFolder folder;
    const ExportOptions options{.resolution = 8, .accept_error = true};
    const auto files = export_brdf(sharp, "rgl", folder / "sharp.bsdf", options);
    REQUIRE(files.size() == 2);
    CHECK(worst_region(*files[0].deviation, find_format("rgl").accepted) != nullptr);
}

TEST_CASE("values that are wrong at grazing directions alone are refused, too",
          "[formats][brdf_export]") {
    // Judged at mu > 0.2 and near the mirror direction there, files with lobes up to 237 times too
    // large at mu < 0.05 passed.
    class Wrong : public support::TestMaterial {
      public:
        Wrong() : TestMaterial({550}, 0.4) {}
        void evaluate(std::span<const Direction> directions,
                      std::span<double> values) const override {
            TestMaterial::evaluate(directions, values);
            for (std::size_t d = 0; d < directions.size(); ++d)
                if (std::min(directions[d].mu_in, directions[d].mu_out) < 0.05) values[d] *= 30.0;
        }
    };
    const auto file = read_brdf_file(support::written_file("pbrt", Wrong()), "wrong");
    const FileComparison found =
        compare_file(*file, support::TestMaterial({550}, 0.4), "wavelengths");
    CHECK(found.deviation.rms[0] <= 0.02);
    const RegionDeviation* worst = worst_region(found.deviation, find_format("pbrt").accepted);
    REQUIRE(worst != nullptr);
    CHECK(worst->kind == RegionKind::grazing);
    CHECK(worst->worst > 10.0);
    CHECK(std::min(worst->where.mu_in, worst->where.mu_out) <= 0.2);
}

TEST_CASE("a rough surface is exported reciprocal where nothing says its coupling",
          "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    Scene scene = support::under_surface(support::scene_of("hg:0.8,0.3"), 0.2, 1.5);
    const auto reciprocity_of = [&](const std::string& name) {
        const BrdfTable table = solve(scene, {450, 550, 650}).table();
        export_brdf(table, "json", folder / name, {});
        return *check_file(*open_brdf_file(folder / name)).reciprocity_rms;
    };
    CHECK(reciprocity_of("default.json") <= 1e-12);
    scene.coupling = rte::SurfaceCoupling::paper;
    CHECK(reciprocity_of("paper.json") >= 1e-3);  // equation (5) is not
}

TEST_CASE("regions are looked at where they say", "[formats][brdf_export]") {
    const support::TemporaryFolder folder;
    const auto files = export_brdf(material(), "pbrt", folder / "a.bsdf", {.resolution = 8});
    std::vector<std::string> names;
    for (const RegionDeviation& region : files[0].deviation->regions) {
        CAPTURE(region.name, region.rms);
        names.emplace_back(region.name);
        CHECK(region.rms > 0.0);
        const Direction& d = region.where;
        if (region.kind == RegionKind::grazing) CHECK(std::min(d.mu_in, d.mu_out) <= 0.2);
        if (names.back() == "retro-reflection") CHECK(std::abs(d.mu_in - d.mu_out) <= 0.1);
        if (names.back() == "zenith") CHECK(std::max(d.mu_in, d.mu_out) >= 0.995);
    }
    CHECK(names == std::vector<std::string>{"mu > 0.2", "mu 0.05-0.2", "mu < 0.05", "near mirror",
                                            "near mirror, mu < 0.2", "retro-reflection", "zenith"});
}

TEST_CASE("unknown formats and options are refused with what there is",
          "[formats][brdf_export][errors]") {
    CHECK_THROWS_WITH(export_brdf(material(), "vrml", "x"),
                      Catch::Contains("vrml") && Catch::Contains("pbrt"));
    CHECK_THROWS_WITH(find_format("mrel"), Catch::Contains("did you mean merl"));
    CHECK_THROWS_WITH(export_brdf(material(), "merl", "x", {.extra = {{"incident_angles", 4}}}),
                      Catch::Contains("merl") && Catch::Contains("incident_angles"));
    CHECK_THROWS_WITH(export_brdf(material(), "spd", "x"), Catch::Contains("a BRDF"));
    CHECK_THROWS_WITH(export_spectrum({{500}, {1}, {}}, "rgl", "x"), Catch::Contains("a spectrum"));
}

TEST_CASE("what the list says of a format holds together", "[formats]") {
    for (const Format& format : all_formats()) {
        CAPTURE(format.name);
        CHECK(&find_format(format.name) == &format);
        CHECK_FALSE(format.readers.empty());
        CHECK_FALSE(format.holds.empty());
        CHECK_FALSE(format.endings.empty());
        const bool holds_brdf =
            format.content == FormatContent::table || format.content == FormatContent::sampled;
        CHECK(holds_brdf == !format.files.empty());
        CHECK((format.content == FormatContent::spectrum) == (format.write_spectrum != nullptr));
        CHECK((format.content == FormatContent::scattering) ==
              (format.write_scattering != nullptr));
        // A file that its readers interpolate is read back; others may say why they are not.
        CHECK((format.reader.read != nullptr) == format.not_checked.empty());
        if (format.content == FormatContent::sampled) CHECK(format.reader.read != nullptr);
        const Fineness& fineness = format.resolution;
        CHECK((fineness.lowest <= fineness.standard && fineness.standard <= fineness.highest));
        CHECK((holds_brdf ? fineness.standard > 0 : fineness.highest == 0));
        for (const FormatOption& option : format.extra)
            CHECK((option.lowest <= option.standard && option.standard <= option.highest));
    }
}

namespace {

/// A format of someone else: 'TINY', then the BRDF of the first wavelength at normal incidence and
/// reflection as text.
class TinyFile : public BrdfFile {
  public:
    explicit TinyFile(const std::string& content) : value_(std::stod(content.substr(4))) {}
    std::string format() const override { return "tiny"; }
    std::string description() const override { return "one number"; }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    void look_up(const Direction&, std::span<double> values) const override { values[0] = value_; }

  private:
    double value_;
    std::vector<std::string> channels_ = {"550 nm"};
    std::vector<double> wavelength_nm_ = {550};
};

Format tiny_format() {
    return {.name = "tiny",
            .readers = "this test",
            .holds = "one number",
            .endings = {".tiny"},
            .content = FormatContent::sampled,
            .resolution = {"numbers", 1, 1, 1, 1},
            .extra = {{.name = "sign", .help = "of the number", .standard = 1, .lowest = -1}},
            .accepted = {.plain = 0.01},
            .files = {{.write =
                           [](const ExportJob& job, std::ostream& out) {
                               const Direction normal{1.0, 1.0, 0.0};
                               double value = 0.0;
                               job.spectral.evaluate({&normal, 1}, {&value, 1});
                               out << "TINY" << job.options.extra.at("sign") * value;
                           }}},
            .reader = {[](std::string_view content) {
                           return content.starts_with("TINY") ? Recognised::by_first_bytes
                                                              : Recognised::no;
                       },
                       [](std::string content) -> std::unique_ptr<BrdfFile> {
                           return std::make_unique<TinyFile>(content);
                       }}};
}

}  // namespace

TEST_CASE("a format from outside is exported, read back, refused and checked as any other",
          "[formats]") {
    class White : public support::TestMaterial {
      public:
        White() : TestMaterial({550}, 0.0) {}
        void evaluate(std::span<const Direction>, std::span<double> values) const override {
            std::fill(values.begin(), values.end(), 0.25);
        }
    };
    std::vector<Format> formats(all_formats().begin(), all_formats().end());
    formats.push_back(tiny_format());
    const Format& tiny = find_format("tiny", formats);
    CHECK(options_of(tiny) == std::vector<std::string>{"sign", "largest_error", "accept_error"});
    const support::TemporaryFolder folder;
    const auto files = export_brdf(White(), tiny, folder / "white.tiny", {}, {});
    REQUIRE(files.size() == 1);
    CHECK(files[0].deviation->rms[0] <= 1e-6);
    const auto read = open_brdf_file(folder / "white.tiny", formats);
    CHECK(read->format() == "tiny");
    CHECK(*check_file(*read).largest_albedo == Approx(0.25 * M_PI));
    CHECK(compare_file(*read, White()).albedo_error <= 1e-6);
    CHECK_THROWS_AS(open_brdf_file(folder / "white.tiny"), InputError);
    // Its own options and its own bound.
    const ExportOptions negative{.extra = {{"sign", -1}}};
    CHECK_THROWS_AS(export_brdf(White(), tiny, folder / "b.tiny", negative, {}), TooCoarse);
    CHECK_THROWS_WITH(export_brdf(White(), tiny, folder / "b", {.extra = {{"sign", 2}}}, {}),
                      Catch::Contains("-1 to 1"));
    CHECK_THROWS_AS(export_brdf(material(), tiny, folder / "b.tiny", {}, {}), UsageError);
    CHECK(folder.count() == 1);
    CHECK_THROWS_WITH(find_format("tinny", formats), Catch::Contains("did you mean tiny?"));
}

TEST_CASE("files say that the mirror reflection of a smooth boundary is not in them",
          "[formats][brdf_export]") {
    Scene scene{.base = medium("hg:0.9,0.4 in index:1.5")};
    scene.boundary = rte::Boundary{};
    const BrdfTable table = solve(scene, {480, 535, 620}).table();
    CHECK(table.provenance().mirror_index == 1.5);
    for (const char* format : {"json", "csv", "pbrt", "radiance"}) {
        CAPTURE(format);
        // Fresnel's ((n - 1) / (n + 1))^2 is .04.
        CHECK_THAT(support::written_file(format, table, {.resolution = 4}),
                   Catch::Contains("left_out") && Catch::Contains("index 1.5, 4 %"));
    }
}

TEST_CASE("a film's lower side is told as a mirror, a rough boundary's lobe is in the values",
          "[formats][brdf_export]") {
    Scene scene{.layers = {layer("hg:0.9,0.4 in index:1.5 @ 0.3")}};
    scene.substrate = substrate("none");
    scene.boundary = rte::Boundary{};
    CHECK_THAT(solve(scene, {535}).table().provenance().left_out,
               Catch::Contains("smooth surfaces below"));
    scene.boundary = rte::Boundary{.roughness = 0.3};
    CHECK(solve(scene, {535}).table().provenance().left_out.empty());
}
