#include "pipeline/formats/check/check.h"

#include <cmath>
#include <numbers>

#include "tests/support/catch.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;

namespace {

/// Any function of direction as a file.
class Fake : public BrdfFile {
  public:
    explicit Fake(double (*brdf)(const Direction&)) : brdf_(brdf) {}
    std::string format() const override { return "fake"; }
    std::string description() const override { return ""; }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return none_; }
    void evaluate(const Direction& d, std::span<double> values) const override {
        values[0] = brdf_(d);
    }

  private:
    double (*brdf_)(const Direction&);
    std::vector<std::string> channels_ = {"Y"};
    std::vector<double> none_;
};

}  // namespace

TEST_CASE("check finds the albedo of a white Lambertian surface to be 1", "[exports][file_check]") {
    const FileCheck check = check_file(Fake([](const Direction&) { return 1 / std::numbers::pi; }));
    // Gauss-Legendre integrates mu exactly.
    CHECK(std::abs(*check.largest_albedo - 1) <= 1e-12);
    CHECK(*check.reciprocity_rms == 0.0);
    CHECK(check.least_value == Approx(1 / std::numbers::pi));
    CHECK_FALSE(check.sampled_albedo_error.has_value());
}

TEST_CASE("the albedo error of a file that is a tenth too bright is a tenth",
          "[exports][file_check]") {
    static const support::TestMaterial material({550}, 0.4);
    const Fake bright([](const Direction& d) {
        double value = 0;
        material.evaluate({&d, 1}, {&value, 1});
        return 1.1 * value;
    });
    CHECK(albedo_error(bright, material) == Approx(0.1).epsilon(1e-9));
}

TEST_CASE("check sees what is not reciprocal, negative or missing", "[exports][file_check]") {
    CHECK(check_file(Fake([](const Direction& d) { return d.mu_in; })).reciprocity_rms.value() >
          0.3);
    CHECK(check_file(Fake([](const Direction& d) { return d.mu_in - 0.5; })).least_value < -0.4);
    const FileCheck check =
        check_file(Fake([](const Direction& d) { return d.mu_out > 0.5 ? 0.1 : std::nan(""); }));
    CHECK(check.missing > 0);
    CHECK(check.missing < check.directions);
}
