// Files that unpack to much, are no files, or speak to terminals: each is read in a process of its
// own, whose memory and processor time are measured.
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <string>

#include <miebrdf/database.h>
#include <miebrdf/scene.h>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;

namespace {

struct Cost {
    double megabytes = 0.0;  ///< largest resident size beyond that of a process that does nothing
    double seconds = 0.0;    ///< of the processor
    bool ended = false;      ///< by itself, within a minute
};

rusage usage_of_child(const std::function<void()>& work, bool& ended) {
    const pid_t child = fork();
    if (child == 0) {
        alarm(60);
        try {
            work();
        } catch (const Error&) {
        }
        _exit(0);
    }
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    ended = WIFEXITED(status);
    return usage;
}

Cost cost_of(const std::function<void()>& work) {
    Cost cost;
    const rusage before = usage_of_child([] {}, cost.ended),
                 after = usage_of_child(work, cost.ended);
    cost.megabytes = double(after.ru_maxrss - before.ru_maxrss) / 1024.0;
    cost.seconds = double(after.ru_utime.tv_sec + after.ru_stime.tv_sec) +
                   1e-6 * double(after.ru_utime.tv_usec + after.ru_stime.tv_usec);
    return cost;
}

std::string repeated(const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text;
    return all;
}

std::string jcamp(const std::string& points, const std::string& data) {
    return "##TITLE=a\n##JCAMP-DX=4.24\n##XUNITS=NANOMETERS\n##YUNITS=REFLECTANCE\n##FIRSTX=400\n"
           "##LASTX=412\n##NPOINTS=" +
           points + "\n##XYDATA=(X++(Y..Y))\n" + data + "##END=\n";
}

std::string cxf_of_objects(int count) {
    std::string objects;
    for (int i = 0; i < count; ++i) {
        objects +=
            "<cc:Object Name=\"P\" Id=\"c\"><cc:ColorValues><cc:ReflectanceSpectrum "
            "ColorSpecification=\"s\" StartWL=\"400\">0.1 0.2 0.3</cc:ReflectanceSpectrum>"
            "</cc:ColorValues></cc:Object>\n";
    }
    return "<cc:CxF xmlns:cc=\"http://colorexchangeformat.com/CxF3-core\"><cc:Resources>"
           "<cc:ObjectCollection>" +
           objects +
           "</cc:ObjectCollection><cc:ColorSpecificationCollection><cc:ColorSpecification Id=\"s\">"
           "<cc:MeasurementSpec><cc:WavelengthRange StartWL=\"400\" Increment=\"10\"/>"
           "</cc:MeasurementSpec></cc:ColorSpecification></cc:ColorSpecificationCollection>"
           "</cc:Resources></cc:CxF>";
}

}  // namespace

TEST_CASE("small files never unpack to much", "[measured][hostile]") {
    const std::string text = GENERATE(
        jcamp("7", "400A0S999999999\n"), jcamp("7", "400A0S" + std::string(400, '9') + "\n"),
        jcamp("1e9", "400A0S999999999\n"), jcamp("4e6", "400A0%S999999999\n"));
    const Cost cost = cost_of([&] { read_text(text, {}, "a.jdx"); });
    CAPTURE(text.substr(0, 300), cost.megabytes, cost.seconds);
    CHECK(cost.ended);
    // The file has hundreds of bytes; 100 MB are far below a list of as many values as it claims.
    CHECK(cost.megabytes <= 100.0);
    CHECK(cost.seconds <= 2.0);
}

