// Rules of `plan` about work that several layers, results or wavelengths share.
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/shared_work.h"
#include "tools/bench/rule_case.h"

namespace miebrdf::bench {
namespace {

BenchCase same_spheres() {
    Request request = spheres_request("index:1.5,0.01");
    request.scene.coats = {parse_coat("index:1.5,0.01@0.1")};
    Request other = request;
    other.scene.coats = {{IndexMedium{{1.5 + 1e-12, 0.01}}, 0.1}};
    return rule_case(
        "same spheres", "Spheres on the same spheres; or nearly the same.",
        [other] { return total(other); }, [request] { return total(request); });
}

/// Three paints on one base, as results of one run or each on its own.
BenchCase one_half_space() {
    std::vector<Request> paints(3, matrix_request());
    paints[1].scene.coats = {parse_coat("hg:0.8,0.5@2")};
    paints[2].scene.coats = {parse_coat("hg:0.5,0.3@0.2")};
    const auto all = [paints](SharedWork* shared) {
        RunControl control{.threads = 1};
        control.shared = shared;
        Values values;
        for (const Request& paint : paints) {
            if (shared != nullptr) shared->expect(paint, LayerQuantity::reflection);
        }
        for (const Request& paint : paints) {
            const Values one = compute_brdf(paint, control).slices.at(0).total;
            values.insert(values.end(), one.begin(), one.end());
        }
        return values;
    };
    return rule_case(
        "one half-space", "The matrix of three paints on one base, apart and in one run.",
        [all] { return all(nullptr); },
        [all] {
            SharedWork shared;
            return all(&shared);
        });
}

BenchCase same_wavelength() {
    Request request = matrix_request();
    request.wavelength_nm = {450, 550, 650, 750};
    const auto full = [request] {
        for (const double nm : {450, 550, 650}) {
            Request one = request;
            one.wavelength_nm = {nm};
            total(one);
        }
        Request last = request;
        last.wavelength_nm = {750};
        return total(last);
    };
    return rule_case("same wavelength", "Media that do not change, at four wavelengths.", full,
                     [request] { return total(request); });
}

}  // namespace

std::vector<BenchCase> shared_work_rules() {
    return {same_spheres(), one_half_space(), same_wavelength()};
}

}  // namespace miebrdf::bench
