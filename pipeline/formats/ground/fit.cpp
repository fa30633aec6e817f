// Models of natural grounds in place of a BRDF.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include "pipeline/formats/check/check.h"
#include "pipeline/formats/common/least_squares.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf {
namespace {

using Kind = rte::GroundBrdf::Kind;

/// The grounds of all channels as a file to compare with.
class GroundsAsFile : public BrdfFile {
  public:
    GroundsAsFile(const std::vector<rte::GroundBrdf>& grounds, const BrdfSource& source)
        : grounds_(grounds), source_(source) {}

    std::string format() const override { return grounds_.front().model().name; }
    std::string description() const override { return "a natural ground"; }
    const std::vector<std::string>& channels() const override { return source_.channels(); }
    const std::vector<double>& wavelength_nm() const override { return source_.wavelength_nm(); }

  protected:
    void look_up(const Direction& d, std::span<double> values) const override {
        const double cosine = std::cos(d.azimuth_deg * (std::numbers::pi / 180.0));
        for (std::size_t c = 0; c < grounds_.size(); ++c)
            values[c] = grounds_[c].reflection(d.mu_in, d.mu_out, cosine) / std::numbers::pi;
    }

  private:
    const std::vector<rte::GroundBrdf>& grounds_;
    const BrdfSource& source_;
};

/// The values of one channel, and the parameters that come nearest to them.
class GroundSearch {
  public:
    GroundSearch(std::span<const Direction> directions, std::vector<double> reflection,
                 std::size_t unknowns)
        : directions_(directions), truth_(std::move(reflection)), unknowns_(unknowns) {
        for (const double value : truth_) mean_ += std::abs(value) / double(truth_.size());
        mean_ = std::max(mean_, 1e-12);
    }

    double mean() const { return mean_; }

    Eigen::VectorXd residuals(const rte::GroundBrdf& ground) const {
        constexpr double kFloor = 0.1;  // of the mean: below it errors count beside that
        Eigen::VectorXd result(Eigen::Index(truth_.size()));
        for (std::size_t i = 0; i < truth_.size(); ++i) {
            const Direction& d = directions_[i];
            const double found = ground.reflection(
                d.mu_in, d.mu_out, std::cos(d.azimuth_deg * (std::numbers::pi / 180.0)));
            result[Eigen::Index(i)] =
                (found - truth_[i]) / std::max(std::abs(truth_[i]), kFloor * mean_);
        }
        return result;
    }

    /// The sum of squares that is left.
    double improve(rte::GroundBrdf& ground, const Control& control) const {
        constexpr int kSteps = 200;
        const auto with = [&](const std::vector<double>& numbers) {
            rte::GroundBrdf moved = ground;
            std::copy(numbers.begin(), numbers.end(), moved.values.begin());
            if (ground.kind == Kind::rpv) moved.values[3] = moved.values[0];
            return moved;
        };
        BoundedSearch search{
            {},
            {},
            [&](const std::vector<double>& numbers) { return residuals(with(numbers)); },
            1e-6,
            1e-10};
        for (std::size_t p = 0; p < unknowns_; ++p) {
            search.low.push_back(ground.model().parameters[p].low);
            search.high.push_back(ground.model().parameters[p].high);
        }
        // A surge as wide as the hemisphere is a factor: what lies beyond says nothing.
        constexpr std::size_t width_of_surge = 4;
        if (ground.kind == Kind::hapke) search.high[width_of_surge] = 1.0;
        std::vector<double> numbers(ground.values.begin(),
                                    ground.values.begin() + std::ptrdiff_t(unknowns_));
        for (std::size_t p = 0; p < unknowns_; ++p)
            numbers[p] = std::clamp(numbers[p], search.low[p], search.high[p]);
        const double left = miebrdf::improve(search, numbers, kSteps, control);
        ground = with(numbers);
        return left;
    }

  private:
    std::span<const Direction> directions_;
    std::vector<double> truth_;
    std::size_t unknowns_;
    double mean_ = 0.0;
};

/// Steep and flat, forward and backward, with narrow and broad surges: starts of the search.
std::vector<rte::GroundBrdf> starts(Kind kind, double mean) {
    switch (kind) {
        case Kind::rpv:
            return {{kind, {mean, 0.8, -0.1}}, {kind, {mean, 1.0, 0.1}}};
        case Kind::ross_li:
            return {{kind, {mean}}};
        case Kind::hapke:
            break;
    }
    return {{kind, {0.5, 0.3, 0.3, 0.5, 0.06, 15}},
            {kind, {0.9, 0.4, -0.5, 0.2, 0.1, 5}},
            {kind, {0.2, 0.2, 0.0, 1.0, 0.05, 25}},
            {kind, {0.9, 0.4, -0.5, 0.5, 1.0, 5}}};
}

}  // namespace

GroundFit fit_ground(const BrdfSource& source, const std::string& model, const Control& control) {
    const auto models = rte::ground_models();
    const auto found = std::find_if(models.begin(), models.end(),
                                    [&](const rte::GroundModel& one) { return model == one.name; });
    const bool is_lambert = model == "lambert";
    if (found == models.end() && !is_lambert)
        throw UsageError("model '" + model + "'; allowed: rpv, ross-li, hapke, lambert");
    GroundFit fit;
    fit.parameters = {"albedo"};  // of Lambert: the constant kernel alone
    const Kind kind = is_lambert ? Kind::ross_li : static_cast<Kind>(found - models.begin());
    if (!is_lambert) {
        fit.parameters.clear();
        for (std::size_t p = 0; p < found->needed; ++p)
            fit.parameters.emplace_back(found->parameters[p].name);
    }
    constexpr double kLowestCosine = 0.2;
    std::vector<Direction> directions = random_directions(600, 41);
    std::erase_if(directions,
                  [](const Direction& d) { return std::min(d.mu_in, d.mu_out) < kLowestCosine; });
    const std::vector<Direction> retro = retro_directions(directions.size() / 4, 42);
    directions.insert(directions.end(), retro.begin(), retro.end());
    const std::size_t channels = source.channels().size();
    const std::vector<double> values = evaluate_all(source, directions, "directions", control);
    fit.grounds.resize(channels);
    run_parallel("grounds", channels, control, [&](std::size_t c) {
        std::vector<double> reflection;
        reflection.reserve(directions.size());
        for (std::size_t d = 0; d < directions.size(); ++d)
            reflection.push_back(std::numbers::pi * values[d * channels + c]);
        const GroundSearch search(directions, std::move(reflection), fit.parameters.size());
        double least = std::numeric_limits<double>::infinity();
        for (rte::GroundBrdf start : starts(kind, search.mean())) {
            const double left = search.improve(start, control);
            if (left >= least) continue;
            least = left;
            fit.grounds[c] = start;
        }
    });
    fit.weights = "relative errors at random directions of mu > 0.2, a fifth near retro-reflection";
    fit.deviation =
        measure_deviation(GroundsAsFile(fit.grounds, source), source, random_directions(1500, 99));
    return fit;
}

}  // namespace miebrdf
