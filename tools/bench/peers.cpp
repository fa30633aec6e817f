#include "tools/bench/peers.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include <miebrdf/error.h>

namespace miebrdf::bench {
namespace {

using Json = nlohmann::json;

/// A child on a socket that is both its input and its output.
class PeerProcess {
  public:
    explicit PeerProcess(const std::string& command) {
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
            throw Error("no pair of sockets for a peer");
        child_ = ::fork();
        if (child_ == 0) {
            ::setpgid(0, 0);  // what the shell starts ends with it
            ::dup2(ends[1], STDIN_FILENO);
            ::dup2(ends[1], STDOUT_FILENO);
            ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
            ::_exit(127);
        }
        ::close(ends[1]);
        socket_ = ends[0];
        if (child_ < 0) throw Error("a peer's process cannot be made");
    }
    ~PeerProcess() {
        ::close(socket_);
        if (child_ <= 0) return;
        ::kill(-child_, SIGKILL);
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
    PeerProcess(const PeerProcess&) = delete;
    PeerProcess& operator=(const PeerProcess&) = delete;

    /// The line that answers a line.
    /// @throws InputError  with the reason
    std::string ask(const std::string& line, double patience_s) {
        send(line + "\n");
        const double end = now() + patience_s;
        for (std::size_t stop = 0; (stop = buffer_.find('\n')) == std::string::npos;) {
            pollfd ready{socket_, POLLIN, 0};
            const double rest = end - now();
            if (rest <= 0.0 || ::poll(&ready, 1, int(std::min(rest, 1e6) * 1e3) + 1) == 0)
                throw InputError(fmt::format("no answer in {} s", patience_s));
            char part[4096];
            const ssize_t got = ::read(socket_, part, sizeof part);
            if (got <= 0) throw InputError("it has ended");
            buffer_.append(part, std::size_t(got));
        }
        const std::size_t stop = buffer_.find('\n');
        std::string answer = buffer_.substr(0, stop);
        buffer_.erase(0, stop + 1);
        return answer;
    }

  private:
    static double now() {
        timespec t{};
        clock_gettime(CLOCK_MONOTONIC, &t);
        return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
    }
    void send(std::string_view text) {
        while (!text.empty()) {
            const ssize_t sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
            if (sent <= 0) throw InputError("it has ended");
            text.remove_prefix(std::size_t(sent));
        }
    }

    pid_t child_ = -1;
    int socket_ = -1;
    std::string buffer_;
};

Json parsed(const std::string& line) {
    Json answer = Json::parse(line, nullptr, false);
    if (!answer.is_object())
        throw InputError(fmt::format("'{}' is no JSON object", line.substr(0, 60)));
    if (answer.contains("error"))
        throw InputError(answer["error"].is_string() ? answer["error"].get<std::string>()
                                                     : answer["error"].dump());
    return answer;
}

/// A peer that runs; after a failure it is started again for the next question.
class Peer {
  public:
    Peer(PeerWords words, double patience_s, std::function<void(const std::string&)> note)
        : words_(std::move(words)), patience_s_(patience_s), note_(std::move(note)) {}

    const std::string& name() const { return words_.name; }

    Json ask(const Json& question) {
        if (!process_) process_ = std::make_unique<PeerProcess>(words_.command);
        try {
            return parsed(process_->ask(question.dump(), patience_s_));
        } catch (const InputError&) {
            process_.reset();
            throw;
        }
    }

    Answer values_of(const Json& question) {
        Answer answer;
        try {
            const Json said = ask(question);
            answer.values = said.at("values").get<std::vector<double>>();
            answer.seconds = said.at("seconds").get<double>();
            if (!(answer.seconds > 0.0)) throw InputError("'seconds' must be above 0");
            return answer;
        } catch (const InputError& error) {
            tell(error.what());
        } catch (const Json::exception& error) {
            tell(fmt::format("an answer needs a list 'values' and a number 'seconds' ({})",
                             error.what()));
        }
        answer.values.clear();
        answer.seconds = std::numeric_limits<double>::quiet_NaN();
        return answer;
    }

    void tell(const std::string& reason) {
        if (said_.insert(reason).second) note_(fmt::format("peer {}: {}", words_.name, reason));
    }

  private:
    PeerWords words_;
    double patience_s_;
    std::function<void(const std::string&)> note_;
    std::unique_ptr<PeerProcess> process_;
    std::set<std::string> said_;
};

}  // namespace

std::string question_of(const SimpleStack& scene, const rte::Directions& wanted) {
    const auto words = [](const SimpleLayer& layer) {
        return Json{{"albedo", layer.single_scattering_albedo}, {"asymmetry", layer.asymmetry}};
    };
    const bool is_albedo = wanted.mu_out.empty();
    Json question{{"quantity", is_albedo ? "plane_albedo" : "reflection"},
                  {"base", words(scene.base)},
                  {"mu_in", wanted.mu_in}};
    if (scene.coat) {
        question["coat"] = words(*scene.coat);
        question["coat"]["optical_depth"] = scene.coat->optical_depth;
    }
    if (!is_albedo) {
        question["mu_out"] = wanted.mu_out;
        question["azimuth_deg"] = wanted.azimuth_deg;
    }
    return question.dump();
}

PeerWords parse_peer(const std::string& words) {
    const std::size_t equals = words.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == words.size()) {
        throw UsageError(fmt::format(
            "peer '{}': allowed: NAME=COMMAND, e.g. --peer 'disort=python3 disort_peer.py'",
            words));
    }
    return {words.substr(0, equals), words.substr(equals + 1)};
}

void add_peer(const PeerWords& words, double patience_s,
              const std::function<void(const std::string&)>& note, std::vector<BenchCase>& cases) {
    const auto peer = std::make_shared<Peer>(words, patience_s, note);
    for (BenchCase& c : cases) {
        if (c.question.empty()) continue;
        Json question = Json::parse(c.question);
        question["ask"] = "settings";
        std::vector<std::string> settings;
        try {
            settings = peer->ask(question).at("settings").get<std::vector<std::string>>();
        } catch (const std::exception& error) {
            throw UsageError(fmt::format("peer '{}' ({}) does not say its settings: {}", words.name,
                                         words.command, error.what()));
        }
        question["ask"] = "values";
        for (const std::string& setting : settings) {
            question["setting"] = setting;
            c.add(words.name, setting, [peer, question] { return peer->values_of(question); });
        }
    }
}

}  // namespace miebrdf::bench