TEST_CASE("time and memory grow as the size of the file", "[measured][hostile]") {
    const auto text = GENERATE_COPY(values<std::string>(
        {cxf_of_objects(20000),
         "nm" + repeated(",a", 60000) + "\n400" + repeated(",0.5", 60000) + "\n",
         "nm,R\n400,0.5\n" + repeated("word,word\n", 200000), repeated("nm,R\n", 200000),
         repeated("wavelength\n", 200000),
         "IAD1\n" + repeated("1 ", 17) + "\n2\n" + repeated("500 0.3 0.35\n", 60000),
         repeated("##TITLE=a\n", 100000) + "##JCAMP-DX=4\n",
         "BEGIN_DATA_FORMAT\n" + repeated("nm400 ", 1000) + "\nEND_DATA_FORMAT\nBEGIN_DATA\n" +
             repeated(repeated("1 ", 1000) + "\n", 400) + "END_DATA\n",
         "name," + repeated("x,", 2000) + "400,410,420\n" +
             repeated("a," + repeated("1,", 2000) + "1,1,1\n", 100)}));
    const Cost cost = cost_of([&] { read_text(text); });
    CAPTURE(text.substr(0, 60), text.size(), cost.megabytes, cost.seconds);
    CHECK(cost.ended);
    // A cell of a table has 60 bytes in memory and two in the file.
    CHECK(cost.megabytes <= 50.0 + 120.0 * double(text.size()) / (1 << 20));
    // Anything quadratic takes minutes.
    CHECK(cost.seconds <= 5.0);
}

TEST_CASE("devices and pipes are refused at once, whoever reads them", "[measured][hostile]") {
    const support::TemporaryFolder folder;
    const std::string pipe = folder.write("x", "") + ".pipe";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    // The folder, and the pipe in it, are new for each case.
    const std::string path = GENERATE(true, false) ? pipe : "/dev/zero";
    const std::string word = GENERATE("", "scattering:", "moments:", "matrix:", "hg:", "paste:");
    CAPTURE(path, word);
    const Cost cost = cost_of([&] {
        if (word.empty()) read_measured(path);
        medium(word + path);
    });
    CHECK(cost.ended);
    CHECK(cost.megabytes <= 50.0);
    CHECK(cost.seconds <= 1.0);
    const Cost ground = cost_of([&] { substrate("lambert:" + path); });
    CHECK(ground.ended);
    CHECK(ground.megabytes <= 50.0);
    const Cost database = cost_of([&] { materials::Database::layered(path); });
    CHECK(database.ended);
    CHECK_THROWS_WITH(materials::Database::layered(path), Catch::Contains("no ordinary file"));
}

TEST_CASE("lambert: takes what is measured", "[measured][meaning]") {
    const support::TemporaryFolder folder;
    const std::string own = folder.write(
        "own.csv",
        "quantity,geometry,wavelength_nm,mu_in,mu_out,azimuth_deg,value,sigma\n"
        "reflectance,d8-sci,500,0.99,,,0.5,0.01\nreflectance,d8-sci,400,0.99,,,0.4,\n");
    const Substrate ground = substrate("lambert:" + own);
    CHECK(ground.wavelength_nm == std::vector<double>{400, 500});
    CHECK(ground.albedo == std::vector<double>{0.4, 0.5});
    const std::string two = folder.write("two.csv", "nm,left,right\n400,0.1,0.2\n");
    CHECK_THROWS_WITH(substrate("lambert:" + two), Catch::Contains("which column"));
}

TEST_CASE("a file of a library that claims infinite wavelengths is refused",
          "[measured][hostile]") {
    std::string bytes(484 + 4 * 10, '\0');
    bytes.replace(0, 3, "ASD");
    const auto put = [&](std::size_t place, auto number) {
        std::memcpy(bytes.data() + place, &number, sizeof number);
    };
    bytes[186] = 1;  // reflectance
    put(191, INFINITY);
    put(195, 1.0f);
    put(204, std::int16_t{10});
    CHECK_THROWS_WITH(read_text(bytes, {}, "a.asd"), Catch::Contains("damaged header"));
    put(191, 350.0f);
    put(195, INFINITY);
    CHECK_THROWS_WITH(read_text(bytes, {}, "a.asd"), Catch::Contains("damaged header"));
}

TEST_CASE("control characters of a file reach no terminal", "[measured][hostile]") {
    const Measurements list =
        read_text("# sample: \x1b]0;owned\x07\nname,400,410,420\nP\x1b[31m,0.1,?,0.3\n");
    std::string all = list.samples.at(0);
    for (const auto& [name, text] : list.facts) all += name + text;
    for (const std::string& doubt : list.doubts) all += doubt;
    for (const char c : all) CHECK(static_cast<unsigned char>(c) >= 0x20);
}
