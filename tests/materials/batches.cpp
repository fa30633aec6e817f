#include "tests/materials/batches.h"

#include <fmt/format.h>

#include <cstdio>

#include <miebrdf/database.h>

namespace miebrdf::materials::testing {

std::vector<Dataset> batch(const std::string& name, int rows) {
    std::vector<Dataset> datasets(batch_size);
    for (int i = 0; i < batch_size; ++i) {
        std::vector<double> x, y;
        for (int row = 0; row < rows; ++row) {
            x.push_back(400 + row);
            y.push_back(1.5 + 1e-3 * i);
        }
        Dataset& d = datasets[static_cast<std::size_t>(i)];
        d.material = fmt::format("{}-{}", name, i);
        d.label = std::string("x");  // gcc 12 sees an overlap when a literal is assigned here
        d.source = name;
        d.n = make_table(Unit::nanometre, x, y);
    }
    return datasets;
}

int count_of(const std::filesystem::path& file, const std::string& name) {
    const Database database = Database::layered(file);
    int count = 0;
    for (const MaterialInfo& m : database.search(name)) {
        if (m.source != name) continue;
        database.refractive_index(m.name).at(405);
        ++count;
    }
    return count;
}

pid_t in_child(const std::function<void()>& work) {
    return support::in_child(work, [](const std::exception& error) {
        const std::string what = error.what();
        std::fprintf(stderr, "child: %s\n", what.c_str());
        if (dynamic_cast<const DatabaseError*>(&error) == nullptr) return other_error;
        if (what.find("locked") != std::string::npos) return locked_out;
        const bool full = what.find("disk is full") != std::string::npos ||
                          what.find("No space left") != std::string::npos;
        return full ? disk_full : database_error;
    });
}

}  // namespace miebrdf::materials::testing
