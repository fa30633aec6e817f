// What a request will cost, what of it is left out, and why: the rules of rules.h, visible_layers.h
// and distinct_directions.h, put to the request before anything is computed.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "pipeline/cache/result_cache.h"
#include "pipeline/scene/request.h"
#include "pipeline/solve/layers.h"

namespace miebrdf {

struct PlannedStep {
    std::string stage;
    std::string what;
    std::size_t jobs = 0;
    double seconds = 0.0;  ///< estimate for one thread (cost_model.h)
};

struct Omission {
    std::string rule;      ///< its name, the same for every request
    std::string reason;    ///< why it holds here
    double saved_s = 0.0;  ///< estimate for one thread
};

/// "1 coat", "3 coats": how plans count.
std::string counted(std::size_t count, const std::string& thing);

struct Plan {
    std::vector<PlannedStep> steps;
    std::vector<Omission> omissions;

    double seconds() const;
    bool leaves_out(const std::string& rule) const;
};

/// What the results of one run have done before the next one is planned (shared_work.h).
struct EarlierWork {
    std::set<std::string> optics;  ///< optics_hash of Mie jobs
};

/// @param quantity  reflection: what compute_brdf does; albedo: what compute_albedo does
/// @param cache  where finished jobs are looked up; may be null
/// @param earlier  of the same run; this request's own work is added. Null: it is the only one
/// @throws UsageError, InputError  as the computation would
Plan make_plan(const Request& request, LayerQuantity quantity, ResultCache* cache = nullptr,
               EarlierWork* earlier = nullptr);

}  // namespace miebrdf
