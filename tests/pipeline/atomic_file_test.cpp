#include "pipeline/atomic_file.h"

#include <sys/stat.h>

#include "pipeline/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

TEST_CASE("a file appears whole on commit and not before", "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const std::string path = folder / "result.csv";
    {
        AtomicFile file(path);
        file.stream() << "all of it";
        CHECK_FALSE(std::filesystem::exists(path));
        file.commit();
    }
    CHECK(support::read_file(path) == "all of it");
    CHECK(folder.count() == 1);
}

TEST_CASE("without commit the old file stays and no temporary is left", "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const std::string path = folder.write("result.csv", "old");
    {
        AtomicFile file(path);
        file.stream() << "half of the n";
    }
    CHECK(support::read_file(path) == "old");
    CHECK(folder.count() == 1);
}

TEST_CASE("a symbolic link keeps pointing where it did", "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const std::string real = folder.write("real.csv", "old");
    std::filesystem::create_symlink(real, folder / "link.csv");
    AtomicFile file(folder / "link.csv");
    file.stream() << "new";
    file.commit();
    CHECK(std::filesystem::is_symlink(folder / "link.csv"));
    CHECK(support::read_file(real) == "new");
}

TEST_CASE("a pipe or device is written directly", "[pipeline][atomic_file]") {
    AtomicFile file("/dev/null");
    file.stream() << "gone";
    file.commit();
    CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("a folder that is not there is named in the error", "[pipeline][atomic_file][errors]") {
    CHECK_THROWS_AS(AtomicFile("/no/such/folder/result.csv"), InputError);
    CHECK_THROWS_WITH(AtomicFile("/no/such/folder/result.csv"),
                      Catch::Contains("/no/such/folder/result.csv"));
    const support::TemporaryFolder folder;
    CHECK_THROWS_WITH(AtomicFile(folder.path()), Catch::Contains("directory"));
}

TEST_CASE("a full disk is an error and leaves nothing", "[pipeline][atomic_file][errors]") {
    // /dev/full fails on every write as a full disk does.
    AtomicFile file("/dev/full");
    file.stream() << std::string(1 << 20, 'x');
    CHECK_THROWS_AS(file.commit(), InputError);
}

TEST_CASE("an abrupt end can remove what is unfinished, and nothing else",
          "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    AtomicFile done(folder / "done.csv");
    done.commit();
    AtomicFile unfinished(folder / "unfinished.csv");
    CHECK(folder.count() == 2);
    remove_unfinished_files();
    CHECK(folder.count() == 1);
    CHECK(std::filesystem::exists(folder / "done.csv"));
}
