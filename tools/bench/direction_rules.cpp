// Rules of `plan` about the directions that are asked for.
#include <numbers>

#include "rte/math/quadrature.h"
#include "tools/bench/rule_case.h"

namespace miebrdf::bench {
namespace {

BenchCase albedo_alone() {
    const auto full = [request = matrix_request()] {
        const Values brdf = total(request);
        const math::Quadrature rule = math::gauss_legendre(32, 0.0, 1.0);
        Values plane;
        std::size_t index = 0;
        for (std::size_t i = 0; i < 32; ++i) {
            double flux = 0;
            for (std::size_t o = 0; o < 32; ++o) {
                double mean = 0;
                for (int a = 0; a < 36; ++a) mean += brdf[index++] / 36;
                flux += 2 * std::numbers::pi * rule.weights[o] * rule.nodes[o] * mean;
            }
            plane.push_back(flux);
        }
        return plane;
    };
    return rule_case("albedo", "Plane albedo at 32 incidences: by integrating the BRDF, and alone.",
                     full, [request = matrix_request()] { return albedo(request); });
}

BenchCase zenith_alone() {
    Request request = matrix_request();
    request.directions.mu_in = {1.0};
    const auto full = [] {
        const Values all = total(matrix_request());
        return Values(all.end() - 32 * 36, all.end());  // the last mu_in is 1
    };
    return rule_case("zenith", "BRDF for light from the zenith, of 32 incidences or alone.", full,
                     [request] { return total(request); });
}

BenchCase one_direction() {
    Request request = matrix_request();
    request.directions.mu_in = {0.5};
    request.directions.mu_out = {request.directions.mu_out[20]};
    request.directions.azimuth_deg = {90};
    const auto full = [] { return Values{total(matrix_request())[(15 * 32 + 20) * 36 + 9]}; };
    return rule_case("listed directions", "BRDF at one of 36,864 combinations, and alone.", full,
                     [request] { return total(request); });
}

BenchCase same_direction() {
    const Request request = matrix_request();
    return rule_case(
        "same direction", "36 azimuths around, of which 19 differ.",
        [request] { return unreduced(request); }, [request] { return total(request); });
}

}  // namespace

std::vector<BenchCase> direction_rules() {
    return {albedo_alone(), zenith_alone(), one_direction(), same_direction()};
}

}  // namespace miebrdf::bench
