#include <miebrdf/processor_path.h>
#include <miebrdf/transfer.h>

#include <iostream>

void show_transfer() {
    using namespace miebrdf;
    rte::Stack stack;
    stack.base = rte::rayleigh_optics(0.9);
    const rte::Directions directions{{0.5}, {0.3, 0.9}, {0, 180}};
    rte::SolverOptions options{.tolerance = 1e-3};
    options.grid = rte::GridKind::automatic;
    options.half_space_method = rte::HalfSpaceMethod::automatic;
    options.coat_method = rte::CoatMethod::automatic;
    rte::validate(options);  // @throws UsageError, as validate(directions)

    rte::SolutionMemory memory;  // for stacks that are solved one after the other
    const rte::ReflectionTable grey = rte::reflect(stack, directions, options, &memory);
    const rte::SolvedLight light(3);  // I, Q, U
    const rte::ReflectionTable polarised =
        rte::reflect_polarised(stack, directions, light, options);
    const rte::SolverReport& report = grey.report;
    std::cout << "R " << grey.reflection[0] << " by " << report.streams << " nodes, "
              << report.method << "; R11 with polarisation " << polarised.reflection[0] << '\n';
    const rte::AlbedoTable albedo = rte::albedo(stack, {0.5}, options);
    const rte::AlbedoTable of_q = rte::polarised_albedo(stack, {0.5}, options);
    std::cout << "albedo " << albedo.plane_albedo[0] << ", " << of_q.polarised_plane_albedo[0]
              << " more in polarised light; arithmetic for " << processor_path() << '\n';
    const MatrixExpansion& series = *stack.base.polarisation;
    std::cout << series.b1.size() << " coefficients of b1\n";
}
