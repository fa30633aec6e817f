#include <miebrdf/brdf.h>
#include <miebrdf/control.h>

#include <atomic>
#include <iostream>

void show_control() {
    using namespace miebrdf;
    std::atomic<bool> stop = false;  // set by a signal or a button
    Control control;
    control.threads = 1;
    control.progress = [](const std::string& stage, std::size_t done, std::size_t total) {
        std::cout << stage << ' ' << done << " of " << total << '\n';
    };
    control.is_cancelled = [&] { return stop.load(); };
    control.cache = open_cache();       // what earlier runs found
    control.memo = make_optics_memo();  // what scenes of this run have in common
    const auto albedo = solve({.base = medium("hg:0.9,0.8")}, {550}, {}, control).albedo({1.0});
    std::cout << albedo.at(0, 0) << '\n';
}
