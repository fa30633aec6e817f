// miebrdf measured, and measurements as references and points.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

const std::string kGreyChart =
    "CGATS.17\nMEASUREMENT_GEOMETRY \"Sphere d/8 SPIN\"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME SPEC_400 "
    "SPEC_450 SPEC_500 SPEC_550 SPEC_600 SPEC_620 SPEC_650 SPEC_700\nEND_DATA_FORMAT\nBEGIN_DATA\n"
    "grey 20 20 20 20 20 20 20 20\nEND_DATA\n";

}  // namespace

TEST_CASE("measured prints what it understood, and reads its own rows again",
          "[program][measured]") {
    const support::TemporaryFolder folder;
    const std::string chart = folder.write("chart.txt", kGreyChart);
    const std::string own = folder / "own.csv", picture = folder / "picture.svg";
    const auto run =
        support::run_ok("measured " + chart + " --sigma 0.01 --plot " + picture + " -o " + own);
    CHECK_THAT(support::read_file(picture), Catch::Contains("<svg") && Catch::Contains("grey"));
    const std::string text = support::read_file(own);
    CHECK_THAT(text, Catch::Contains("# format: cgats"));
    CHECK_THAT(text, Catch::Contains("# reflectance, d8-sci: 8 values, 400 to 700 nm"));
    CHECK_THAT(text, Catch::Contains("quantity,geometry,wavelength_nm,mu_in,mu_out,azimuth_deg,"
                                     "value,sigma\nreflectance,d8-sci,400,0.99026806874157"));
    const auto again = support::run_ok("measured " + own);
    const auto rows = [](const std::string& table) {
        return table.substr(table.find("quantity,"));
    };
    CHECK(rows(again.out) == rows(text));
}

TEST_CASE("a ground is any instrument's spectrum, from its own file and from what measured writes",
          "[program][measured]") {
    const std::string svc =
        "/*** Spectra Vista SIG Data ***/\nname= leaf\nunits= Radiance, Radiance\ncomm= \n"
        "memory slot= 0, 0\ndata= \n400.0  200.0  50.0  25.00\n600 200 60 30\n";
    const std::string jcamp =
        "##TITLE=a powder\n##JCAMP-DX= 4.24\n##XUNITS= NANOMETERS\n##YUNITS= REFLECTANCE\n"
        "##XFACTOR= 1\n##YFACTOR= 0.01\n##FIRSTX= 400\n##LASTX= 600\n##NPOINTS= 3\n"
        "##XYDATA= (X++(Y..Y))\n400 10 12 14\n##END=\n";
    const std::string cxf =
        "<CxF xmlns=\"http://colorexchangeformat.com/CxF3-core\"><Resources><ObjectCollection>"
        "<Object ObjectType=\"Standard\" Name=\"P1\" Id=\"c1\"><ColorValues>"
        "<ReflectanceSpectrum ColorSpecification=\"s\" StartWL=\"400\">0.1 0.2 0.3"
        "</ReflectanceSpectrum><ColorCIELab ColorSpecification=\"s\"><L>50</L><A>1</A><B>2</B>"
        "</ColorCIELab></ColorValues></Object></ObjectCollection><ColorSpecificationCollection>"
        "<ColorSpecification Id=\"s\"><MeasurementSpec><MeasurementType>Spectrum_Reflectance"
        "</MeasurementType><WavelengthRange StartWL=\"400\" Increment=\"100\"/>"
        "</MeasurementSpec></ColorSpecification></ColorSpecificationCollection></Resources></CxF>";
    const std::string avantes =
        "0601030U1\nIntegration time [ms]:  15,000\nWave   ;Sample   ;Dark     "
        ";Reference;Reflectance"
        "\n[nm]   ;[counts] ;[counts] ;[counts] ;[%]\n\n"
        " 400,00;  812,000;  700,0;  900,0;50,0\n 600,00;  813,000;  700,0;  900,0;60,0\n";
    const std::string ecostress =
        "Name: a pavement\r\nType: manmade\r\nMeasurement: Directional (10 Degree) Hemispherical "
        "Reflectance\r\nX Units: Wavelength (micrometers)\r\nY Units: Reflectance (percent)\r\n"
        "Number of X Values: 2\r\nAdditional Information: none\r\n\r\n 0.6\t 25\r\n 0.4\t 50\r\n";
    const std::string rxt =
        "IAD1\n1.41\n1.5\n2.65\n1\n10\n0.98\n0\n100 20 18 8 0.98\n100 18 0 8 0.98\n"
        "L r t\n600 0.3 0.35\n400 0.2 0.25\n";
    struct Case {
        std::string name, text;
        double at_500;
    };
    const support::TemporaryFolder folder;
    for (const Case& c : std::vector<Case>{
             {"leaf.sig", svc, 0.275},
             {"powder.jdx", jcamp, 0.12},
             {"patch.cxf", cxf, 0.2},
             {"avantes.txt", avantes, 0.55},
             {"pavement.spectrum.txt", ecostress, 0.375},
             {"phantom.rxt", rxt, 0.25},
             {"chart.txt", kGreyChart, 0.2},
             {"percent.csv", "wavelength_nm,%R,sample\n400,10,\"1,5\"\n600,20,\"1,5\"\n", 0.15},
         }) {
        CAPTURE(c.name);
        const std::string file = folder.write(c.name, c.text), own = folder / "own.csv";
        support::run_ok("measured " + file + " -o " + own);
        for (const std::string& ground : {file, own}) {
            const auto run = support::run_ok(
                "albedo --coat isotropic:0@1e-12 --mu-in 1 "
                "--wavelengths 500 --substrate lambert:" +
                ground);
            // The layer takes 1e-12 on each way.
            CHECK(std::abs(support::CsvOutput(run.out).number(0, "plane_albedo") - c.at_500) <=
                  1e-11);
        }
    }
}

