// Memory of solutions: what one stack leaves for the next.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include <miebrdf/transfer.h>
#include "rte/boundary/rough_boundaries.h"
#include "rte/grid/discretisation.h"
#include "rte/stack/scaled_stack.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

struct SolutionParts {
    static SolutionParts& of(SolutionMemory& memory) { return *memory.parts_; }

    /// The matrices and grids of one number of nodes.
    struct AtStreams {
        int streams = 0;
        ScaledStack scaled = {};
        std::optional<StackGrids> grids = {};
        StackMemory memory = {};
        Eigen::VectorXd let_in = {}, let_out = {};

        /// The nodes of `scaled`.
        const StackGrids& grids_for(const Discretisation& discretisation) {
            if (!grids || !grids->fit(scaled, discretisation.grid, discretisation.streams))
                grids.emplace(scaled, discretisation.grid, discretisation.streams);
            return *grids;
        }
    };

    std::shared_ptr<RoughBoundaries> rough_boundaries = std::make_shared<RoughBoundaries>();
    std::vector<std::unique_ptr<AtStreams>> by_streams = {};
    RequestedDirections requested = {};
    std::vector<double> mu_in = {};  ///< of `requested`
    ScaledStack exact = {};
    Solutions solutions_of_albedo = {};

    /// Beyond 64 nodes one takes the place of the other: 256 of them are 30 MB.
    AtStreams& with_streams(int streams);
};

}  // namespace miebrdf::rte
