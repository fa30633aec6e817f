// Writers that are killed, several processes at once, read-only folders, damaged bytes:
// the database is as before or as after, and whoever asks gets data or a clear error.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <thread>

#include <miebrdf/database.h>
#include "tests/materials/batches.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;
using namespace miebrdf::materials::testing;

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

int kills_wanted() {
    const char* text = std::getenv("MIEBRDF_KILLS");
    return text == nullptr ? 60 : std::atoi(text);
}

}  // namespace

TEST_CASE("a writer killed at any moment leaves the database as before or as after",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder.path() / "user.sqlite";
    std::mt19937 random(1);
    const auto start = Clock::now();
    REQUIRE(exit_code(in_child([&] { DatabaseWriter(file).add(batch("first")); })) == 0);
    const auto whole =
        std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start).count();

    int before = 0, after = 0;
    for (int i = 0; i < kills_wanted(); ++i) {
        // Every third time the file does not exist yet: its creation is interrupted.
        if (i % 3 == 0) {
            for (const char* part : {"", "-wal", "-shm", "-journal"})
                fs::remove(file.string() + part);
        }
        const std::string name = fmt::format("killed{}", i);
        const pid_t child = in_child([&] { DatabaseWriter(file).add(batch(name)); });
        std::this_thread::sleep_for(std::chrono::microseconds(random() % (whole * 4 / 5)));
        kill(child, SIGKILL);
        exit_code(child);
        CAPTURE(i);
        const int found = count_of(file, name);
        CHECK((found == 0 || found == batch_size));
        (found == 0 ? before : after)++;
        CHECK(Database::layered(file).integrity_problems().empty());
        // And it can be written again at once.
        if (i % 3 == 1) CHECK_NOTHROW(DatabaseWriter(file).add_alias("SiO2", name));
    }
    std::printf("killed writers: %d, database as before: %d, as after: %d\n", before + after,
                before, after);
    CHECK(before > 0);  // otherwise the kills came too late to prove anything
}

TEST_CASE("two processes write while ten read: nobody waits in vain, no errors",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder.path() / "user.sqlite";
    constexpr int batches = 8;
    // There is no file yet: the first writer creates it under everybody's eyes.
    std::vector<pid_t> children;
    children.reserve(12);
    for (int writer = 0; writer < 2; ++writer) {
        children.push_back(in_child([&] {
            for (int i = 0; i < batches; ++i) {
                DatabaseWriter(file).add(batch(fmt::format("writer{}batch{}", writer, i), 10));
            }
        }));
    }
    for (int reader = 0; reader < 10; ++reader) {
        children.push_back(in_child([&] {
            for (int i = 0; i < 15; ++i) {
                const Database database = Database::layered(file);
                if (database.refractive_index("SiO2").at(550).real() < 1.4) _exit(20);
                const auto found = database.search("writer0batch0");
                if (!found.empty() && found.size() != batch_size) _exit(21);  // half a transaction
            }
        }));
    }
    // Whoever had to wait for as long as a busy timeout would end with `locked_out`.
    for (const pid_t child : children) CHECK(exit_code(child) == 0);
    CHECK(count_of(file, "writer1batch7") == batch_size);
    CHECK(Database::open(file).list().size() == 2 * batches * batch_size);
}

TEST_CASE("a read-only folder: reading works, writing is a clear error",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder.path() / "user.sqlite";
    DatabaseWriter(file).add(batch("kept"));
    for (const char* part : {"-wal", "-shm"}) fs::remove(file.string() + part);
    fs::permissions(file, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
    fs::permissions(folder.path(), fs::perms(0555));
    // root may write anywhere, so that the question is asked as nobody.
    const auto as_nobody = [](const std::function<void()>& work) {
        return in_child([&] {
            if (geteuid() == 0 && setuid(65534) != 0) _exit(30);
            work();
        });
    };
    CHECK(exit_code(as_nobody([&] {
              if (count_of(file, "kept") != batch_size) _exit(31);
          })) == 0);
    CHECK(exit_code(as_nobody([&] { DatabaseWriter(file).add(batch("new")); })) == database_error);
    CHECK(exit_code(as_nobody([&] { DatabaseWriter(folder.path() / "other.sqlite"); })) ==
          database_error);
    fs::permissions(folder.path(), fs::perms(0755));
    CHECK(count_of(file, "kept") == batch_size);
}

TEST_CASE("changed bytes give the right figures or an error", "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder.path() / "user.sqlite";
    DatabaseWriter(file).add(batch("kept"));
    const std::string whole = support::read_file(file);
    std::mt19937 random(3);
    int noticed = 0;
    for (int i = 0; i < 150; ++i) {
        std::string changed = whole;
        for (int j = 0; j < 20; ++j)
            changed[random() % changed.size()] = static_cast<char>(random());
        const fs::path damaged = folder.write("damaged.sqlite", changed);
        try {
            const Database database = Database::open(damaged);
            for (int m = 0; m < batch_size; ++m) {
                const std::string name = fmt::format("kept-{}", m);
                if (database.resolve(name).size() != 1) continue;  // a damaged name is another name
                const double n = database.refractive_index(name).at(420).real();
                CHECK(n == Approx(1.5 + 1e-3 * m).epsilon(1e-15));
            }
        } catch (const InputError&) {
            ++noticed;
        }
    }
    CHECK(noticed > 100);
}
