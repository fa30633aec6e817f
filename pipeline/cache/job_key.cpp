#include "pipeline/cache/job_key.h"

#include <miebrdf/processor_path.h>

#include "materials/index/checksum.h"
#include "pipeline/solver_version.h"

namespace miebrdf {

JobKey::JobKey(std::string_view kind) {
    add(kind);
    add(std::string_view(kSolverVersion));
    add(processor_path());  // results have the same bits only along the same one
}

JobKey& JobKey::add(std::string_view text) {
    // The length first: no two sequences of parts give the same bytes.
    bytes_ += std::to_string(text.size()) + ":";
    bytes_.append(text);
    return *this;
}

JobKey& JobKey::add(std::span<const double> numbers) {
    return add(
        std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
}

std::string JobKey::hash() const { return materials::sha256_hex(bytes_); }

}  // namespace miebrdf
