#include "pipeline/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/plan/planner.h"

namespace miebrdf {

std::string counted(std::size_t count, const std::string& thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

double Plan::seconds() const {
    double sum = 0.0;
    for (const PlannedStep& step : steps) sum += step.seconds;
    return sum;
}

bool Plan::leaves_out(const std::string& rule) const {
    return std::any_of(omissions.begin(), omissions.end(),
                       [&](const Omission& omission) { return omission.rule == rule; });
}

Plan make_plan(const Request& request, LayerQuantity quantity, ResultCache* cache,
               EarlierWork* earlier) {
    validate(request);
    EarlierWork none;
    return Planner(request, quantity, cache, earlier != nullptr ? *earlier : none).plan();
}

}  // namespace miebrdf
