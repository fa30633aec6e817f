#include "rte/half_space/solved_half_spaces.h"

namespace miebrdf::rte {
namespace {

std::int64_t bytes_of(const std::vector<double>& key, const Reflector& reflector) {
    const auto numbers = reflector.nodes.size() + reflector.rows.size() + reflector.multiple.size();
    return std::int64_t(sizeof(double)) * (std::int64_t(key.size()) + numbers);
}

void append(std::vector<double>& key, const Eigen::VectorXd& numbers) {
    // The length first: no two sequences of vectors give the same key.
    key.push_back(double(numbers.size()));
    key.insert(key.end(), numbers.data(), numbers.data() + numbers.size());
}

void append(std::vector<double>& key, const std::vector<int>& numbers) {
    key.push_back(double(numbers.size()));
    key.insert(key.end(), numbers.begin(), numbers.end());
}

}  // namespace

bool MemoryBudget::take(std::int64_t bytes) {
    if ((left_ -= bytes) >= 0) return true;
    left_ += bytes;
    return false;
}

SolvedHalfSpaces::~SolvedHalfSpaces() { budget_->give_back(taken_bytes_); }

SolvedHalfSpaces::Key SolvedHalfSpaces::key_of(const HalfSpaceProblem& problem) {
    // What differs most often comes first. The tables of the mode follow from its order, the number
    // of degrees, the grid and the requested cosines.
    Key key{double(problem.mode.order), problem.medium.one_minus_albedo, problem.tolerance,
            double(problem.method)};
    append(key, problem.medium.strengths);
    append(key, problem.grid.mu);
    append(key, problem.grid.weights);
    append(key, problem.requested.mu);
    append(key, problem.requested.out);
    append(key, problem.requested.in);
    return key;
}

void SolvedHalfSpaces::solve(const HalfSpaceProblem& problem, OrderWork& work, Reflector& result) {
    Key key = key_of(problem);
    {
        const std::lock_guard lock(mutex_);
        if (const auto known = known_.find(key); known != known_.end()) {
            ++found_;
            result = known->second;
            return;
        }
    }
    solve_half_space(problem.method, problem.medium, problem.mode, problem.grid, problem.requested,
                     problem.tolerance, work, result);
    const std::lock_guard lock(mutex_);
    const std::int64_t bytes = bytes_of(key, result);
    if (!known_.contains(key) && budget_->take(bytes)) {
        taken_bytes_ += bytes;
        known_.emplace(std::move(key), result);
    }
}

std::size_t SolvedHalfSpaces::kept() const {
    const std::lock_guard lock(mutex_);
    return known_.size();
}

}  // namespace miebrdf::rte
