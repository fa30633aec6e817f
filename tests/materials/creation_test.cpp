// Many processes that create the user's database at the same moment.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include <miebrdf/database.h>
#include "tests/materials/batches.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;
using namespace miebrdf::materials::testing;

namespace {

constexpr int crowd = 24;

int rounds_wanted() {
    const char* text = std::getenv("MIEBRDF_CREATIONS");
    return text == nullptr ? 2 : std::atoi(text);
}

// One dataset of its own each, so that a lost write shows.
void write_and_read(const std::filesystem::path& file, int i) {
    Dataset mine = batch("mine").front();
    mine.material = fmt::format("Mine{}", i);
    DatabaseWriter(file).add(std::vector{mine});
    if (Database::layered(file).refractive_index(mine.material).at(405).real() != 1.5) _exit(20);
}

// A third only reads: nothing yet, or a database.
void read_only(const std::filesystem::path& file) {
    for (int i = 0; i < 20; ++i) {
        if (Database::layered(file).list().size() < 73) _exit(21);
    }
}

void create_all_at_once(const std::filesystem::path& file) {
    support::StartingGate gate;
    std::vector<pid_t> children;
    for (int i = 0; i < crowd; ++i) {
        children.push_back(in_child([&] {
            gate.wait();
            i % 3 == 2 ? read_only(file) : write_and_read(file, i);
        }));
    }
    gate.open();
    for (const pid_t child : children) CHECK(exit_code(child) == 0);
    const Database database = Database::open(file);
    CHECK(database.list().size() == crowd / 3 * 2);
    CHECK(database.integrity_problems().empty());
}

}  // namespace

TEST_CASE("many processes create the database at once: nobody is refused, nothing is lost",
          "[materials][reliability]") {
    for (int round = 0; round < rounds_wanted(); ++round) {
        CAPTURE(round);
        const support::TemporaryFolder folder;
        create_all_at_once(folder.path() / "deep" / "user.sqlite");
        // Nothing of the creation is left; the last reader may leave SQLite's empty log.
        for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "deep")) {
            const std::string name = entry.path().filename();
            CAPTURE(name);
            CHECK(
                (name == "user.sqlite" || name == "user.sqlite-wal" || name == "user.sqlite-shm"));
        }
    }
}

TEST_CASE("the same with an empty file, which becomes a database where it lies",
          "[materials][reliability]") {
    for (int round = 0; round < rounds_wanted(); ++round) {
        CAPTURE(round);
        const support::TemporaryFolder folder;
        create_all_at_once(folder.write("user.sqlite", ""));
    }
}
