// What each rule of `plan` saves: the same values from a request with all the work and from one
// without what the rule leaves out. The error here is their difference, not that of the method.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/brdf.h"
#include "tools/bench/rule_case.h"

namespace miebrdf::bench {
namespace {

/// A cache file that goes with the benchmark.
struct TemporaryCache {
    std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("miebrdf-bench-{}.sqlite", ::getpid());
    ResultCache cache{file};
    ~TemporaryCache() {
        std::error_code ignored;
        for (const char* suffix : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file.string() + suffix, ignored);
        }
    }
};

BenchCase in_the_cache() {
    const Request request = matrix_request();
    const auto cache = std::make_shared<TemporaryCache>();
    return rule_case(
        "in the cache", "The whole matrix, computed and remembered.",
        [request] { return total(request); },
        [request, cache] {
            RunControl control{.threads = 1};
            control.cache = &cache->cache;
            return compute_brdf(request, control).slices.at(0).total;
        });
}

}  // namespace

std::vector<BenchCase> rules_suite() {
    std::vector<BenchCase> cases = direction_rules();
    for (const auto& more : {layer_rules(), shared_work_rules(), part_rules()}) {
        cases.insert(cases.end(), more.begin(), more.end());
    }
    cases.push_back(in_the_cache());
    return cases;
}

}  // namespace miebrdf::bench
