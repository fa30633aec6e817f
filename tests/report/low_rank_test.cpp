// Tables as few columns, and numbers as text.
#include <cmath>
#include <limits>

#include "pipeline/report/low_rank.h"
#include "pipeline/report/packed.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Rows that differ by a factor of a million, columns that are sums of three functions.
Eigen::MatrixXd three_functions(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd table(rows, columns);
    for (Eigen::Index r = 0; r < rows; ++r) {
        const double x = double(r) / double(rows), size = std::pow(10.0, 6.0 * x);
        for (Eigen::Index c = 0; c < columns; ++c) {
            const double y = double(c) / double(columns);
            table(r, c) =
                size * (1.0 + 0.5 * y * std::sin(9.0 * x) + 0.01 * y * y * std::cos(40.0 * x));
        }
    }
    return table;
}

}  // namespace

TEST_CASE("a table of three functions has rank three, each row to its own size", "[report]") {
    const Eigen::MatrixXd table = three_functions(200, 31);
    const Eigen::VectorXd scale = table.cwiseAbs().rowwise().maxCoeff();
    const report::LowRank reduced =
        report::reduce_rank(table, scale, Eigen::VectorXd::Ones(31), 1e-6);
    REQUIRE(reduced.basis.cols() == 3);
    const Eigen::MatrixXd again = scale.asDiagonal() * reduced.basis * reduced.coefficients;
    const Eigen::MatrixXd error = scale.cwiseInverse().asDiagonal() * (again - table);
    // Half a step of the rounded basis for each column, and the tolerance.
    CHECK(error.cwiseAbs().maxCoeff() <= 3 * 4e-5 + 1e-6);
    Eigen::VectorXi rows(2);
    rows << 3, 150;
    const Eigen::VectorXd sum = reduced.sum_of_rows(rows, Eigen::Vector2d(0.25, 2.0));
    const Eigen::VectorXd expected = 0.25 * again.row(3) + 2.0 * again.row(150);
    CHECK((sum - expected).cwiseAbs().maxCoeff() <= 1e-9 * expected.cwiseAbs().maxCoeff());
}

TEST_CASE("a table of zeros has no columns and stays zero", "[report]") {
    const Eigen::MatrixXd table = Eigen::MatrixXd::Zero(4, 3);
    const report::LowRank reduced =
        report::reduce_rank(table, Eigen::VectorXd::Zero(4), Eigen::VectorXd::Ones(3), 1e-6);
    CHECK(reduced.basis.cols() == 0);
    CHECK(reduced.sum_of_rows(Eigen::VectorXi::Zero(1), Eigen::VectorXd::Ones(1)).isZero());
}

TEST_CASE("base64 is that of RFC 4648, section 10", "[report]") {
    const auto of = [](const std::string& text) {
        const std::vector<unsigned char> bytes(text.begin(), text.end());
        return report::base64(bytes);
    };
    CHECK(of("") == "");
    CHECK(of("f") == "Zg==");
    CHECK(of("fo") == "Zm8=");
    CHECK(of("foo") == "Zm9v");
    CHECK(of("foobar") == "Zm9vYmFy");
}