TEST_CASE("a goniometer's list is drawn against the angle of reflection", "[program][measured]") {
    const support::TemporaryFolder folder;
    const std::string list =
        folder.write("list.csv",
                     "theta_i,phi_i,theta_r,phi_r,nm,brdf\n45,0,45,180,500,0.5\n45,0,45,0,500,0.2\n"
                     "45,0,30,90,500,0.3\n");
    const std::string picture = folder / "list.svg";
    const auto run = support::run_program("measured " + list + " --plot " + picture);
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(support::read_file(picture), Catch::Contains("angle of reflection"));
}

TEST_CASE("a measured chart is a reference for colours, and points beside a spectrum",
          "[program][measured]") {
    const support::TemporaryFolder folder;
    const std::string chart = folder.write("chart.txt", kGreyChart);
    const auto colour = support::run_ok(
        "albedo --substrate lambert:0.2 --coat isotropic:0@1e-9 --mu-in 1 --wavelengths "
        "400:700:20 --colour d65 --reference " +
        chart);
    CHECK(support::CsvOutput(colour.out).number(0, "de76") <= 1e-4);
    const auto plot = support::run_program(
        "plot spectrum --base hg:0.9,0.5 --wavelengths 400:600:100 --points " + chart);
    CAPTURE(plot.err);
    CHECK(plot.exit_code == 0);
    CHECK_THAT(plot.out, Catch::Contains("grey"));
}

TEST_CASE("measurements that cannot be used are refused with what would help",
          "[program][measured][errors]") {
    const support::TemporaryFolder folder;
    const std::string percent = folder.write("percent.csv", "nm,R\n400,80\n500,81\n");
    const std::string chart = folder.write("chart.txt", kGreyChart);
    struct Case {
        std::string arguments, complaint;
        int exit_code;
    };
    for (const Case& wrong : std::vector<Case>{
             {"measured " + percent, "percent", 3},
             {"measured nosuch.csv", "nosuch.csv", 3},
             {"measured " + chart + " --column blue", "grey", 2},
             {"measured " + chart + " --quantity gloss", "d8-sci", 2},
             {"measured " + chart + " --plot x.pdf", ".svg", 2},
             {"measured " + chart + " --percent --shares", "--shares", 2},
             {"measured " + chart + " --mu-in 0.5,1", "2 numbers", 2},
             {"plot spectrum --base hg:0.9,0.5 --wavelengths 900:950:10 --points " + chart,
              "no reflectance from 900", 3}}) {
        const auto run = support::run_program(wrong.arguments);
        CAPTURE(wrong.arguments, run.err);
        CHECK(run.exit_code == wrong.exit_code);
        CHECK(run.out.empty());
        CHECK_THAT(run.err, Catch::Contains(wrong.complaint));
    }
    CHECK(support::run_program("measured " + percent + " --percent").exit_code == 0);
}

TEST_CASE("measured directions become a file for renderers, with their residual said",
          "[program][measured]") {
    const support::TemporaryFolder folder;
    std::string text = "theta_i,theta_r,azimuth_deg,nm,brdf\n";
    for (const int in : {0, 30, 60}) {
        for (const int out : {0, 20, 40, 60, 75}) {
            for (const int azimuth : {0, 60, 120, 180})
                text += std::to_string(in) + "," + std::to_string(out) + "," +
                        std::to_string(azimuth) + ",550,0.2\n";
        }
    }
    const std::string list = folder.write("list.csv", text), out = folder / "made.csv";
    const auto run = support::run_ok("export --format csv --from " + list + " -o " + out);
    CHECK_THAT(run.err, Catch::Contains("interpolated from 60 measured values"));
    // A Lambertian BRDF of 0.2 has the albedo 0.2 pi at measured incidences and below them.
    CHECK_THAT(run.err, Catch::Contains("albedo 0.628 from mu_in 0.5 up, as measured; 0.628 with"));
    CHECK_THAT(support::read_file(out), Catch::Contains(list));
    const support::CsvOutput table(support::read_file(out));
    REQUIRE(table.size() > 100);
    // A Lambertian surface stays one, beyond the measured directions too.
    for (std::size_t row = 0; row < table.size(); row += 37)
        CHECK(table.number(row, "brdf") == Approx(0.2).epsilon(1e-4));
    const auto check = support::run_program("check " + out);
    CHECK(check.exit_code == 0);

    const std::string from = "export --from " + list + " -o " + out + " --format ";
    for (const auto& [words, complaint] : {std::pair<std::string, std::string>{"spd", "no BRDF"},
                                           {"csv --base TiO2", "--base"},
                                           {"csv --column x", "column"}}) {
        const auto wrong = support::run_program(from + words);
        CAPTURE(words, wrong.err);
        CHECK(wrong.exit_code == 2);
        CHECK_THAT(wrong.err, Catch::Contains(complaint));
    }
}
