#include <miebrdf/plan.h>

#include <iostream>

void show_plan() {
    using namespace miebrdf;
    const Brdf brdf = solve({.base = medium("TiO2,radius=0.2")}, {450, 550});
    EarlierWork earlier;  // of one run: what the first plan does, the second need not
    const Plan plan = plan_evaluate(brdf, {{0.5}, {0.9}, {0}}, {}, &earlier);
    for (const PlannedStep& step : plan.steps)
        std::cout << step.stage << ": " << step.jobs << " jobs, " << step.seconds << " s\n";
    for (const Omission& omission : plan.omissions)
        std::cout << omission.rule << ": " << omission.reason << '\n';
    std::cout << plan.seconds() << " s, " << plan.memory_bytes / 1e6 << " MB; the albedo after it "
              << plan_albedo(brdf, {0.5}, &earlier).seconds() << " s\n";
    if (plan.leaves_out("polarisation")) std::cout << "light as a number\n";
}
