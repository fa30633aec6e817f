// No room: on a disk of a megabyte, and under the system's limit on the size of files.
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include <miebrdf/database.h>
#include "tests/materials/batches.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;
using namespace miebrdf::materials::testing;

namespace {

namespace fs = std::filesystem;

constexpr int may_not_mount = 40;

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

// A small disk that only this process and its children see; it goes when they end. Users other than
// root may do this in a name space of their own, where the system lets them.
bool mount_small_disk(const fs::path& folder, int kilobytes) {
    const auto uid = geteuid();
    const auto gid = getegid();
    if (unshare(CLONE_NEWNS | (uid == 0 ? 0 : CLONE_NEWUSER)) != 0) return false;
    if (uid != 0) {
        write_text("/proc/self/setgroups", "deny");
        write_text("/proc/self/uid_map", fmt::format("{0} {0} 1", uid));
        write_text("/proc/self/gid_map", fmt::format("{0} {0} 1", gid));
    }
    if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return false;
    return mount("none", folder.c_str(), "tmpfs", 0, fmt::format("size={}k", kilobytes).c_str()) ==
           0;
}

std::uintmax_t free_bytes(const fs::path& folder) { return fs::space(folder).available; }

void fill_until(const fs::path& filler, std::uintmax_t left) {
    const std::uintmax_t room = free_bytes(filler.parent_path());
    if (room <= left) return;
    const int file = open(filler.c_str(), O_CREAT | O_WRONLY, 0644);
    if (posix_fallocate(file, 0, static_cast<off_t>(room - left)) != 0) _exit(41);
    close(file);
}

void expect(bool condition, int line) {
    if (condition) return;
    std::fprintf(stderr, "%s:%d: not so\n", __FILE__, line);
    _exit(42);
}
#define EXPECT(condition) expect((condition), __LINE__)

void write_on_small_disk(const fs::path& disk) {
    const fs::path file = disk / "user.sqlite";
    const fs::path filler = disk / "filler";
    EXPECT(exit_code(in_child([&] { DatabaseWriter(file).add(batch("kept")); })) == 0);
    int refused = 0;
    for (const std::uintmax_t left : {0u, 4096u, 20480u, 40960u, 81920u, 163840u}) {
        fill_until(filler, left);
        const std::string name = fmt::format("new{}", left);
        const int code = exit_code(in_child([&] { DatabaseWriter(file).add(batch(name, 400)); }));
        EXPECT(code == disk_full);
        refused += code == disk_full;
        // With the disk still full, everything can be read.
        EXPECT(count_of(file, "kept") == batch_size);
        EXPECT(count_of(file, name) == 0);
        EXPECT(Database::open(file).integrity_problems().empty());
        fs::remove(filler);
    }
    EXPECT(refused == 6);
    EXPECT(exit_code(in_child([&] { DatabaseWriter(file).add(batch("later", 10)); })) == 0);
    EXPECT(count_of(file, "later") == batch_size);
}

void create_on_small_disk(const fs::path& disk) {
    const fs::path file = disk / "user.sqlite";
    for (const std::uintmax_t left : {0u, 8192u, 40960u}) {
        fill_until(disk / "filler", left);
        EXPECT(exit_code(in_child([&] { DatabaseWriter(file).add(batch("new")); })) == disk_full);
        EXPECT(count_of(file, "new") == 0);
        fs::remove(disk / "filler");
        EXPECT(exit_code(in_child([&] { DatabaseWriter(file).add_alias("SiO2", "x"); })) == 0);
        for (const char* part : {"", "-wal", "-shm"}) fs::remove(file.string() + part);
    }
}

void on_small_disk(void (*work)(const fs::path&)) {
    const support::TemporaryFolder folder;
    const int code = exit_code(in_child([&] {
        if (!mount_small_disk(folder.path(), 1024)) _exit(may_not_mount);
        work(folder.path());
    }));
    if (code == may_not_mount) {
        std::printf("skipped: this user may not mount a small disk\n");
        return;
    }
    CHECK(code == 0);
}

}  // namespace

TEST_CASE("on a full disk a writer says so, and what was there can be read",
          "[materials][reliability]") {
    on_small_disk(write_on_small_disk);
}

TEST_CASE("a database that has no room to be created is not there afterwards",
          "[materials][reliability]") {
    on_small_disk(create_on_small_disk);
}

TEST_CASE("a limit on the size of files is an error and nothing is lost",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder.path() / "user.sqlite";
    DatabaseWriter(file).add(batch("kept"));
    int refused = 0;
    for (const rlim_t allowed : {1u, 4096u, 20000u, 70000u, 150000u, 300000u}) {
        const int code = exit_code(in_child([&] {
            signal(SIGXFSZ, SIG_IGN);
            const rlimit limit{allowed, allowed};
            setrlimit(RLIMIT_FSIZE, &limit);
            DatabaseWriter(file).add(batch(fmt::format("new{}", allowed), 400));
        }));
        CAPTURE(allowed, code);
        CHECK((code == 0 || code == database_error || code == disk_full));
        refused += code != 0;
        CHECK(count_of(file, "kept") == batch_size);
        CHECK(count_of(file, fmt::format("new{}", allowed)) == (code == 0 ? batch_size : 0));
        CHECK(Database::open(file).integrity_problems().empty());
    }
    CHECK(refused >= 4);
}
