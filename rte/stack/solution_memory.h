// SolutionMemory: matrices, grids and rough boundaries that one solution leaves for the next.
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

    /// The matrices and grids of solutions with one number of nodes.
    struct AtStreams {
        int streams = 0;
        ScaledStack scaled = {};
        std::optional<StackGrids> grids = {};
        StackMemory memory = {};
        Eigen::VectorXd let_in = {}, let_out = {};

        /// The grids of `scaled`, made anew if those of the stack before do not fit.
        const StackGrids& grids_for(const Discretisation& discretisation) {
            if (!grids || !grids->fit(scaled, discretisation.grid, discretisation.streams))
                grids.emplace(scaled, discretisation.grid, discretisation.streams);
            return *grids;
        }
    };

    std::shared_ptr<RoughBoundaries> rough_boundaries = std::make_shared<RoughBoundaries>();
    std::shared_ptr<KeptLayers> kept_layers = {};
    std::vector<std::unique_ptr<AtStreams>> by_streams = {};
    RequestedDirections requested = {};
    std::vector<double> mu_in = {};  ///< of `requested`
    ScaledStack exact = {};          ///< the present stack without delta-M
    Solutions solutions_of_albedo = {};

    /// One memory for each number of nodes up to 64; one for all larger numbers, because that of
    /// 256 nodes takes 30 MB.
    AtStreams& with_streams(int streams);
};

}  // namespace miebrdf::rte
