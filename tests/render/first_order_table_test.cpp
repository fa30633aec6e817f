#include "pipeline/render/first_order_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "rte/first_order/narrow_features.h"
#include "rte/stack/stack_solver.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using render::FirstOrderTable;
using Stacks = std::vector<std::vector<rte::ScaledMedium>>;

namespace {

struct Direction {
    double mu_in, mu_out, cos_azimuth;
};

std::vector<Direction> some_directions() {
    std::mt19937_64 engine(7);
    const auto uniform = [&] { return (double(engine() >> 12) + 0.5) * 0x1p-52; };
    std::vector<Direction> list = {{1, 1, 1}, {0.5, 0.5, -1}, {0.5, 0.5, 1}, {0.01, 1, 0}};
    for (int i = 0; i < 300; ++i)
        list.push_back({0.01 + 0.99 * uniform(), 0.01 + 0.99 * uniform(), 2 * uniform() - 1});
    return list;
}

double value(const FirstOrderTable& table, const Direction& d, std::size_t w) {
    const auto place = table.place(d.mu_in, d.mu_out, d.cos_azimuth);
    return double(
        table.reflection(place, w / render::kLaneWidth)[Eigen::Index(w % render::kLaneWidth)]);
}

std::vector<rte::ScaledMedium> media_of(const rte::Stack& stack) {
    return rte::scale_stack(stack, 24, true).media;
}

}  // namespace

TEST_CASE("the table holds the closed form of one scattering, for more wavelengths than a lane",
          "[render][first_order]") {
    // Chandrasekhar 1960, section 47: alpha P / (4 (mu + mu_0)) (1 - exp(-tau q)), each layer
    // weakened by those above. At every third wavelength there is no coat.
    Stacks stacks;
    const auto albedo = [](int w) { return 0.04 * w; };
    const auto depth = [](int w) { return w % 3 == 0 ? 0.0 : 0.1 * w; };
    for (int w = 0; w < 20; ++w) {
        rte::Stack stack{.base = rte::rayleigh_optics(albedo(w))};
        if (depth(w) > 0.0) stack.coats = {{rte::isotropic_optics(0.7), depth(w)}};
        stacks.push_back(media_of(stack));
    }
    const FirstOrderTable table(stacks, GENERATE(true, false));
    for (const Direction& d : some_directions()) {
        const double q = 1 / d.mu_in + 1 / d.mu_out;
        const double c = rte::cos_scattering_angle(d.mu_in, d.mu_out, d.cos_azimuth);
        for (int w = 0; w < 20; ++w) {
            const double left = std::exp(-depth(w) * q);
            const double expected = (0.7 * (1 - left) + albedo(w) * 0.75 * (1 + c * c) * left) /
                                    (4 * (d.mu_in + d.mu_out));
            CAPTURE(d.mu_in, d.mu_out, d.cos_azimuth, w);
            // Single precision: of exp(-tau q), whose argument has an error of tau q 2^-24.
            const double rounding = 4e-7 * (1 + depth(w) * q * left) / (4 * (d.mu_in + d.mu_out));
            CHECK(std::abs(value(table, d, std::size_t(w)) - expected) <= rounding);
        }
    }
}

TEST_CASE("glories below a coat are as narrow in the table as where they are summed",
          "[render][first_order]") {
    // Diffraction and alternating moments around degree 110: what delta-M leaves to the first
    // order.
    rte::Optics glory = rte::isotropic_optics(0.9);
    glory.chi.resize(300);
    for (int l = 1; l < 300; ++l) {
        glory.chi[std::size_t(l)] =
            0.5 * std::pow(0.3, l) + 0.5 * std::exp(-std::pow(l / 90.0, 2)) +
            (l > 20 ? 0.004 * (l % 2 ? -1 : 1) * std::exp(-std::pow((l - 110) / 25.0, 2)) : 0.0);
    }
    const rte::Optics coat = rte::henyey_greenstein_optics(0.6, 0.5);
    const bool coated = GENERATE(true, false);
    rte::Stack stack{.base = glory};
    if (coated) stack.coats = {{coat, 0.1}};
    const Stacks stacks = {media_of(stack)};
    const FirstOrderTable table(stacks, true);
    const rte::NarrowFeatures features({stacks}, 0.005, 1e-9);
    REQUIRE_FALSE(features.none());
    double largest_error = 0.0, largest_narrow = 0.0;
    for (const Direction& d : some_directions()) {
        double narrow = 0.0;
        features.add_to(&narrow, {&d.mu_in, 1}, {&d.mu_out, 1}, {&d.cos_azimuth, 1});
        const double once =
            rte::single_scattering(stacks[0], true, d.mu_in, d.mu_out, d.cos_azimuth);
        const double shape = 1 / (4 * (d.mu_in + d.mu_out));
        largest_narrow = std::max(largest_narrow, std::abs(narrow) / shape);
        largest_error =
            std::max(largest_error, std::abs(value(table, d, 0) - once - narrow) / shape);
    }
    CAPTURE(coated, largest_error, largest_narrow);
    CHECK(largest_narrow >= 0.1);
    // Four points that are h = 0.3 apart in log q: 3 h^4 / 128 = 1.9e-4 of the fourth derivative,
    // which exp(-tau q) keeps below 1. In Theta the nodes lie closer where there is much.
    CHECK(largest_error <= (coated ? 2e-4 : 2e-5) * largest_narrow);
}
