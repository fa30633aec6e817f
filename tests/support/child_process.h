// Work in a process of its own, which may be killed, limited or one of many.
#pragma once

#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace miebrdf::support {

/// Runs `work` in a child that ends with 0, or with `thrown(error)` when it throws.
template <class Work, class Thrown>
pid_t in_child(const Work& work, const Thrown& thrown) {
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("cannot fork");
    if (child != 0) return child;
    int code = 0;
    try {
        work();
    } catch (const std::exception& error) {
        code = thrown(error);
    } catch (...) {
        code = 99;
    }
    _exit(code);
}

/// Waits for it: its exit code, or minus the signal that ended it.
inline int exit_code(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// A door that many children wait at until the parent opens it for all of them at once.
class StartingGate {
  public:
    StartingGate() {
        if (pipe(ends_) != 0) throw std::runtime_error("no pipe");
    }
    ~StartingGate() {
        open();
        close(ends_[0]);
    }
    StartingGate(const StartingGate&) = delete;
    StartingGate& operator=(const StartingGate&) = delete;

    /// In the child: returns when the parent has opened.
    void wait() {
        open();  // the child's own copy of the writing end
        char byte = 0;
        while (read(ends_[0], &byte, 1) > 0) {
        }
    }
    /// In the parent.
    void open() {
        if (ends_[1] >= 0) close(ends_[1]);
        ends_[1] = -1;
    }

  private:
    int ends_[2] = {-1, -1};
};

}  // namespace miebrdf::support
