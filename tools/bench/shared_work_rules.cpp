// Rules of `plan` about work that several layers, results or wavelengths share.
#include "pipeline/solve/brdf.h"
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

std::vector<BenchCase> shared_work_rules() { return {same_spheres(), same_wavelength()}; }

}  // namespace miebrdf::bench
