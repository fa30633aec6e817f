#include "pipeline/scene/moments_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace {

constexpr char kAlbedoKey[] = "single_scattering_albedo:";
constexpr double kLargestChi0Error = 1e-6;  // tables are printed with at least six digits
constexpr std::size_t kMostMomentsOfFile = 1'000'000;

/// One file on its way in; every complaint names the file and the line.
class MomentsReader {
  public:
    explicit MomentsReader(const std::string& path) : path_(path) {}

    MomentsFile read() {
        std::ifstream file(path_);
        if (!file) throw InputError(fmt::format("moments file '{}' cannot be read", path_));
        std::string line;
        while (std::getline(file, line)) {
            ++line_number_;
            if (!line.empty() && line.back() == '\r') line.pop_back();
            if (!line.empty()) read_line(line);
        }
        if (result_.chi.empty()) refuse("has no rows 'l,chi'");
        if (!albedo_) refuse("has no line '# single_scattering_albedo: X'");
        result_.single_scattering_albedo = *albedo_;
        return std::move(result_);
    }

  private:
    [[noreturn]] void refuse(const std::string& reason) const {
        throw InputError(
            fmt::format("moments file '{}', line {}: {}", path_, line_number_, reason));
    }

    double number(const std::string& text) const {
        try {
            return parse_number(text, "value");
        } catch (const UsageError& error) {
            refuse(error.what());
        }
    }

    void read_line(const std::string& line) {
        if (line[0] == '#') {
            const std::size_t key = line.find(kAlbedoKey);
            if (key != std::string::npos) read_albedo(line.substr(key + sizeof(kAlbedoKey) - 1));
        } else if (!header_seen_) {
            const auto names = split_list(line);
            if (names != std::vector<std::string>{"l", "chi"}) {
                refuse(fmt::format("expected the header 'l,chi', found '{}'", line));
            }
            header_seen_ = true;
        } else {
            read_row(line);
        }
    }

    void read_albedo(const std::string& text) {
        albedo_ = number(text);
        if (!(*albedo_ >= 0.0 && *albedo_ <= 1.0)) {
            refuse(fmt::format("single-scattering albedo {} is out of range; allowed: [0, 1]",
                               *albedo_));
        }
    }

    void read_row(const std::string& line) {
        const auto fields = split_list(line);
        if (fields.size() != 2) refuse(fmt::format("expected 'l,chi', found '{}'", line));
        const auto expected = result_.chi.size();
        if (expected >= kMostMomentsOfFile)
            refuse(fmt::format("more than {} moments", kMostMomentsOfFile));
        if (number(fields[0]) != static_cast<double>(expected)) {
            refuse(fmt::format("expected l = {}, found '{}'", expected, fields[0]));
        }
        const double chi = number(fields[1]);
        if (expected == 0 && !(std::abs(chi - 1.0) <= kLargestChi0Error)) {
            refuse(fmt::format("chi_0 = {}; it must be 1 (divide all moments by chi_0)", chi));
        }
        if (!(std::abs(chi) <= 1.0 + kLargestChi0Error)) {
            refuse(fmt::format("chi_{} = {} is out of range; allowed: [-1, 1]", expected, chi));
        }
        result_.chi.push_back(expected == 0 ? 1.0 : std::clamp(chi, -1.0, 1.0));
    }

    std::string path_;
    int line_number_ = 0;
    bool header_seen_ = false;
    std::optional<double> albedo_;
    MomentsFile result_;
};

}  // namespace

MomentsFile read_moments_file(const std::string& path) { return MomentsReader(path).read(); }

}  // namespace miebrdf
