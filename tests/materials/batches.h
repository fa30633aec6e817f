// Data sets by the hundred, written in one process and counted in another.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <miebrdf/index.h>
#include "tests/support/child_process.h"

namespace miebrdf::materials::testing {

inline constexpr int batch_size = 100;

/// Exit codes of the children.
inline constexpr int database_error = 10, locked_out = 11, disk_full = 13, other_error = 12;

/// `batch_size` datasets of the source `name`, the i-th with n = 1.5 + i / 1000.
std::vector<Dataset> batch(const std::string& name, int rows = 40);

/// How many datasets of a batch there are; reads every one of them.
int count_of(const std::filesystem::path& file, const std::string& name);

/// A child that ends with one of the codes above when `work` throws, which it also prints.
pid_t in_child(const std::function<void()>& work);
using support::exit_code;

}  // namespace miebrdf::materials::testing
