#include "pipeline/io/table.h"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

Table sample() {
    Table table;
    table.facts = {{"version", "0"}, {"source", "a"}, {"source", "b\nc"}, {"tolerance", 0.001}};
    table.columns = {"name", "value"};
    table.rows = {{"plain", 0.1}, {"with, comma \"quoted\"", 1e-300}, {Cell(), std::nan("")}};
    return table;
}

}  // namespace

TEST_CASE("CSV has comments, one header, quoted text and empty fields for what is unknown",
          "[pipeline][table]") {
    std::ostringstream out;
    write_csv(sample(), out);
    CHECK(out.str() ==
          "# version: 0\n# source: a\n# source: b c\n# tolerance: 0.001\nname,value\nplain,0.1\n"
          "\"with, comma \"\"quoted\"\"\",1e-300\n,\n");
}

TEST_CASE("a report stands above the table in CSV and beside it in JSON", "[pipeline][table]") {
    Table table = sample();
    table.report_columns = {"part", "error"};
    table.report = {{1.0, 0.5}, {2.0, Cell()}};
    std::ostringstream csv, text;
    write_csv(table, csv);
    CHECK(csv.str().find("b c\n# tolerance: 0.001\n# report: part,error\n# report: 1,0.5\n# "
                         "report: 2,\nname,value\n") != std::string::npos);
    write_json(table, text);
    const auto json = nlohmann::json::parse(text.str());
    CHECK(json["report"][0]["error"] == 0.5);
    CHECK(json["report"][1]["part"] == 2.0);
    CHECK(json["report"][1]["error"].is_null());
}

TEST_CASE("numbers in CSV read back to the same double", "[pipeline][table]") {
    const double value = GENERATE(1.0 / 3.0, 6.02214076e23, 5e-324, -0.1, 123456789.123456789);
    Table table;
    table.columns = {"x"};
    table.rows = {{value}};
    std::ostringstream out;
    write_csv(table, out);
    CHECK(std::strtod(out.str().c_str() + 2, nullptr) == value);
}

TEST_CASE("JSON is valid, keeps repeated facts and has null for what is unknown",
          "[pipeline][table]") {
    std::ostringstream out;
    write_json(sample(), out);
    const auto json = nlohmann::json::parse(out.str());
    CHECK(json["facts"]["source"] == nlohmann::json::array({"a", "b\nc"}));
    CHECK(json["facts"]["tolerance"] == 0.001);
    CHECK(json["columns"] == nlohmann::json::array({"name", "value"}));
    CHECK(json["rows"][0][1] == 0.1);
    CHECK(json["rows"][2][0].is_null());
    CHECK(json["rows"][2][1].is_null());
}
